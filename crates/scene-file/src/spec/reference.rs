//! Reference frequency of the moduli of a damped material.

use super::quantity::words_or_number;

/// Reference frequency at which a material with flat damping has its stated moduli and wave speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Reference {
    /// Geometric centre of the damping band.
    #[default]
    Centre,
    /// Given frequency (Hz), above 0.
    Frequency(f64),
    /// Zero frequency: static moduli.
    Static,
}

words_or_number! {
    Reference { "centre" => Centre, "static" => Static, number => Frequency }
    "\"centre\", \"static\" or a number above 0", |x| x > 0.0, { "type": "number", "exclusiveMinimum": 0 }
}
