//! The shape of the workspace, read from its manifests, sources and documents.

mod dependencies;
mod documents;
mod growth;
mod manifests;
mod sources;
mod words;
