//! What is kept of a run.

mod drawing;
mod folder;
mod joints;
mod plan;
mod remembered;
mod results;
mod summary;
mod vtu;

pub use folder::ResultFolder;
pub use plan::{
    CutWish, EnvelopeWish, HistoryWish, JointWish, OutputPlan, RelativeWish, SnapshotWish,
    StateWish, StressWish,
};
pub(crate) use remembered::Remembered;
pub(crate) use results::Recordings;
pub use results::{EnergyResidual, Results};
