//! Motion of a slice in the course of a run.

use powerhouse_model::Vec3;
use serde::{Deserialize, Serialize};

/// Motion along some axes, by group.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Along<V> {
    /// Displacement (m).
    pub(crate) displacement: Vec<V>,
    /// Velocity (m/s), half a step before the displacement.
    pub(crate) velocity: Vec<V>,
    /// Velocity one step before.
    pub(crate) before: Vec<V>,
    /// `P = M V + s T` (N s), at the times of the velocity; empty in slices of linear elements.
    pub(crate) momentum: Vec<V>,
    /// `T` (N m), at the times of the velocity; likewise.
    pub(crate) traction: Vec<V>,
}

/// Motion of a slice by group, between two steps: x and z of displacements and y of velocities are at the present time, x and z of
/// velocities half a step before it and y of displacements half a step after it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct DelayedMotion {
    /// Length (s) of the step by which y is staggered.
    pub(crate) step: f64,
    /// Along x and z.
    pub(crate) plane: Along<[f64; 2]>,
    /// Along y.
    pub(crate) axial: Along<f64>,
}

/// The axes that are updated together.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Part {
    Plane,
    Axial,
}

impl Part {
    /// The components along the axes, others zero.
    pub(super) fn of(self, vector: Vec3) -> Vec3 {
        match self {
            Self::Plane => Vec3::new(vector.x, 0.0, vector.z),
            Self::Axial => Vec3::new(0.0, vector.y, 0.0),
        }
    }
}

fn vector(plane: &[[f64; 2]], axial: &[f64], group: usize) -> Vec3 {
    let [x, z] = plane[group];
    Vec3::new(x, axial[group], z)
}

impl DelayedMotion {
    /// At rest, of a number of groups.
    pub(super) fn still(groups: usize, step: f64) -> Self {
        fn along<V: Copy + Default>(groups: usize) -> Along<V> {
            Along {
                displacement: vec![V::default(); groups],
                velocity: vec![V::default(); groups],
                before: vec![V::default(); groups],
                ..Along::default()
            }
        }
        Self {
            step,
            plane: along(groups),
            axial: along(groups),
        }
    }

    /// Displacement (m) of a group, y half a step after x and z.
    pub(super) fn displacement(&self, group: usize) -> Vec3 {
        vector(&self.plane.displacement, &self.axial.displacement, group)
    }

    /// Last velocity (m/s) of a group along each axis.
    pub(super) fn velocity(&self, group: usize) -> Vec3 {
        vector(&self.plane.velocity, &self.axial.velocity, group)
    }

    /// Velocity (m/s) of a group one step before the last one.
    pub(super) fn before(&self, group: usize) -> Vec3 {
        vector(&self.plane.before, &self.axial.before, group)
    }

    /// Momentum (N s) of a group, in slices of other than linear elements.
    pub(super) fn momentum(&self, group: usize) -> Vec3 {
        vector(&self.plane.momentum, &self.axial.momentum, group)
    }

    /// `T` (N m) of a group, in slices of other than linear elements.
    pub(super) fn traction(&self, group: usize) -> Vec3 {
        vector(&self.plane.traction, &self.axial.traction, group)
    }

    /// Displacement (m) and velocity (m/s) of a group at the present time, x and z of the velocity half a step before.
    pub(super) fn now(&self, group: usize) -> [Vec3; 2] {
        let (mut u, v) = (self.displacement(group), self.velocity(group));
        u.y -= 0.5 * self.step * v.y;
        [u, v]
    }

    /// Displacement (m) and velocity (m/s) of a group at the time of the first velocities of x and z, which is half a step
    /// before the start, for the first `T`: that of x and z depends on the displacement of y, that of y on those of x and z,
    /// which are those of the start.
    pub(super) fn at_start(&self, group: usize) -> [Vec3; 2] {
        let (mut u, v) = (self.displacement(group), self.velocity(group));
        u.y -= self.step * v.y;
        [u, v]
    }

    /// The same half a step later, once x and z have moved by the step, y of the velocity half a step before.
    pub(super) fn half_step_later(&self, group: usize) -> [Vec3; 2] {
        let (mut u, v) = (self.displacement(group), self.velocity(group));
        u.x -= 0.5 * self.step * v.x;
        u.z -= 0.5 * self.step * v.z;
        [u, v]
    }

    /// Displacement (m) and mean velocity (m/s) of a group at the present time, between the new velocities of x and z and
    /// the new displacements.
    pub(super) fn centred(&self, group: usize) -> [Vec3; 2] {
        let [u, mut v] = self.now(group);
        let [x, z] = self.plane.before[group];
        v.x = 0.5 * (x + v.x);
        v.z = 0.5 * (z + v.z);
        [u, v]
    }

    /// Velocities (m/s) of a group half a step before and after the present time, between the new velocities of x and z and the new
    /// displacements: that of y after it is not known yet, and changes as in the step before.
    pub(super) fn around(&self, group: usize) -> (Vec3, Vec3) {
        let (mut before, mut after) = (self.before(group), self.velocity(group));
        let (present, change) = (after.y, 0.5 * (after.y - before.y));
        (before.y, after.y) = (present - change, present + change);
        (before, after)
    }
}
