//! Errors of the boundaries.

use powerhouse_model::{ModelError, ParameterError};
use thiserror::Error;

/// Errors of building an absorbing boundary.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BoundaryError {
    /// A parameter is outside its permitted range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A face is too near to the scatterer, or behind it, for a spring of finite stiffness, when a viscous-spring boundary
    /// is built without given distances.
    #[error(
        "face '{face}' is {distance:.3e} m from the scatterer, less than {least:.3e} m: the stiffness \
         of springs is undefined; use rollers or periodic pairs where the structure runs through a face, \
         or give the distance of its axis"
    )]
    Distance {
        /// Name of the face.
        face: String,
        /// Distance from the scatterer along the outward normal (m).
        distance: f64,
        /// Least permitted distance (m).
        least: f64,
    },
    /// The site has no face of a name in [`InputMode::IncidentOnly`](crate::InputMode::IncidentOnly).
    #[error("the boundary has no face '{name}'; it has {}", available.join(", "))]
    NoSuchFace {
        /// Name that was given.
        name: String,
        /// Names of the site's faces.
        available: Vec<String>,
    },
    /// The elements of the block that [`ReductionLayer::new`](crate::ReductionLayer::new) receives are not those of the
    /// layer around the region, or the layer has none.
    #[error(
        "the layer around the region has {expected} elements; its block has {found} elements that are not the same"
    )]
    Layer {
        /// Number of elements outside the region that share nodes with it.
        expected: usize,
        /// Number of elements of the block.
        found: usize,
    },
    /// Input of the incident wave alone is requested of a field that cannot separate it
    /// ([`InputMode::IncidentOnly`](crate::InputMode::IncidentOnly)).
    #[error(
        "the field '{field}' cannot be separated into its incident wave and the waves that the surface reflects"
    )]
    NoIncidentPart {
        /// Name of the field.
        field: String,
    },
    /// A field without stress is to enter through springs and dashpots
    /// ([`IncidentField::carries_stress`](powerhouse_model::IncidentField::carries_stress)).
    #[error(
        "the field '{field}' has motions and no stress: it can enter through the layer of elements around a region (domain reduction), not through springs and dashpots"
    )]
    NoStress {
        /// Name of the field.
        field: String,
    },
    /// A face of a delayed slice that is not parallel to its axis y.
    #[error(
        "face '{face}' is not parallel to y: a body with delayed ends absorbs at its bottom and at its sides across x alone; its front and back are delayed against each other"
    )]
    FaceAcrossAxis {
        /// Name of the face.
        face: String,
    },
    /// Ground at a face of a delayed slice in which no P wave has the slowness along y.
    #[error(
        "face '{face}' has ground in which no P wave leaves with the slowness {slowness:.4e} s/m along y; it must be below {largest:.4e} s/m: take a smaller incidence, or an azimuth nearer to x"
    )]
    PastCritical {
        /// Name of the face.
        face: String,
        /// Slowness along y (s/m).
        slowness: f64,
        /// Slowness of P waves in the ground (s/m).
        largest: f64,
    },
}

impl From<BoundaryError> for ModelError {
    fn from(error: BoundaryError) -> Self {
        Self::refused("boundary", error)
    }
}
