//! Velocity ratio B of viscous-spring boundaries.

use powerhouse_boundary::AxisParameters;

use powerhouse_model::keys::words_or_number;

/// Velocity ratio B of a viscous-spring boundary: physical over apparent wave speed, by which dashpots are
/// multiplied.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum DashpotRatio {
    /// Value of Wang, Chen & Xiao (2019), 1.1.
    Paper,
    /// A given ratio, 0.1 to 10.
    Number(f64),
}

impl DashpotRatio {
    /// Value of the ratio.
    pub fn get(self) -> f64 {
        match self {
            Self::Paper => AxisParameters::PAPER.speed_ratio,
            Self::Number(ratio) => ratio,
        }
    }
}

words_or_number! {
    DashpotRatio { "paper" => Paper, number => Number }
    "\"paper\" or a number of 0.1 to 10", |x| (0.1..=10.0).contains(&x), { "type": "number", "minimum": 0.1, "maximum": 10 }
}
