//! Velocity update of the nodes of constraints, most of which have a scalar mass only. This is hot code.

use powerhouse_model::{MassDampingRule, Vec3};

use crate::gather::SlotTable;
use crate::node_group::NodeGroup;
use crate::nodes::{NodalArrays, Storage};
use crate::tiled::{TILE, TiledSlots};

/// Displacement and velocities of some nodes of constraints, in their order.
pub(crate) struct ConstrainedMotion<'a> {
    /// Displacement (m) at the step's start.
    pub(crate) displacement: &'a mut [Vec3],
    /// Velocity before the step (m/s).
    pub(crate) previous: &'a mut [Vec3],
    /// Velocity after it (m/s).
    pub(crate) next: &'a mut [Vec3],
}

/// Coefficients of the velocity update of a node with a scalar mass only (no dashpot, spring, support or tie),
/// as on the sides of a joint.
#[derive(Clone, Copy, Debug, Default)]
struct ScalarKick {
    /// New velocity per old velocity.
    carry: f64,
    /// Velocity per force (m/s/N); zero at nodes that need the matrices of their group.
    response: f64,
}

/// The nodes of all constraints, constraint by constraint; their groups have the same order.
#[derive(Default)]
pub(crate) struct ConstrainedNodes {
    nodes: Vec<u32>,
    slots: TiledSlots,
    /// Coefficients of nodes with a scalar mass only.
    scalar: Vec<ScalarKick>,
    /// Effective masses (kg) of these nodes.
    masses: Vec<Option<f64>>,
}

impl ConstrainedNodes {
    /// From the engine nodes of all constraints, whose groups are the first ones.
    pub(crate) fn new(nodes: &[u32], groups: &[NodeGroup], slots: &SlotTable) -> Self {
        let own = groups.iter().take(nodes.len());
        let masses = own.map(|group| group.has_scalar_mass().then_some(0.0));
        Self {
            nodes: nodes.to_vec(),
            slots: TiledSlots::new(nodes, slots),
            masses: masses.collect(),
            scalar: vec![ScalarKick::default(); nodes.len()],
        }
    }

    /// Number of nodes.
    pub(crate) fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Effective mass (kg) of a node with a scalar mass only; none for other nodes.
    #[inline]
    pub(crate) fn scalar_mass(&self, group: usize) -> Option<f64> {
        *self.masses.get(group)?
    }

    /// Computes the coefficients for a length of step (s).
    pub(crate) fn prepare(&mut self, groups: &[NodeGroup], rule: MassDampingRule, step: f64) {
        for ((known, scalar), group) in self.masses.iter_mut().zip(&mut self.scalar).zip(groups) {
            if let Some(known) = known {
                let (mass, old) = group.effective_mass(rule, step);
                let (carry, response) = (old / mass, step / mass);
                (*known, *scalar) = (mass, ScalarKick { carry, response });
            }
        }
    }

    /// Predicts the velocity of the nodes of a tile: nodes with a scalar mass from the forces on
    /// them, the others by `kicked`, which returns the velocities before and after first. If the nodes have
    /// `moved` by a step (s) since the last kick with the velocity `motion.previous`, their displacement follows
    /// from it and is not gathered.
    pub(crate) fn kick<S: Storage>(
        &self,
        (tile, moved): (usize, Option<f64>),
        motion: ConstrainedMotion,
        arrays: &NodalArrays<S>,
        applied: impl Fn(usize) -> Vec3,
        kicked: impl Fn(usize) -> [Vec3; 3],
    ) {
        let start = tile * TILE;
        let count = motion.next.len();
        let nodes = &self.nodes[start..start + count];
        if let Some(step) = moved {
            for (displacement, velocity) in motion.displacement.iter_mut().zip(&*motion.previous) {
                *displacement += velocity * step;
            }
        } else {
            for (displacement, &node) in motion.displacement.iter_mut().zip(nodes) {
                *displacement = arrays.displacement[node as usize].to_vector();
            }
            for (previous, &node) in motion.previous.iter_mut().zip(nodes) {
                *previous = arrays.velocity[node as usize].to_vector();
            }
        }
        let sums = self.slots.sums(tile, arrays);
        for i in 0..count {
            let g = start + i;
            let scalar = &self.scalar[g];
            if scalar.response > 0.0 {
                let force = applied(g) - sums[i].to_vector();
                motion.next[i] = motion.previous[i] * scalar.carry + force * scalar.response;
            } else {
                [motion.previous[i], motion.next[i], _] = kicked(g);
            }
        }
    }
}
