//! The weight of a model.

use powerhouse_model::{NodalLoad, TimeFunction, Vec3};

/// Weight: lumped mass times acceleration times a function of time.
pub(crate) struct Weight {
    nodes: Vec<u32>,
    mass: Vec<f64>,
    acceleration: Vec3,
    history: Box<dyn TimeFunction>,
}

impl Weight {
    /// From nodes (mesh indices) and their masses (kg).
    pub(crate) fn new(
        (nodes, mass): (Vec<u32>, Vec<f64>),
        acceleration: Vec3,
        history: Box<dyn TimeFunction>,
    ) -> Self {
        Self {
            nodes,
            mass,
            acceleration,
            history,
        }
    }
}

impl NodalLoad for Weight {
    fn name(&self) -> &str {
        "weight"
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]) {
        let now = self.acceleration * self.history.value(time);
        for (force, mass) in forces.iter_mut().zip(&self.mass) {
            *force += now * *mass;
        }
    }
    fn is_constant(&self) -> bool {
        self.history.is_constant()
    }
}
