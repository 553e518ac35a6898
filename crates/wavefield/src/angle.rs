//! Angles, converted from and to degrees and radians by name.

/// Plane angle; constructors and accessors name its unit.
///
/// ```
/// use powerhouse_wavefield::Angle;
/// assert!((Angle::from_degrees(30.0).radians().sin() - 0.5).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Angle(f64);

impl Angle {
    /// Zero angle.
    pub const ZERO: Self = Self(0.0);

    /// Angle of a value in degrees.
    pub fn from_degrees(degrees: f64) -> Self {
        Self(degrees.to_radians())
    }
    /// Angle of a value in radians.
    pub fn from_radians(radians: f64) -> Self {
        Self(radians)
    }
    /// Value in degrees.
    pub fn degrees(self) -> f64 {
        self.0.to_degrees()
    }
    /// Value in radians.
    pub fn radians(self) -> f64 {
        self.0
    }
}
