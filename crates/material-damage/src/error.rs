//! What a law or its driver refuses.

use powerhouse_model::{ModelError, ParameterError};
use thiserror::Error;

/// A law that cannot be made, or a path that cannot be followed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A law that dilates more than associated flow gains energy from nothing.
    #[error("dilation = {dilation} degrees is above friction = {friction} degrees")]
    Dilation {
        /// Dilation angle (degrees).
        dilation: f64,
        /// Friction angle (degrees).
        friction: f64,
    },
    /// Uniaxial strengths between which a plane of friction has no place.
    #[error("f_c / f_t = {ratio} is not above N = {least} of the friction, or above 1e6")]
    StrengthRatio {
        /// Compressive over tensile strength.
        ratio: f64,
        /// `(1 + sin phi) / (1 - sin phi)`.
        least: f64,
    },
    /// An element so wide that its elastic energy at the peak exceeds what the crack may take.
    #[error(
        "an element of {size:.4} m snaps back in {}: the fracture energy there suffices for widths up to {largest:.4} m, this one needs more than {:.3} times as much",
        of.words(),
        size / largest
    )]
    SnapBack {
        /// The softening at which it does.
        of: SofteningOf,
        /// The width normal to the crack or the band (m).
        size: f64,
        /// The largest permitted width (m).
        largest: f64,
    },
    /// Softening so slow that the stress rises after the first damage.
    #[error("B e0 = {product} is below 1: the stress would rise after first damage")]
    Hardening {
        /// The softening rate times the threshold strain.
        product: f64,
    },
    /// A strain or a stress that is not finite.
    #[error("step {step}: the {what} is not finite")]
    NotFinite {
        /// The step of the path, from 0.
        step: usize,
        /// Strain or stress.
        what: &'static str,
    },
    /// No strain gives the stress that the path asks for.
    #[error(
        "step {step}: the stress misses its target by {residual} Pa (tolerance {tolerance} Pa)"
    )]
    Unreachable {
        /// The step of the path, from 0.
        step: usize,
        /// Largest difference (Pa).
        residual: f64,
        /// What was asked (Pa).
        tolerance: f64,
    },
}

/// Which softening of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SofteningOf {
    /// Cracking.
    Tension,
    /// Crushing.
    Compression,
    /// The loss of cohesion and friction along a shear band.
    Shear,
}

impl SofteningOf {
    fn words(self) -> &'static str {
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
