//! Checkpoints: files beside the results of a run, from which it can be resumed.

mod files;
mod inputs;
mod writer;

pub use files::{CheckpointError, CheckpointFiles, ResumedRun};
pub use inputs::RunInputs;
#[cfg(feature = "scene-files")]
pub use inputs::named_files;
pub use writer::CheckpointWriter;
