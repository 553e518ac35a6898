//! Output requests and results of a run, and their files.

mod bending;
mod bolts;
mod capacity;
#[cfg(feature = "pictures")]
mod drawing;
mod energy_residual;
mod failure;
mod folder;
mod joints;
mod lock;
mod names;
mod naming;
mod plan;
mod results;
mod rings;
mod running;
mod sampling;
mod sections;
mod stages;
mod state_variables;
pub mod summary;
mod vtu;

pub use bending::BendingError;
pub(crate) use bending::coarse_in_bending;
pub use bolts::BoltForces;
pub use capacity::SectionUse;
pub use energy_residual::EnergyResidual;
pub(crate) use failure::advice;
pub use folder::ResultFolder;
pub use lock::{FolderError, FolderLock};
pub(crate) use names::Named;
pub use naming::{NameError, file_name};
pub(crate) use naming::{NamedThing, check_names};
pub use plan::{
    EnvelopeRequest, HistoryRequest, JointRequest, OutputPlan, RelativeRequest, SampledRequest,
    SectionRequest, SnapshotRequest, StateRequest, StressRequest,
};
pub use results::Results;
pub(crate) use results::{FinishedRun, Recordings};
pub use rings::RingRequest;
pub use running::RunningTables;
pub(crate) use state_variables::StateVariables;
