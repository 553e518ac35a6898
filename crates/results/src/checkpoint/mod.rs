//! Checkpoints: files beside the results of a run, from which it can be resumed, and from which variants of it can start.

mod files;
mod incident;
mod inputs;
mod kept;
mod writer;

pub use files::{CheckpointFiles, ResumedRun};
pub use inputs::RunInputs;
pub use kept::KeptState;
pub use writer::CheckpointWriter;
