//! Units of motions, as headers spell them.

use crate::RecordFault;

/// Unit of acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum AccelerationUnit {
    /// Metre per second squared (m/s2).
    #[default]
    MetrePerSecondSquared,
    /// Centimetre per second squared (gal).
    Gal,
    /// Millimetre per second squared.
    MillimetrePerSecondSquared,
    /// Standard gravity, 9.80665 m/s2.
    Gravity,
    /// One hundredth of standard gravity.
    PercentGravity,
    /// One thousandth of standard gravity.
    MilliGravity,
}

impl AccelerationUnit {
    /// Value of the unit in m/s2.
    pub fn factor(self) -> f64 {
        match self {
            Self::MetrePerSecondSquared => 1.0,
            Self::Gal => 0.01,
            Self::MillimetrePerSecondSquared => 0.001,
            Self::Gravity => 9.80665,
            Self::PercentGravity => 0.098_066_5,
            Self::MilliGravity => 0.009_806_65,
        }
    }
    /// Name of the unit in scenes and messages: `m/s2`, `cm/s2`, `mm/s2`, `g`, `%g` or `mg`.
    pub fn name(self) -> &'static str {
        match self {
            Self::MetrePerSecondSquared => "m/s2",
            Self::Gal => "cm/s2",
            Self::MillimetrePerSecondSquared => "mm/s2",
            Self::Gravity => "g",
            Self::PercentGravity => "%g",
            Self::MilliGravity => "mg",
        }
    }
    /// Unit of a name; `cm/s2` is `gal`, case does not matter. The second may be `s` or `sec`, its
    /// square `s2`, `s²`, `s^2`, `s**2`, `s/s` or a factor `s-2`.
    pub fn from_name(name: &str) -> Option<Self> {
        let mut plain = name.trim().to_lowercase();
        for (from, to) in [
            ("sec", "s"),
            ("²", "2"),
            ("−", "-"),
            ("⁻", "-"),
            ("**", ""),
            ("^", ""),
            ("(", ""),
            (")", ""),
            ("·", " "),
            ("*", " "),
            ("/s/s", "/s2"),
            (" ", ""),
            (".s-2", "/s2"),
            ("s-2", "/s2"),
        ] {
            plain = plain.replace(from, to);
        }
        Some(match plain.as_str() {
            "m/s2" | "mps2" => Self::MetrePerSecondSquared,
            "gal" | "cm/s2" | "cmps2" => Self::Gal,
            "mm/s2" | "mmps2" => Self::MillimetrePerSecondSquared,
            "g" => Self::Gravity,
            "%g" => Self::PercentGravity,
            "mg" => Self::MilliGravity,
            _ => return None,
        })
    }
}

/// Unit (cm/s2) of a format all files of which are in it, from the word of its header and the rest of that line: a letter that is lost makes
/// another unit of it.
pub(crate) fn always_gal(word: &str, line: &str) -> Result<AccelerationUnit, RecordFault> {
    let found = || line.chars().take(40).collect();
    match AccelerationUnit::from_name(word) {
        Some(AccelerationUnit::Gal) => Ok(AccelerationUnit::Gal),
        Some(_) => Err(RecordFault::UnusualUnit {
            found: found(),
            usual: AccelerationUnit::Gal.name(),
        }),
        None => Err(RecordFault::UnknownUnit { found: found() }),
    }
}

/// Whether a name is that of a unit of velocity or displacement.
pub(crate) fn is_of_other_motion(name: &str) -> bool {
    let plain = name.trim().to_lowercase().replace("sec", "s");
    let plain = plain
        .replace([' ', '.', '·', '^', '('], "")
        .replace(')', "");
    let plain = plain.replace("s-1", "/s");
    let length = plain.strip_suffix("/s").unwrap_or(&plain);
    ["m", "cm", "mm", "in", "ft", "inch", "kine"].contains(&length)
}
