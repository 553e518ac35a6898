//! Tolerance of the energy balance.

use super::quantity::words_or_number;
pub use crate::scene::ResidualLimit as Residual;

words_or_number! {
    Residual { "auto" => OfPrecision, "off" => Unchecked, number => Share }
    "\"auto\", \"off\" or a number above 0 and at most 1", |x| x > 0.0 && x <= 1.0,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1 }
}
