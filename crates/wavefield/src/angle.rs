//! Angles with their unit in the name.

/// An angle; its unit is named where it is made and where it is read.
///
/// ```
/// use powerhouse_wavefield::Angle;
/// assert!((Angle::from_degrees(30.0).radians().sin() - 0.5).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Angle(f64);

impl Angle {
    /// No angle.
    pub const ZERO: Self = Self(0.0);

    /// From degrees.
    pub fn from_degrees(degrees: f64) -> Self {
        Self(degrees.to_radians())
    }
    /// From radians.
    pub fn from_radians(radians: f64) -> Self {
        Self(radians)
    }
    /// In degrees.
    pub fn degrees(self) -> f64 {
        self.0.to_degrees()
    }
    /// In radians.
    pub fn radians(self) -> f64 {
        self.0
    }
}
