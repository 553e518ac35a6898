//! Static history of a body before the dynamic run: initial stress and construction stages.

mod initial;
mod list;

pub use initial::StressField;
pub use list::{Stage, StageError, StageEvent, StageModel, StageReport, run_stages};
