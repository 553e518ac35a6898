//! Nodal forces that are computed from the motion of a free field.

use powerhouse_model::{FieldMotion, FieldSampler, NodalLoad, Vec3};

/// Nodal forces as a function of the field's motion at the same nodes, in the same order.
pub(crate) trait FieldForces: Send + 'static {
    /// Adds the forces (N) of a motion to `forces`.
    fn add(&self, motion: &[FieldMotion], forces: &mut [Vec3]);
}

/// Nodal load that follows from a field.
struct FieldLoad<F> {
    name: String,
    nodes: Vec<u32>,
    sampler: Box<dyn FieldSampler>,
    /// Motion of the field at the nodes, a buffer that is reused in every step.
    motion: Vec<FieldMotion>,
    forces: F,
}

/// Load on nodes of a field with a name, from its sampler at their positions.
pub(crate) fn field_load(
    name: &str,
    nodes: Vec<u32>,
    sampler: Box<dyn FieldSampler>,
    forces: impl FieldForces,
) -> Box<dyn NodalLoad> {
    Box::new(FieldLoad {
        name: name.into(),
        motion: vec![FieldMotion::default(); nodes.len()],
        nodes,
        sampler,
        forces,
    })
}

impl<F: FieldForces> NodalLoad for FieldLoad<F> {
    fn name(&self) -> &str {
        &self.name
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]) {
        self.motion.fill(FieldMotion::default());
        self.sampler.add_motion(time, &mut self.motion);
        self.forces.add(&self.motion, forces);
    }
}
