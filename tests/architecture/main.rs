//! The shape of the workspace, read from its manifests and sources.

mod manifests;
mod sources;
