//! Viscosity of a part at the highest frequencies of its elements.

use core::fmt;

use crate::Topic;
use crate::remark::{Kind, described};

/// Viscosity of a part that damps the highest frequencies of its elements, [`Part::high`](crate::Part::high).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct HighDamping {
    /// Element set of the part.
    pub set: String,
    /// Damping ratio at the highest frequency (1).
    pub ratio: f64,
    /// Highest natural frequency of a single element (Hz), above those of the body.
    pub highest: f64,
    /// Coefficient of damping proportional to stiffness (s): the ratio at a frequency `f` is `pi f` times it.
    pub coefficient: f64,
}

impl HighDamping {
    /// Damping ratio at a frequency in Hz (1).
    pub fn at(&self, frequency: f64) -> f64 {
        core::f64::consts::PI * frequency * self.coefficient
    }
    /// Stable step of an element with the highest frequency over that without the viscosity (1), `sqrt(1 + z^2) - z` of the ratio
    /// `z`.
    pub fn step(&self) -> f64 {
        self.ratio.hypot(1.0) - self.ratio
    }
}

described!(HighDamping, |_| Kind::Fact(Topic::Run));

impl fmt::Display for HighDamping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "viscosity of part '{}': {} % of critical at {:.0} Hz, the highest natural frequency of its elements, {:.2} % at 50 Hz and {:.3} % at 10 Hz; the stable step of its smallest element is {:.3} of that without it, and its stress is not contained in any output",
            self.set,
            crate::magnitude::rounded(100.0 * self.ratio),
            self.highest,
            100.0 * self.at(50.0),
            100.0 * self.at(10.0),
            self.step(),
        )
    }
}
