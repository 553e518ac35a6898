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
    /// From the masses (kg) of the first nodes of the mesh.
    pub(crate) fn new(mass: Vec<f64>, acceleration: Vec3, history: Box<dyn TimeFunction>) -> Self {
        Self {
            nodes: (0..mass.len() as u32).collect(),
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
