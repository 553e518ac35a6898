//! Static analysis before the dynamic run: construction stages, bolts, in-situ stress.

mod body_file;
mod bolts;
mod error;
mod in_situ;
mod list;
mod overview;
mod rest;
mod solution;
mod timeline;
mod water;

pub use bolts::surface_of;
pub use bolts::{BoltLayout, SceneBolts};
pub use error::StagingError;
pub use in_situ::{InSituError, InSituStress, WeightLayer};
pub use list::SceneStage;
pub(crate) use list::last_renewal;
pub use overview::StageOverview;
pub use rest::{CompletedStage, EquilibratedBody, StageHook, StageSink};
pub(crate) use rest::{Staging, StagingOutcome, StagingStart};
pub(crate) use solution::SolutionStates;
pub use solution::{StageCheckpointSink, StageSolution};
pub use timeline::{Timeline, check_removal};
pub use water::StageWater;
pub(crate) use water::{WaterAtRest, elements_of_level};
