//! Tolerance of the energy balance.

use super::quantity::words_or_number;

/// Tolerance of the energy balance: relative residual above which a run stops.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Residual {
    /// Default of the precision: 1e-7 in double, 1e-4 in mixed, 1e-2 in single.
    #[default]
    Auto,
    /// Given tolerance over the largest energy, above 0 and at most 1.
    Share(f64),
    /// No check of the balance.
    Off,
}

words_or_number! {
    Residual { "auto" => Auto, "off" => Off, number => Share }
    "\"auto\", \"off\" or a number above 0 and at most 1", |x| x > 0.0 && x <= 1.0, { "type": "number", "exclusiveMinimum": 0, "maximum": 1 }
}
