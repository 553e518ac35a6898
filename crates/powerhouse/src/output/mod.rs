//! What is kept of a run.

mod bolts;
mod drawing;
mod folder;
mod joints;
mod lock;
mod names;
mod naming;
mod plan;
mod remembered;
mod results;
mod sampling;
mod stages;
mod summary;
mod vtu;

pub use bolts::BoltForces;
pub use drawing::file_name;
pub use folder::ResultFolder;
pub use lock::{FolderError, FolderLock};
pub(crate) use names::Named;
pub use naming::NameError;
pub(crate) use naming::{NamedThing, check_names};
pub use plan::{
    CutWish, EnvelopeWish, HistoryWish, JointWish, OutputPlan, RelativeWish, SnapshotWish,
    StateWish, StressWish,
};
pub(crate) use remembered::Remembered;
pub(crate) use results::Recordings;
pub use results::{EnergyResidual, Results};
