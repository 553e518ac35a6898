//! Checkpoints: files beside the results of a run, from which it can be resumed, and from which variants of it can start.

mod files;
mod incident;
mod inputs;
mod kept;
mod plan;
mod writer;

pub use files::{CheckpointError, CheckpointFiles, ResumedRun};
pub use inputs::RunInputs;
pub use kept::KeptState;
pub use plan::{CheckpointInterval, CheckpointPlan, IntervalError};
pub use writer::CheckpointWriter;
