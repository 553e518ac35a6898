//! What this crate refuses.

use thiserror::Error;

/// Why a study of a scene cannot be done.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The scene itself is at fault.
    #[error(transparent)]
    Scene(#[from] powerhouse::Error),
    /// No field comes in.
    #[error("the scene has no incident field to check")]
    NoField,
    /// A side of the box that neither absorbs nor is held as a whole.
    #[error(
        "the free-field check needs a box whose sides absorb or are held: the {face} of the mesh's box does neither"
    )]
    OpenFace {
        /// The side of the box.
        face: &'static str,
    },
    /// An absorbing face that lies on none of the box's sides.
    #[error(
        "the free-field check needs absorbing faces on the sides of a box: '{face}' lies on none of them"
    )]
    ObliqueFace {
        /// The face's name.
        face: String,
    },
    /// The field does not move the points where it is checked within the time of the run.
    #[error("the field does not move the surface and the structure within {duration} s")]
    StillField {
        /// The run's duration (s).
        duration: f64,
    },
    /// The run of the check was stopped from outside.
    #[error("interrupted")]
    Interrupted,
    /// The error of the free field is above what the scene permits.
    #[error(
        "the free field of this mesh, step and boundary errs by {error:.4}, above the scene's self_check = {limit}"
    )]
    TooCoarse {
        /// The relative L2 error.
        error: f64,
        /// The permitted error.
        limit: f64,
    },
}
