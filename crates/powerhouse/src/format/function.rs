//! Functions of time.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{Finite, Positive};

/// A factor as a function of time, by which a load is multiplied.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Function {
    /// One at all times.
    Constant {},
    /// From zero to one in a time, one thereafter.
    Ramp {
        /// How long the ramp takes (s).
        duration: Positive,
    },
    /// A sine, `sin(2 pi f t)`.
    Sine {
        /// Frequency (Hz).
        frequency: Positive,
    },
    /// A Ricker pulse with peak one, `(1 - 2 a) exp(-a)` with `a = (pi f (t - delay))^2`.
    Ricker {
        /// Central frequency (Hz).
        frequency: Positive,
        /// When the peak comes (s).
        delay: Finite,
    },
    /// Straight lines between points, constant before the first and after the last.
    Table {
        /// Times (s), rising.
        times: Vec<Finite>,
        /// Values at the times.
        values: Vec<Finite>,
    },
}

/// A test pulse in place of a record: the displacement of the incident wave.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Pulse {
    /// A smooth bump of displacement that starts and ends at rest at zero.
    Smooth {
        /// Greatest displacement (m).
        displacement: Positive,
        /// Length (s).
        duration: Positive,
    },
    /// A smooth swing of displacement to both sides, with mean zero.
    ZeroMean {
        /// Greatest displacement (m).
        displacement: Positive,
        /// Length (s).
        duration: Positive,
    },
    /// A Ricker pulse in displacement.
    Ricker {
        /// Greatest displacement (m).
        displacement: Positive,
        /// Central frequency (Hz).
        frequency: Positive,
        /// Time of the peak after the arrival (s), by default long enough to start from rest.
        delay: Option<Positive>,
    },
    /// Some cycles of a harmonic motion under a smooth window.
    Burst {
        /// Greatest displacement (m).
        displacement: Positive,
        /// Frequency (Hz).
        frequency: Positive,
        /// Number of cycles.
        cycles: Positive,
    },
}
