//! Units of acceleration.

/// Unit of acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum AccelerationUnit {
    /// Metre per second squared (m/s2).
    MetrePerSecondSquared,
    /// Centimetre per second squared (gal).
    Gal,
    /// Standard gravity, 9.80665 m/s2.
    Gravity,
}

impl AccelerationUnit {
    /// Value of the unit in m/s2.
    pub fn factor(self) -> f64 {
        match self {
            Self::MetrePerSecondSquared => 1.0,
            Self::Gal => 0.01,
            Self::Gravity => 9.80665,
        }
    }
    /// Name of the unit in scenes and messages: `m/s2`, `cm/s2` or `g`.
    pub fn name(self) -> &'static str {
        match self {
            Self::MetrePerSecondSquared => "m/s2",
            Self::Gal => "cm/s2",
            Self::Gravity => "g",
        }
    }
    /// Unit of a name; `cm/s2` is `gal`, case does not matter. The second may be `s` or `sec`,
    /// its square `s2`, `s^2`, `s**2` or `s/s`.
    pub fn from_name(name: &str) -> Option<Self> {
        let plain = name
            .trim()
            .to_ascii_lowercase()
            .replace("sec", "s")
            .replace("**", "")
            .replace('^', "")
            .replace("/s/s", "/s2");
        Some(match plain.as_str() {
            "m/s2" => Self::MetrePerSecondSquared,
            "gal" | "cm/s2" => Self::Gal,
            "g" => Self::Gravity,
            _ => return None,
        })
    }
}
