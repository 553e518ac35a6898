//! Sums of the forces at some nodes, tile by tile. This is hot code.

use core::ops::Range;

use powerhouse_model::Quad;

use crate::gather::SlotTable;
use crate::nodes::{NodalArrays, Storage};

/// Nodes per tile: each quantity is gathered for all nodes of a tile in one short loop, so that many
/// memory loads overlap.
pub(crate) const TILE: usize = 64;

/// Slots of the forces of some nodes.
#[derive(Default)]
pub(crate) struct TiledSlots {
    /// The first slot of each node.
    first: Vec<u32>,
    /// All further slots: index of the node in its tile, and slot.
    further: Vec<(u32, u32)>,
    /// Further slots of each tile.
    tiles: Vec<Range<u32>>,
}

impl TiledSlots {
    /// From engine nodes, in their order.
    pub(crate) fn new(nodes: &[u32], slots: &SlotTable) -> Self {
        let (mut further, mut tiles) = (Vec::new(), Vec::new());
        for tile in nodes.chunks(TILE) {
            let start = further.len() as u32;
            for (index, &node) in tile.iter().enumerate() {
                let others = &slots.of(node as usize)[1..];
                further.extend(others.iter().map(|&slot| (index as u32, slot)));
            }
            tiles.push(start..further.len() as u32);
        }
        let first = nodes.iter().map(|&node| slots.of(node as usize)[0]);
        Self {
            first: first.collect(),
            further,
            tiles,
        }
    }

    /// Internal forces (N) at the nodes of a tile.
    #[inline(always)]
    pub(crate) fn sums<S: Storage>(&self, tile: usize, arrays: &NodalArrays<S>) -> [Quad<S>; TILE] {
        let start = tile * TILE;
        let end = (start + TILE).min(self.first.len());
        let mut sums = [Quad::<S>::default(); TILE];
        for (sum, &slot) in sums.iter_mut().zip(&self.first[start..end]) {
            *sum = arrays.forces[slot as usize];
        }
        let further = &self.tiles[tile];
        for &(index, slot) in &self.further[further.start as usize..further.end as usize] {
            let add = &arrays.forces[slot as usize].values;
            let sum = &mut sums[index as usize].values;
            for c in 0..4 {
                sum[c] = sum[c] + add[c];
            }
        }
        sums
    }
}
