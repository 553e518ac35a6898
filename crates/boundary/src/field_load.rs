//! Forces that follow from the motion of a field.

use powerhouse_model::{FieldMotion, FieldSampler, IncidentField, ModelError, NodalLoad, Vec3};

/// What a motion of the ground does to nodes, in the order of both.
pub(crate) trait FieldForces: Send + 'static {
    /// Adds the forces (N).
    fn add(&self, motion: &[FieldMotion], forces: &mut [Vec3]);
}

/// The forces of a field on some nodes.
struct FieldLoad<F> {
    name: String,
    nodes: Vec<u32>,
    sampler: Box<dyn FieldSampler>,
    /// The field's motion at the nodes, kept to save its allocation in every step.
    motion: Vec<FieldMotion>,
    forces: F,
}

/// The load of a field on nodes at their positions (m).
pub(crate) fn field_load(
    field: &dyn IncidentField,
    nodes: Vec<u32>,
    positions: &[Vec3],
    forces: impl FieldForces,
) -> Result<Box<dyn NodalLoad>, ModelError> {
    Ok(Box::new(FieldLoad {
        name: field.name().into(),
        nodes,
        sampler: field.prepare(positions)?,
        motion: vec![FieldMotion::default(); positions.len()],
        forces,
    }))
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
