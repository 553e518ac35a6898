//! The shape of the workspace, read from its manifests and sources.

mod dependencies;
mod growth;
mod manifests;
mod sources;
