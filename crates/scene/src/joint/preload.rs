//! Traction on a joint in the static state from which displacements count.

use powerhouse_model::{ParameterError, Stress, Vec3};

use crate::acting::GRAVITY;

/// Traction on a joint in the static state from which displacements count (preload).
///
/// The other forces that keep the body in that state are not part of the scene: the preload only gives
/// the traction of the joint to which the motion adds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Preload {
    /// Uniform pressure across the joint (Pa), positive in compression.
    Pressure(f64),
    /// Uniform traction on the first side (Pa), in x, y and z.
    Traction(Vec3),
    /// Uniform stress of the body around the joint (Pa); the traction is that on its facets.
    Stress(Stress),
    /// Stress of the ground under its own weight.
    Ground(GroundStress),
}

impl Preload {
    /// Traction (Pa) on the first side at a position (m) with an outward unit normal.
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

/// Stress of ground under its own weight: vertical stress `-rho g (level - z)`, a ratio of it as horizontal
/// stress, no shear; zero above the level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundStress {
    /// Height z of the ground surface (m), at which the stress is zero.
    pub level: f64,
    /// Mass density of the ground `rho` (kg/m3).
    pub density: f64,
    /// Ratio of horizontal to vertical stress (1), 0 or above.
    pub lateral: f64,
}

impl GroundStress {
    /// Stress of ground with a surface at a level (m), a density (kg/m3) and a ratio of horizontal to vertical
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

    /// Stress (Pa, tension positive) at a height z (m); zero above the ground surface.
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
