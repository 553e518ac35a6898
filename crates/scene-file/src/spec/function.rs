//! Functions of time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Finite, Positive};

/// Dimensionless function of time by which a load or a prescribed motion is multiplied.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Function {
    /// Constant one.
    Constant {},
    /// Linear ramp from zero at t = 0 to one, constant one thereafter.
    Ramp {
        /// Duration of the ramp (s), above 0.
        duration: Positive,
    },
    /// Sine function `sin(2 pi f t)`.
    Sine {
        /// Frequency (Hz).
        frequency: Positive,
    },
    /// Ricker pulse with peak one, `(1 - 2 a) exp(-a)` with `a = (pi f (t - delay))^2`.
    Ricker {
        /// Central frequency (Hz).
        frequency: Positive,
        /// Time of the peak (s).
        delay: Finite,
    },
    /// Piecewise linear function through given points, constant before the first and after the last.
    Table {
        /// Times of the points (s), strictly increasing.
        times: Vec<Finite>,
        /// Values at the times, as many as times.
        values: Vec<Finite>,
    },
}

/// Analytic displacement pulse of an incident wave, in place of a record.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Pulse {
    /// One-sided smooth pulse of displacement that starts and ends with zero displacement and velocity.
    Smooth {
        /// Peak displacement (m), above 0.
        displacement: Positive,
        /// Duration of the pulse (s), above 0.
        duration: Positive,
    },
    /// Two-sided smooth pulse of displacement with zero mean.
    ZeroMean {
        /// Peak displacement (m), above 0.
        displacement: Positive,
        /// Duration of the pulse (s), above 0.
        duration: Positive,
    },
    /// Ricker pulse of displacement.
    Ricker {
        /// Peak displacement (m), above 0.
        displacement: Positive,
        /// Central frequency (Hz).
        frequency: Positive,
        /// Time of the peak after the arrival (s), above 0; by default long enough for a negligible motion at the
        /// arrival.
        delay: Option<Positive>,
    },
    /// Tone burst: cycles of a harmonic displacement under a smooth window.
    Burst {
        /// Peak displacement (m), above 0.
        displacement: Positive,
        /// Frequency (Hz), above 0.
        frequency: Positive,
        /// Number of cycles, above 0.
        cycles: Positive,
    },
}
