//! Rayleigh coefficients from a damping ratio at two frequencies.

use core::f64::consts::TAU;

use crate::{ParameterError, Rayleigh};

impl Rayleigh {
    /// Rayleigh coefficients for a damping ratio (fraction of critical) that is the same at two frequencies (Hz).
    ///
    /// The ratio at an angular frequency `w` is `(mass / w + stiffness w) / 2` (Rayleigh 1877), so
    /// `mass = 2 ratio w1 w2 / (w1 + w2)` and `stiffness = 2 ratio / (w1 + w2)`. Between the two
    /// frequencies (Hz) the damping is less, beyond them more. The stiffness part shortens the
    /// stable step.
    ///
    /// ```
    /// let damping = powerhouse_model::Rayleigh::from_ratio(0.05, 1.0, 10.0)?;
    /// let w = core::f64::consts::TAU * 10.0;
    /// assert!((0.5 * (damping.mass / w + damping.stiffness * w) - 0.05).abs() < 1e-15);
    /// # Ok::<(), powerhouse_model::ParameterError>(())
    /// ```
    ///
    /// # Errors
    /// If the ratio is outside [0, 1], or a frequency is not positive.
    pub fn from_ratio(ratio: f64, first: f64, second: f64) -> Result<Self, ParameterError> {
        ParameterError::check("ratio", ratio, 0.0, 1.0)?;
        ParameterError::check("first frequency", first, f64::MIN_POSITIVE, f64::MAX)?;
        ParameterError::check("second frequency", second, f64::MIN_POSITIVE, f64::MAX)?;
        let (w1, w2) = (TAU * first, TAU * second);
        Ok(Self {
            mass: 2.0 * ratio * w1 * w2 / (w1 + w2),
            stiffness: 2.0 * ratio / (w1 + w2),
        })
    }
}
