//! Nodal forces.

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
