//! The traction on a joint in the state from which displacements are counted.

use powerhouse_model::{ParameterError, Stress, Vec3};

use crate::format::GRAVITY;

/// The traction on a joint in the state from which displacements are counted.
///
/// What else keeps the body in that state is not part of the scene: it only says what the joint has
/// to carry before the motion adds to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Preload {
    /// Pressure across it (Pa), positive where the sides are pressed together.
    Pressure(f64),
    /// Traction on its first side (Pa), in x, y and z.
    Traction(Vec3),
    /// Stress of the body around it (Pa), the same everywhere; the traction is that on its facets.
    Stress(Stress),
    /// Stress of ground under its own weight.
    Ground(GroundStress),
}

impl Preload {
    /// Traction (Pa) on the first side at a position (m), whose outward normal is given.
    pub fn traction(&self, position: &Vec3, normal: &Vec3) -> Vec3 {
        match self {
            Self::Pressure(pressure) => -normal * *pressure,
            Self::Traction(traction) => *traction,
            Self::Stress(stress) => stress.traction(normal),
            Self::Ground(ground) => ground.at(position.z).traction(normal),
        }
    }

    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let finite = |value: f64| ParameterError::check("preload", value, -f64::MAX, f64::MAX);
        match self {
            Self::Pressure(pressure) => finite(*pressure),
            Self::Traction(traction) => traction.iter().try_for_each(|&value| finite(value)),
            Self::Stress(stress) => stress.0.iter().try_for_each(|&value| finite(value)),
            Self::Ground(ground) => ground.check(),
        }
    }
}

/// Stress of ground under its own weight: `-rho g (level - z)` vertically, a share of that
/// horizontally, no shear; none above the level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundStress {
    /// Height of its surface (m).
    pub level: f64,
    /// Density `rho` (kg/m3).
    pub density: f64,
    /// Horizontal over vertical stress.
    pub lateral: f64,
}

impl GroundStress {
    /// Ground with a surface at a level (m), a density (kg/m3) and a ratio of horizontal to vertical
    /// stress, not negative.
    ///
    /// # Errors
    /// Whichever is out of range.
    pub fn new(level: f64, density: f64, lateral: f64) -> Result<Self, ParameterError> {
        let ground = Self {
            level,
            density,
            lateral,
        };
        ground.check().map(|()| ground)
    }

    /// Stress (Pa) at a height (m).
    pub fn at(&self, z: f64) -> Stress {
        let vertical = -self.density * GRAVITY * (self.level - z).max(0.0);
        let lateral = self.lateral * vertical;
        Stress([lateral, lateral, vertical, 0.0, 0.0, 0.0])
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::check("level", self.level, -f64::MAX, f64::MAX)?;
        ParameterError::check("density", self.density, f64::MIN_POSITIVE, f64::MAX)?;
        ParameterError::check("lateral", self.lateral, 0.0, f64::MAX)
    }
}
