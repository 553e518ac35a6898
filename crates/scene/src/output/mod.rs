//! Output requests and results of a run, in memory.

mod bending;
mod bolts;
mod capacity;
mod energy_residual;
mod failure;
mod naming;
mod plan;
mod results;
mod rings;
mod sampling;
mod sections;
mod state_variables;
mod table_sink;
mod warnings;

pub use bending::BendingError;
pub(crate) use bending::coarse_in_bending;
pub use bolts::BoltForces;
pub use capacity::{SectionUse, forces as section_forces};
pub use energy_residual::EnergyResidual;
pub(crate) use failure::advice;
pub use naming::{NameError, NamedThing, check_names, file_name};
pub use plan::{
    EnvelopeRequest, HistoryRequest, JointRequest, OutputPlan, RelativeRequest, SampledRequest,
    SectionRequest, SnapshotRequest, StateRequest, StressRequest,
};
pub use results::Results;
pub(crate) use results::{FinishedRun, Recordings};
pub use rings::RingRequest;
pub(crate) use state_variables::{StateVariables, add_variables, shown_variables};
pub use table_sink::{RunTable, TableSink};
