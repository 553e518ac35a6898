//! The subdomain that a model computes: its blocks, its nodes with local numbers, and the tables that connect them.

use core::ops::Range;
use std::cell::Cell;

use powerhouse_model::{ElementBlock, Mesh, Quad};

use crate::gather::{Gather, SlotTable};
use crate::node_ranges::NodeRanges;
use crate::nodes::Storage;
use crate::partition::Partition;
use crate::ranks::ABSENT;

/// Local node numbers: maps between mesh indices and the numbers of the nodes in the nodal arrays.
///
/// Mesh indices of additional nodes of boundaries follow those of the mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Numbering {
    /// Local number of each mesh node; [`ABSENT`] for a node of other ranks.
    pub(crate) local_of: Vec<u32>,
    /// Mesh index of each local node.
    pub(crate) mesh_of: Vec<u32>,
}

impl Numbering {
    /// Numbers the nodes block by block, so that each block owns a range of them; nodes without active
    /// elements come last.
    pub(crate) fn of(partition: &Partition, mesh: &Mesh) -> Self {
        let owned = partition
            .blocks
            .iter()
            .flat_map(|block| block.owned_nodes());
        let last = partition.orphans.iter().chain(&partition.unused);
        let mesh_of: Vec<u32> = owned.chain(last).copied().collect();
        let mut local_of = vec![0; mesh.node_count()];
        for (local, &node) in mesh_of.iter().enumerate() {
            local_of[node as usize] = local as u32;
        }
        Self { local_of, mesh_of }
    }

    /// The numbers on a rank with some nodes, from those of a model on one rank: the former number of each node, and the
    /// new one of each former number.
    pub(crate) fn on_rank(&self, present: &[u32], local_of: &[u32]) -> Self {
        let of = |table: &[u32], node: u32| table[node as usize];
        Self {
            local_of: self.local_of.iter().map(|&n| of(local_of, n)).collect(),
            mesh_of: present.iter().map(|&n| of(&self.mesh_of, n)).collect(),
        }
    }

    /// Local number of a node (mesh index), unless it is on another rank or does not exist.
    pub(crate) fn local(&self, node: usize) -> Option<usize> {
        let local = self.local_of.get(node).copied();
        local.filter(|&n| n != ABSENT).map(|n| n as usize)
    }

    /// Appends an additional node; returns its mesh index.
    pub(crate) fn append(&mut self) -> u32 {
        let (index, local) = (self.local_of.len() as u32, self.mesh_of.len() as u32);
        self.local_of.push(local);
        self.mesh_of.push(index);
        index
    }
}

/// Nodes of a subdomain and their relation to its blocks.
///
/// Blocks know their own nodes alone; this is the one place that knows where these are in the nodal arrays, and to which
/// entry (slot) of the force buffers a block writes the force of a node.
pub(crate) struct Subdomain {
    /// The numbers of the nodes.
    pub(crate) numbering: Numbering,
    /// Local numbers of the nodes of all blocks, block by block: the node of each slot.
    nodes: Vec<u32>,
    /// Slots of each block.
    ranges: Vec<Range<usize>>,
    /// Length of the run of successive local numbers at the start of each block's nodes.
    runs: Vec<usize>,
    /// Number of slots of each block, the length of its force buffer.
    pub(crate) lengths: Vec<usize>,
    /// Slots of each node in the order of summation.
    pub(crate) slots: SlotTable,
    /// The same for passes over all nodes.
    pub(crate) gather: Gather,
    /// Nodes in ranges, over which nodal vectors are summed.
    pub(crate) node_ranges: NodeRanges,
    /// Local numbers of orphan nodes, in rising order.
    pub(crate) orphans: Vec<u32>,
    /// Place of each mesh element among `places`, plus one; zero for elements of no block. Memory of zeros is not taken, which
    /// matters to a rank that has few elements of a large mesh.
    place_of_element: Vec<u32>,
    /// Block and index in the block of each element that has one.
    places: Vec<(u32, u32)>,
}

impl Subdomain {
    /// The subdomain of blocks, of which each has its nodes (local numbers) in a list; with the slots and ranges of its
    /// nodes if there are other ranks.
    pub(crate) fn new(
        mesh: &Mesh,
        numbering: Numbering,
        orphans: Vec<u32>,
        blocks: &[Box<dyn ElementBlock>],
        nodes: Vec<Vec<u32>>,
        tables: Option<(SlotTable, NodeRanges)>,
    ) -> Self {
        let lengths: Vec<usize> = nodes.iter().map(Vec::len).collect();
        let (slots, node_ranges) = tables.unwrap_or_else(|| {
            let of_blocks = nodes.iter().map(|nodes| &**nodes);
            let slots = SlotTable::new(numbering.mesh_of.len(), of_blocks);
            let ranges = NodeRanges::of_blocks(&slots, &lengths);
            (slots, ranges)
        });
        let mut end = 0;
        let ranges = lengths.iter().map(|&length| {
            end += length;
            end - length..end
        });
        let (place_of_element, places) = places_of_elements(mesh, blocks);
        Self {
            ranges: ranges.collect(),
            runs: nodes.iter().map(|nodes| run(nodes)).collect(),
            node_ranges,
            lengths,
            gather: Gather::new(&slots),
            slots,
            nodes: nodes.concat(),
            orphans,
            place_of_element,
            places,
            numbering,
        }
    }

    /// Block of a mesh element, and its index in the block; none for one of no block of this rank.
    pub(crate) fn block_of(&self, element: u32) -> Option<(usize, usize)> {
        let place = *self.place_of_element.get(element as usize)?;
        let (block, index) = self.places[place.checked_sub(1)? as usize];
        Some((block as usize, index as usize))
    }

    /// Number of nodes.
    pub(crate) fn node_count(&self) -> usize {
        self.numbering.mesh_of.len()
    }

    /// Local numbers of the nodes of a block, in the block's order.
    pub(crate) fn nodes_of(&self, block: usize) -> &[u32] {
        &self.nodes[self.ranges[block].clone()]
    }

    /// Slots of a block.
    pub(crate) fn slots_of(&self, block: usize) -> Range<usize> {
        self.ranges[block].clone()
    }

    /// Local number of the node of each slot of this rank's blocks.
    pub(crate) fn slot_nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Local number of the node of a slot of this rank's blocks.
    pub(crate) fn node_of_slot(&self, slot: u32) -> u32 {
        self.nodes[slot as usize]
    }

    /// The forces that a block wrote, in the block's order, of all forces.
    pub(crate) fn forces_of<'f, A>(&self, block: usize, forces: &'f [A]) -> &'f [A] {
        &forces[self.ranges[block].clone()]
    }

    /// Copies the values of the nodes of a block from a nodal array, in the block's order.
    pub(crate) fn copy<A: Copy>(&self, block: usize, from: &[A], to: &mut Vec<A>) {
        let nodes = self.nodes_of(block);
        to.clear();
        let Some(&first) = nodes.first() else {
            return;
        };
        let (first, run) = (first as usize, self.runs[block]);
        to.extend_from_slice(&from[first..first + run]);
        to.extend(nodes[run..].iter().map(|&node| from[node as usize]));
    }

    /// The values of the nodes of a block, in the block's order.
    pub(crate) fn values<A: Copy>(&self, block: usize, from: &[A]) -> Vec<A> {
        let mut values = Vec::new();
        self.copy(block, from, &mut values);
        values
    }
}

/// Length of the run of successive numbers at the start of a list.
fn run(nodes: &[u32]) -> usize {
    let first = nodes.first().copied().unwrap_or(0);
    let successive = (first..).zip(nodes).take_while(|&(n, &node)| n == node);
    successive.count()
}

/// Place of each mesh element among the elements of all blocks, plus one, and block and index in the block of each of these.
fn places_of_elements(
    mesh: &Mesh,
    blocks: &[Box<dyn ElementBlock>],
) -> (Vec<u32>, Vec<(u32, u32)>) {
    let mut place_of_element = vec![0; mesh.element_count()];
    let mut places = Vec::with_capacity(blocks.iter().map(|block| block.elements().len()).sum());
    for (number, block) in (0..).zip(blocks) {
        for (index, &element) in (0..).zip(block.elements()) {
            places.push((number, index));
            if let Some(place) = place_of_element.get_mut(element as usize) {
                *place = places.len() as u32;
            }
        }
    }
    (place_of_element, places)
}

/// Copies of nodal values for one block: one set of buffers per thread, which stays in its cache from block to block.
#[derive(Default)]
pub(crate) struct BlockCopies {
    pub(crate) displacement: Vec<Quad<f64>>,
    pub(crate) double: Vec<Quad<f64>>,
    pub(crate) single: Vec<Quad<f32>>,
}

thread_local! {
    static COPIES: Cell<BlockCopies> = Cell::default();
}

/// Nodal motion from which blocks compute.
#[derive(Clone, Copy)]
pub(crate) struct NodalMotion<'a, S: Storage> {
    /// Displacement (m) of each local node.
    pub(crate) displacement: &'a [Quad<f64>],
    /// Velocity (m/s) of each local node.
    pub(crate) velocity: &'a [Quad<S>],
}

impl Subdomain {
    /// Calls a function with copies of the displacement, and of the velocity if the block reads it, of a block's nodes.
    pub(crate) fn with_copies<S: Storage, R>(
        &self,
        block: usize,
        motion: NodalMotion<S>,
        reads_velocity: bool,
        work: impl FnOnce(&[Quad<f64>], &[Quad<S>]) -> R,
    ) -> R {
        let mut copies = COPIES.take();
        let (displacement, velocity) = S::copies(&mut copies);
        self.copy(block, motion.displacement, displacement);
        velocity.clear();
        if reads_velocity {
            self.copy(block, motion.velocity, velocity);
        }
        let result = work(displacement, velocity);
        COPIES.set(copies);
        result
    }
}
