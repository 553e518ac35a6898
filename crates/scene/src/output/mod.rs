//! Output requests and results of a run, in memory.

mod bending;
mod bolts;
mod capacity;
mod energies;
mod failure;
mod fields;
mod histories;
mod item;
mod joints;
mod naming;
mod plan;
mod recordings;
mod results;
mod rings;
mod sampling;
mod sections;
mod state_variables;
mod table;
mod warnings;

use powerhouse_model::ModelError;

use crate::Error;

pub use bending::BendingError;
pub(crate) use bending::coarse_in_bending;
pub use bolts::BoltForces;
pub use capacity::SectionUse;
pub use energies::EnergyResidual;
pub(crate) use failure::advice;
pub use item::{ListContent, OutputItem, OutputPrice, OutputScale, OutputSite, Recorder};
pub use naming::{NameError, NamedThing, check_names, file_name};
pub use plan::{
    EnvelopeRequest, HistoryRequest, JointRequest, OutputPlan, RelativeRequest, SampledRequest,
    SectionRequest, SnapshotRequest, StateRequest, StressRequest,
};
pub(crate) use recordings::Recordings;
pub use results::Results;
pub use rings::RingRequest;
pub(crate) use state_variables::{StateVariables, add_variables, shown_variables};
pub use table::{
    ColumnPlot, PlottedCurve, ResultList, ResultTable, TableForm, TablePeaks, TablePlot,
    TablePlots, TableSink,
};

/// The items of output that come with the software, in the order of their tables.
const ITEMS: [&dyn OutputItem; 8] = [
    &histories::Histories,
    &sections::Sections,
    &bolts::Bolts,
    &joints::Joints,
    &energies::Energies,
    &fields::Envelopes,
    &fields::StateEnvelopes,
    &fields::SnapshotFiles,
];

fn model(error: impl Into<ModelError>) -> Error {
    Error::Model(error.into())
}
