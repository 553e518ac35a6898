//! Errors of laws and of the material point driver.

use powerhouse_model::{ModelError, ParameterError};
use thiserror::Error;

/// Errors of building a law or of following a path with it.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// A parameter is outside its permitted range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The dilation is above associated flow, so that plastic flow would generate energy.
    #[error("dilation = {dilation} degrees is above friction = {friction} degrees")]
    Dilation {
        /// Dilation angle (degrees).
        dilation: f64,
        /// Friction angle (degrees).
        friction: f64,
    },
    /// The ratio of the uniaxial strengths is too small, or too large, for a friction plane through both.
    #[error("f_c / f_t = {ratio} is not above N = {least} of the friction angle, or is above 1e6")]
    StrengthRatio {
        /// Ratio of compressive to tensile strength (1).
        ratio: f64,
        /// Least ratio N, `(1 + sin phi) / (1 - sin phi)` (1).
        least: f64,
    },
    /// The element snaps back: its elastic energy at the peak exceeds the fracture energy. Found by the `check_size` of a
    /// law, for every element before a run.
    #[error(
        "an element of {size:.4} m snaps back in {}: the fracture energy there suffices for widths up to {largest:.4} m, this one needs more than {:.3} times as much",
        of.name(),
        size / largest
    )]
    SnapBack {
        /// Softening in which the element snaps back.
        of: SofteningOf,
        /// Width of the element normal to the crack or the band (m).
        size: f64,
        /// Largest permitted width (m).
        largest: f64,
    },
    /// The softening of a [`Mazars`](crate::Mazars) law is so slow that the stress would rise after first damage: a given
    /// rate, or an element narrower than its fracture energy permits.
    #[error("B e0 = {product} is below 1: the stress would rise after first damage")]
    Hardening {
        /// Softening rate times threshold strain, `B e0` (1).
        product: f64,
    },
    /// A target, strain, stress or history variable is not finite, on the path of a [`PointDriver`](crate::PointDriver).
    #[error("step {step}: the {what} is not finite")]
    NotFinite {
        /// Step of the path, from 0.
        step: usize,
        /// Name of the quantity.
        what: &'static str,
    },
    /// No strain was found whose stress is the target, as past a peak, on the path of a [`PointDriver`](crate::PointDriver).
    #[error(
        "step {step}: the stress misses its target by {residual} Pa (tolerance {tolerance} Pa): beyond its strength a material does not bear a \
         prescribed stress; prescribe a strain there"
    )]
    Unreachable {
        /// Index of the step since the driver was created, from 0.
        step: usize,
        /// Largest difference from the target (Pa).
        residual: f64,
        /// Permitted difference (Pa).
        tolerance: f64,
    },
}

/// Softening mode of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SofteningOf {
    /// Cracking in tension.
    Tension,
    /// Crushing in compression.
    Compression,
    /// Loss of strength along a shear band.
    Shear,
}

impl SofteningOf {
    fn name(self) -> &'static str {
        match self {
            Self::Tension => "tension",
            Self::Compression => "compression",
            Self::Shear => "shear",
        }
    }
}

impl From<MaterialError> for ModelError {
    fn from(error: MaterialError) -> Self {
        match error {
            MaterialError::Parameter(source) => Self::Parameter(source),
            other => Self::refused("material", other),
        }
    }
}
