//! What happened to a body before it moves: initial stress, and stages one after another.

mod initial;
mod list;

pub use initial::StressField;
pub use list::{Stage, StageError, StageEvent, StageModel, StageReport, run_stages};
