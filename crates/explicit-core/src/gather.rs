//! Assembly of nodal forces: the sum of the blocks' forces at each node, in a fixed order.

use core::ops::Range;

use powerhouse_model::Quad;

use crate::nodes::Storage;

/// Nodes per parallel task in a pass over nodes.
pub(crate) const CHUNK: usize = 1024;
/// Nodes per tile; the sums of a tile stay in the first-level cache.
pub(crate) const TILE: usize = 64;

/// Consecutive nodes whose first slots are consecutive too.
struct Tile {
    node: u32,
    count: u32,
    slot: u32,
    further: Range<u32>,
}

/// Gather table: positions (slots) of the forces of each node in the concatenated buffers of the blocks, by tiles.
///
/// The first slot of a node is that of the block which owns it; the others follow in the order of
/// the blocks. The sum is taken in that order for any number of threads.
pub(crate) struct Gather {
    tiles: Vec<Tile>,
    /// Tiles of each chunk of nodes.
    chunks: Vec<Range<u32>>,
    /// Node within its tile, and slot.
    further: Vec<(u32, u32)>,
}

impl Gather {
    /// From the slots of each node (offsets and flat list); every node has at least one.
    pub(crate) fn new(slots: &SlotTable) -> Self {
        let count = slots.node_count();
        let mut gather = Self {
            tiles: Vec::new(),
            chunks: Vec::new(),
            further: Vec::new(),
        };
        for start in (0..count).step_by(CHUNK) {
            let first_tile = gather.tiles.len() as u32;
            for node in start..(start + CHUNK).min(count) {
                let of_node = slots.of(node);
                let follows = gather.tiles.len() as u32 > first_tile
                    && gather.tiles.last().is_some_and(|tile| {
                        (tile.count as usize) < TILE && tile.slot + tile.count == of_node[0]
                    });
                if !follows {
                    let end = gather.further.len() as u32;
                    gather.tiles.push(Tile {
                        node: node as u32,
                        count: 0,
                        slot: of_node[0],
                        further: end..end,
                    });
                }
                if let Some(tile) = gather.tiles.last_mut() {
                    let local = tile.count;
                    let others = of_node[1..].iter().map(|&slot| (local, slot));
                    gather.further.extend(others);
                    tile.count += 1;
                    tile.further.end = gather.further.len() as u32;
                }
            }
            gather.chunks.push(first_tile..gather.tiles.len() as u32);
        }
        gather
    }

    /// Calls `visit(first node, sums)` for each tile of a chunk, in rising order of nodes.
    #[inline(always)]
    pub(crate) fn for_chunk<S: Storage>(
        &self,
        chunk: usize,
        forces: &[Quad<S>],
        mut visit: impl FnMut(usize, &mut [Quad<S>]),
    ) {
        let tiles = &self.chunks[chunk];
        let tiles = &self.tiles[tiles.start as usize..tiles.end as usize];
        self.for_tiles(tiles, forces, &mut visit);
    }

    /// Calls `visit(first node, sums)` for consecutive nodes of a range, in rising order.
    pub(crate) fn for_range<S: Storage>(
        &self,
        range: Range<usize>,
        forces: &[Quad<S>],
        mut visit: impl FnMut(usize, &mut [Quad<S>]),
    ) {
        let end = |tile: &Tile| (tile.node + tile.count) as usize;
        let first = self.tiles.partition_point(|tile| end(tile) <= range.start);
        let last = (self.tiles).partition_point(|tile| (tile.node as usize) < range.end);
        self.for_tiles(&self.tiles[first..last], forces, &mut |node, sums| {
            let start = range.start.saturating_sub(node);
            let count = sums.len().min(range.end - node);
            visit(node + start, &mut sums[start..count]);
        });
    }

    #[inline(always)]
    fn for_tiles<S: Storage>(
        &self,
        tiles: &[Tile],
        forces: &[Quad<S>],
        visit: &mut impl FnMut(usize, &mut [Quad<S>]),
    ) {
        let mut sums = [Quad::<S>::default(); TILE];
        for tile in tiles {
            let (slot, count) = (tile.slot as usize, tile.count as usize);
            sums[..count].copy_from_slice(&forces[slot..slot + count]);
            for &(local, slot) in
                &self.further[tile.further.start as usize..tile.further.end as usize]
            {
                let add = &forces[slot as usize].values;
                let sum = &mut sums[local as usize].values;
                for c in 0..4 {
                    sum[c] = sum[c] + add[c];
                }
            }
            visit(tile.node as usize, &mut sums[..count]);
        }
    }
}

/// The slots of every node in the order of summation.
pub(crate) struct SlotTable {
    offsets: Vec<u32>,
    slots: Vec<u32>,
}

impl SlotTable {
    /// From the nodes of each block, whose buffers lie one behind the other.
    pub(crate) fn new<'a>(
        node_count: usize,
        blocks: impl Iterator<Item = &'a [u32]> + Clone,
    ) -> Self {
        Self::of_pairs(node_count, blocks.flatten().copied().zip(0..))
    }
    /// From pairs of node and slot in the order of summation.
    pub(crate) fn of_pairs(
        node_count: usize,
        pairs: impl Iterator<Item = (u32, u32)> + Clone,
    ) -> Self {
        let mut offsets = vec![0u32; node_count + 1];
        for (node, _) in pairs.clone() {
            offsets[node as usize + 1] += 1;
        }
        for i in 1..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let mut next = offsets.clone();
        let mut slots = vec![0u32; offsets[node_count] as usize];
        for (node, slot) in pairs {
            let end = &mut next[node as usize];
            slots[*end as usize] = slot;
            *end += 1;
        }
        Self { offsets, slots }
    }
    pub(crate) fn node_count(&self) -> usize {
        self.offsets.len() - 1
    }
    /// Slots of a node.
    #[inline]
    pub(crate) fn of(&self, node: usize) -> &[u32] {
        &self.slots[self.offsets[node] as usize..self.offsets[node + 1] as usize]
    }
    /// Number of slots.
    pub(crate) fn len(&self) -> usize {
        self.slots.len()
    }
    /// The sum at one node, in the same order as [`Gather::for_chunk`].
    #[inline]
    pub(crate) fn sum<S: Storage>(&self, node: usize, forces: &[Quad<S>]) -> Quad<S> {
        let slots = self.of(node);
        let mut sum = forces[slots[0] as usize];
        for &slot in &slots[1..] {
            let add = &forces[slot as usize].values;
            for c in 0..4 {
                sum.values[c] = sum.values[c] + add[c];
            }
        }
        sum
    }
}
