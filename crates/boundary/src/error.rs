//! Errors of this crate.

use powerhouse_model::{ModelError, ParameterError};
use thiserror::Error;

/// A boundary that cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BoundaryError {
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A face at or behind the scatterer, where no spring can stand.
    #[error(
        "face '{face}' is {distance:.3e} m from the scatterer, less than {least:.3e} m: springs \
         need a distance; use rollers or periodic pairs where the structure runs through a face, \
         or give the distance of its axis"
    )]
    Distance {
        /// The face's name.
        face: String,
        /// The distance from the scatterer along the outward normal (m).
        distance: f64,
        /// The least permitted distance (m).
        least: f64,
    },
    /// A named face that the site does not have.
    #[error("the boundary has no face '{name}'; it has {}", available.join(", "))]
    NoSuchFace {
        /// The wanted name.
        name: String,
        /// Names that exist.
        available: Vec<String>,
    },
    /// A block that is not the layer around a region.
    #[error("the layer around the region has {expected} elements, its block has {found} or others")]
    Layer {
        /// Elements that touch the region from outside.
        expected: usize,
        /// Elements of the block.
        found: usize,
    },
    /// Incident-only input from a field that cannot tell its incident part.
    #[error("the field '{field}' cannot tell its incident wave from what the surface reflects")]
    NoIncidentPart {
        /// The field's name.
        field: String,
    },
}

impl From<BoundaryError> for ModelError {
    fn from(error: BoundaryError) -> Self {
        Self::refused("boundary", error)
    }
}
