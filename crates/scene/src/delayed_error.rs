//! Why a body with delayed ends is refused.

use thiserror::Error;

/// Why a slice or bay with delayed ends is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DelayedError {
    /// Several slices.
    #[error("a scene has one pair of delayed sides, and this is another one")]
    Twice,
    /// A field that is no sum of plane waves.
    #[error(
        "delayed sides need plane waves (`[[wave]]`), and the field '{field}' is none: take rollers or periodic pairs for waves across the axis, or a body with its whole length"
    )]
    OtherField {
        /// Name of the field.
        field: String,
    },
    /// Waves with different slownesses along y.
    #[error(
        "all waves of a body with delayed ends have one slowness along y, and those of '{first}' and '{second}' are {:.4e} and {:.4e} s/m: give P, SV and SH of one station the same azimuth, and incidences with sin(i_p)/c_p = sin(i_s)/c_s", slownesses[0], slownesses[1]
    )]
    Slownesses {
        /// Name of the first wave.
        first: String,
        /// Name of the other one.
        second: String,
        /// Their slownesses along y (s/m).
        slownesses: [f64; 2],
    },
    /// A wave past the critical angle.
    #[error(
        "wave '{wave}' is past the critical angle: delayed sides take waves below it, of at most {largest:.1} degrees"
    )]
    PastCritical {
        /// Name of the wave.
        wave: String,
        /// Largest incidence that is permitted (degrees).
        largest: f64,
    },
    /// A part in which P waves are too fast for the motion along y.
    #[error(
        "P waves of part '{set}' travel at {speed:.0} m/s, and the motion along y at {apparent:.0} m/s: the ratio {ratio:.3} must be below {most}; {way}"
    )]
    Fast {
        /// Element set of the part.
        set: String,
        /// Speed of its P waves (m/s).
        speed: f64,
        /// Apparent speed of the waves along y (m/s).
        apparent: f64,
        /// Their ratio (1).
        ratio: f64,
        /// Its bound (1).
        most: f64,
        /// The largest incidence, in words.
        way: String,
    },
    /// Ends that are not normal to y.
    #[error(
        "delayed ends are normal to y, one of them the other translated along y, and those of '{from}' and '{to}' are apart by ({}, {}, {}) m", apart[0], apart[1], apart[2]
    )]
    NotAlong {
        /// Set of the first end.
        from: String,
        /// Set of the other one.
        to: String,
        /// Translation of the first end to the other one (m).
        apart: [f64; 3],
    },
    /// An absorbing face that is a delayed end.
    #[error(
        "'{face}' is one of the two delayed ends, and a face that is delayed cannot absorb: absorb at the bottom and at the sides across x"
    )]
    Absorbing {
        /// Facet set of the face.
        face: String,
    },
    /// Something that a slice or bay with delayed ends does not take.
    #[error("a body with delayed ends does not take {what}: {way}")]
    With {
        /// What it does not take.
        what: String,
        /// The way out.
        way: &'static str,
    },
}
