//! The motion of the site without the structure.

use crate::{ElasticMedium, ModelError, Stress, Vec3};

/// Displacement, velocity and stress of a field at one point and time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldMotion {
    /// Displacement (m).
    pub displacement: Vec3,
    /// Velocity (m/s).
    pub velocity: Vec3,
    /// Stress (Pa), the change that the wave makes.
    pub stress: Stress,
}

impl core::ops::AddAssign for FieldMotion {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.displacement += other.displacement;
        self.velocity += other.velocity;
        for i in 0..6 {
            self.stress.0[i] += other.stress.0[i];
        }
    }
}

/// An elastic wave field that satisfies the equations of motion in the whole site.
///
/// Fields add up: the sum of two incident fields is an incident field.
/// ```
/// use powerhouse_model::{ElasticMedium, FieldMotion, FieldSampler, IncidentField, ModelError, Vec3};
/// struct Still(ElasticMedium);
/// struct StillSampler(usize);
/// impl IncidentField for Still {
///     fn name(&self) -> &str { "still" }
///     fn medium(&self) -> ElasticMedium { self.0 }
///     fn incident_part(&self) -> Option<Box<dyn IncidentField>> { None }
///     fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
///         Ok(Box::new(StillSampler(points.len())))
///     }
/// }
/// impl FieldSampler for StillSampler {
///     fn len(&self) -> usize { self.0 }
///     fn add_motion(&self, _time: f64, _motion: &mut [FieldMotion]) {}
/// }
/// ```
pub trait IncidentField: Send + Sync {
    /// The field's name in reports.
    fn name(&self) -> &str;
    /// The medium that the field lives in.
    fn medium(&self) -> ElasticMedium;
    /// The incoming wave alone, without what the free surface reflects, where the field knows it.
    fn incident_part(&self) -> Option<Box<dyn IncidentField>>;
    /// A sampler for fixed points (m), with every constant ready.
    ///
    /// # Errors
    /// If the field is not defined at a point, such as above its free surface.
    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError>;
}

/// Samples a field at fixed points; [`IncidentField::prepare`] makes it, and its documentation has
/// an example.
pub trait FieldSampler: Send + Sync {
    /// How many points.
    fn len(&self) -> usize;
    /// Whether there are no points.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Adds the field's motion at a time (s) to `motion`, in the order of the points.
    ///
    /// # Panics
    /// May panic if `motion` is shorter than [`len`](Self::len).
    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]);
}
