//! Tolerance of the energy balance.

use powerhouse_scene::ResidualLimit;

use super::quantity::words_or_number;

/// Tolerance of the energy balance, over the largest energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Residual {
    /// That of the precision.
    #[default]
    OfPrecision,
    /// A share above 0 and at most 1.
    Share(f64),
    /// No limit.
    Unchecked,
}

words_or_number! {
    Residual { "auto" => OfPrecision, "off" => Unchecked, number => Share }
    "\"auto\", \"off\" or a number above 0 and at most 1", |x| x > 0.0 && x <= 1.0,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1 }
}

impl From<Residual> for ResidualLimit {
    fn from(residual: Residual) -> Self {
        match residual {
            Residual::OfPrecision => Self::OfPrecision,
            Residual::Share(limit) => Self::Share(limit),
            Residual::Unchecked => Self::Unchecked,
        }
    }
}
