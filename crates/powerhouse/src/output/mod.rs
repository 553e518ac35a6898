//! What is kept of a run.

mod folder;
mod plan;
mod results;
mod summary;

pub use folder::ResultFolder;
pub use plan::{CutWish, EnvelopeWish, HistoryWish, OutputPlan, RelativeWish, SnapshotWish};
pub(crate) use results::Recordings;
pub use results::Results;
