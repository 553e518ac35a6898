//! Velocity update of the nodes of fibres that have a mass only and are fixed along coordinate axes or not at all. This is
//! hot code.

use powerhouse_model::Vec3;
use rayon::prelude::*;

use crate::gather::SlotTable;
use crate::node_group::{Coefficients, NodeGroup};
use crate::nodes::{NodalArrays, Storage};
use crate::tiled::{TILE, TiledSlots};

/// The nodes, in the order of their groups.
#[derive(Default)]
pub(crate) struct FibreNodes {
    nodes: Vec<u32>,
    slots: TiledSlots,
    /// New velocity per old velocity, and velocity per force (m/s/N), zero along fixed axes.
    kicks: Vec<[Vec3; 2]>,
}

impl FibreNodes {
    /// From the last groups of those that are kicked.
    pub(crate) fn new(groups: &[NodeGroup], slots: &SlotTable) -> Self {
        let nodes: Vec<u32> = groups.iter().map(|group| group.members[0]).collect();
        Self {
            slots: TiledSlots::new(&nodes, slots),
            kicks: vec![[Vec3::zeros(); 2]; nodes.len()],
            nodes,
        }
    }

    /// Number of nodes.
    pub(crate) fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Computes the coefficients for a length of step (s) from the matrices of their groups.
    pub(crate) fn prepare(&mut self, coefficients: &[Coefficients], step: f64) {
        for (kick, matrices) in self.kicks.iter_mut().zip(coefficients) {
            *kick = [
                matrices.carry.diagonal(),
                matrices.inverse.diagonal() * step,
            ];
        }
    }

    /// Predicts the velocity of the nodes; if they have `moved` with the velocities `previous` in the last step, these are
    /// not gathered.
    pub(crate) fn kick<S: Storage>(
        &self,
        moved: bool,
        (previous, next): (&mut [Vec3], &mut [Vec3]),
        arrays: &NodalArrays<S>,
        applied: impl Fn(usize) -> Vec3 + Sync,
    ) {
        let tiles = next
            .par_chunks_mut(TILE)
            .zip(previous.par_chunks_mut(TILE))
            .enumerate()
            .with_min_len(4);
        tiles.for_each(|(tile, (next, previous))| {
            let start = tile * TILE;
            if !moved {
                for (previous, &node) in previous.iter_mut().zip(&self.nodes[start..]) {
                    *previous = arrays.velocity[node as usize].to_vector();
                }
            }
            let sums = self.slots.sums(tile, arrays);
            let kicks = &self.kicks[start..];
            for (i, (next, previous)) in next.iter_mut().zip(previous).enumerate() {
                let force = applied(start + i) - sums[i].to_vector();
                let [carry, response] = &kicks[i];
                *next = carry.component_mul(previous) + response.component_mul(&force);
            }
        });
    }
}
