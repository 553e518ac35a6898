//! What this crate refuses.

use powerhouse_model::{ModelError, ParameterError};
use thiserror::Error;

use crate::{SurfaceComponent, WaveKind};

/// Why a signal or a wave cannot be built or sampled.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WaveError {
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Fewer samples than the operation needs.
    #[error("{given} samples given, at least {least} needed for {operation}")]
    TooFewSamples {
        /// What was to be done.
        operation: &'static str,
        /// How many there are.
        given: usize,
        /// How many it takes.
        least: usize,
    },
    /// More samples than a table may hold.
    #[error("{wanted} samples wanted for {operation}, at most {most} permitted")]
    TooManySamples {
        /// What was to be done.
        operation: &'static str,
        /// How many it would take.
        wanted: f64,
        /// How many are permitted.
        most: usize,
    },
    /// A sample that is not a finite number.
    #[error("sample {index} is {value}, not a finite number")]
    SampleNotFinite {
        /// Index of the sample, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A history that is zero throughout cannot be scaled to a peak.
    #[error("the history is zero throughout and cannot be scaled to a peak")]
    ZeroPeak,
    /// The velocity does not come to rest.
    #[error(
        "end velocity {velocity:.4e} m/s is above {limit:.4e} m/s, 1 % of the peak velocity; correct the baseline"
    )]
    EndVelocity {
        /// Velocity at the last sample (m/s).
        velocity: f64,
        /// The permitted magnitude (m/s).
        limit: f64,
    },
    /// The history ends at a displacement that was not declared.
    #[error(
        "end displacement {displacement:.4e} m differs from the declared {declared:.4e} m by more than {limit:.4e} m, 1 % of the peak displacement; correct the baseline or declare it"
    )]
    EndDisplacement {
        /// Displacement at the last sample (m).
        displacement: f64,
        /// What was declared (m).
        declared: f64,
        /// The permitted difference (m).
        limit: f64,
    },
    /// A wave that travels along the free surface has no free field under it.
    #[error(
        "{kind} incidence of {degrees} degrees is above {limit} degrees: a wave along the free surface cancels with its reflection; take a smaller angle, or a full space (Site::FullSpace) whose stress does not vanish on top"
    )]
    GrazingIncidence {
        /// The incident wave.
        kind: WaveKind,
        /// Its angle from the vertical (degrees).
        degrees: f64,
        /// The greatest permitted angle (degrees).
        limit: f64,
    },
    /// A point where the field does not exist.
    #[error("point {index} at z = {height} m lies above the free surface at z = {surface} m")]
    AboveSurface {
        /// Index of the point.
        index: usize,
        /// Its height (m).
        height: f64,
        /// Height of the free surface (m).
        surface: f64,
    },
    /// A point with a coordinate that is not a finite number.
    #[error("point {index} has a coordinate that is not a finite number")]
    PointNotFinite {
        /// Index of the point.
        index: usize,
    },
    /// A record said to be a component of the surface motion that the wave hardly moves.
    #[error(
        "the surface moves by {coefficient:.4} of the incident {kind} wave in {component:?}, less than {limit}: the record cannot be that component"
    )]
    WeakComponent {
        /// The incident wave.
        kind: WaveKind,
        /// The component.
        component: SurfaceComponent,
        /// Magnitude of the surface coefficient.
        coefficient: f64,
        /// The least permitted magnitude.
        limit: f64,
    },
    /// A convention that refers to a free surface, where there is none.
    #[error("the input convention '{convention}' refers to a free surface; a full space has none")]
    NoSurface {
        /// Name of the convention.
        convention: &'static str,
    },
    /// A lasting displacement in a field that is not causal, or that is to be divided by a
    /// transfer function.
    #[error(
        "the signal ends at {displacement:.4e} m; {operation} needs one that returns to zero, since the phase shift of a lasting displacement grows without bound"
    )]
    LastingDisplacement {
        /// What was to be done.
        operation: &'static str,
        /// Displacement after the signal's end (m).
        displacement: f64,
    },
    /// The field is not quiet enough at the start within the permitted padding.
    #[error(
        "with {padding} s of padding the field starts at {level:.3e} of its peak, above {threshold:.3e}"
    )]
    NotQuiet {
        /// The greatest permitted padding (s).
        padding: f64,
        /// Start over peak with it.
        level: f64,
        /// The wanted level.
        threshold: f64,
    },
    /// A sum of no fields.
    #[error("a sum needs at least one field")]
    NoFields,
    /// A sum of fields that live in different media.
    #[error("field {index} lives in another medium than field 0")]
    MediaDiffer {
        /// Index of the field.
        index: usize,
    },
}

impl WaveError {
    /// Refuses to hold more samples than permitted.
    pub(crate) fn check_samples(
        operation: &'static str,
        wanted: f64,
        most: usize,
    ) -> Result<(), Self> {
        if wanted.is_finite() && wanted <= most as f64 {
            return Ok(());
        }
        Err(Self::TooManySamples {
            operation,
            wanted,
            most,
        })
    }
}

impl From<WaveError> for ModelError {
    fn from(error: WaveError) -> Self {
        Self::refused("wave field", error)
    }
}
