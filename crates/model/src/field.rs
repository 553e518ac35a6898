//! Interface of incident wave fields (free fields).

use crate::{ElasticMedium, ModelError, Stress, Vec3};

/// Displacement, velocity and stress of a wave field at one point and time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldMotion {
    /// Displacement of the ground by the wave (m).
    pub displacement: Vec3,
    /// Velocity of the ground in the wave (m/s).
    pub velocity: Vec3,
    /// Change of stress by the wave (Pa, tension positive): xx, yy, zz, xy, yz, zx.
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

/// An incident wave field: the free-field motion of the elastic site without the structure.
///
/// It satisfies the equations of motion in the whole site. Fields superpose: the sum of two incident fields is an
/// incident field. Samplers are prepared any number of times, also by checks before a run, and used from several threads
/// at any times in any order: the motion depends on point and time alone.
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
    /// Name of the field in reports.
    fn name(&self) -> &str;
    /// Elastic medium of the site; of layered ground, that of the half-space below its layers.
    fn medium(&self) -> ElasticMedium;
    /// Heights z (m) of the interfaces between layers of the site, from the uppermost down; none by default.
    fn interfaces(&self) -> &[f64] {
        &[]
    }
    /// Elastic medium of the site at a point, on an interface that below; [`medium`](Self::medium) by default.
    fn medium_at(&self, _point: &Vec3) -> ElasticMedium {
        self.medium()
    }
    /// Whether the field has a stress, as boundaries need whose springs and dashpots it enters through; true by default.
    /// A field without one, such as motions that are given in a file, enters through the layer of a domain reduction alone,
    /// and the stress of its motion is zero.
    fn carries_stress(&self) -> bool {
        true
    }
    /// Stations (m): the points at which alone the field is given; none by default, for a field that is given everywhere.
    fn stations(&self) -> Option<&[Vec3]> {
        None
    }
    /// Checks the field against the nodes of a layer (m) through which it enters a region by domain reduction; `inner` says
    /// of each node whether it belongs to the region. By default there is nothing to check.
    ///
    /// # Errors
    /// If the field is not given at a node, or says that a node is on the other side.
    fn check_layer(&self, _nodes: &[Vec3], _inner: &[bool]) -> Result<(), ModelError> {
        Ok(())
    }
    /// The incident waves alone, without reflections of the free surface; none if the field has no such decomposition.
    fn incident_part(&self) -> Option<Box<dyn IncidentField>>;
    /// A sampler of the field at fixed points (m), with all constants precomputed.
    ///
    /// # Errors
    /// If the field is not defined at a point, such as above its free surface.
    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError>;
    /// A sampler as that of [`prepare`](Self::prepare) whose stress at each point is that in a given medium of the site.
    ///
    /// On an interface of layers the stress along the interface jumps: a node there has shares of both layers. By default
    /// the sampler of [`prepare`](Self::prepare), for sites of one medium.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare); if a medium is none of those at its point.
    fn prepare_in(
        &self,
        points: &[Vec3],
        _media: &[ElasticMedium],
    ) -> Result<Box<dyn FieldSampler>, ModelError> {
        self.prepare(points)
    }
}

/// Sampler of an incident field at fixed points, returned by [`IncidentField::prepare`]; see [`IncidentField`] for
/// an example.
pub trait FieldSampler: Send + Sync {
    /// Number of points.
    fn len(&self) -> usize;
    /// Whether there are no points.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Adds the motion of the field at a time (s) to what `motion` holds already, in the order of the points.
    ///
    /// # Panics
    /// May panic if `motion` is shorter than [`len`](Self::len).
    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]);
}
