//! Motion of a slice in the course of a run.

use powerhouse_model::Vec3;
use serde::{Deserialize, Serialize};

/// Motion of a slice by group, between two steps: x and z of velocities and momentum half a step before the present
/// time, y of displacements half a step after it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct DelayedMotion {
    /// Length (s) of the step by which y is staggered.
    pub(crate) step: f64,
    /// Displacement (m): x and z at the present time, y half a step later.
    pub(crate) displacement: Vec<Vec3>,
    /// Velocity (m/s): x and z half a step before, y at the present time.
    pub(crate) velocity: Vec<Vec3>,
    /// Velocity one step before.
    pub(crate) before: Vec<Vec3>,
    /// `P = M V + s T` (N s), at the times of the velocity.
    pub(crate) momentum: Vec<Vec3>,
    /// `T` (N m), at the times of the velocity.
    pub(crate) traction: Vec<Vec3>,
}

impl DelayedMotion {
    /// Displacement (m) and velocity (m/s) of a group at the present time, x and z of the velocity half a step before.
    pub(super) fn now(&self, group: usize) -> [Vec3; 2] {
        let (mut u, v) = (self.displacement[group], self.velocity[group]);
        u.y -= 0.5 * self.step * v.y;
        [u, v]
    }

    /// Displacement (m) and velocity (m/s) of a group at the time of the first velocities of x and z, which is half a step
    /// before the start, for the first `T`: that of x and z depends on the displacement of y, that of y on those of x and z,
    /// which are those of the start.
    pub(super) fn at_start(&self, group: usize) -> [Vec3; 2] {
        let (mut u, v) = (self.displacement[group], self.velocity[group]);
        u.y -= self.step * v.y;
        [u, v]
    }

    /// The same half a step later, once x and z have moved by the step, y of the velocity half a step before.
    pub(super) fn half_step_later(&self, group: usize) -> [Vec3; 2] {
        let (mut u, v) = (self.displacement[group], self.velocity[group]);
        u.x -= 0.5 * self.step * v.x;
        u.z -= 0.5 * self.step * v.z;
        [u, v]
    }

    /// Displacement (m) and mean velocity (m/s) of a group at the present time, between the new velocities of x and z and
    /// the new displacements.
    pub(super) fn centred(&self, group: usize) -> [Vec3; 2] {
        let [u, mut v] = self.now(group);
        let before = &self.before[group];
        v.x = 0.5 * (before.x + v.x);
        v.z = 0.5 * (before.z + v.z);
        [u, v]
    }
}
