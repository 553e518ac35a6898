//! What happens to a body before it moves: stages, bolts, the stress of the ground.

mod bolts;
mod error;
mod list;
mod overview;
mod rest;
mod timeline;

use powerhouse_explicit_core::StressField;
use powerhouse_model::{Mesh, Stress};

pub(crate) use bolts::surface_of;
pub use bolts::{BoltPlace, SceneBolts};
pub use error::StagingError;
pub use list::SceneStage;
pub use overview::StageOverview;
pub(crate) use rest::{Rested, Staging};
pub use rest::{StageAtRest, StageSink};
pub(crate) use timeline::Timeline;

/// The stress of the ground before the first stage.
#[derive(Clone, Debug, PartialEq)]
pub enum InSituStress {
    /// Linear in depth; each element has that at its centroid.
    Field(StressField),
    /// One for each element of the mesh (Pa).
    Elements(Vec<Stress>),
}

impl InSituStress {
    /// The stress (Pa) of every element.
    pub(crate) fn of_elements(&self, mesh: &Mesh) -> Vec<Stress> {
        match self {
            Self::Field(field) => field.of_elements(mesh),
            Self::Elements(stresses) => stresses.clone(),
        }
    }
}
