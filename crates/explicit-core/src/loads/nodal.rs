//! Nodal forces and weight.

use powerhouse_model::{NodalLoad, TimeFunction, Vec3};

/// A nodal force: the same force vector at every node of a list, times a function of time.
pub struct NodalForce {
    nodes: Vec<u32>,
    force: Vec3,
    history: Box<dyn TimeFunction>,
}

impl NodalForce {
    /// A load of `force` (N) at each of `nodes` (mesh indices), times `history`.
    pub fn new(nodes: Vec<u32>, force: Vec3, history: Box<dyn TimeFunction>) -> Self {
        Self {
            nodes,
            force,
            history,
        }
    }
}

impl NodalLoad for NodalForce {
    fn name(&self) -> &str {
        "nodal force"
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]) {
        let now = self.force * self.history.value(time);
        for force in forces {
            *force += now;
        }
    }
    fn is_constant(&self) -> bool {
        self.history.is_constant()
    }
}

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
