//! Roller-supported nodes along coordinate axes: plain nodes with some velocity components fixed at zero. This is
//! hot code.
//!
//! # Why so
//! Rollers on the faces of a box, and on both sides of a slice, are most of all supports. As
//! groups each would cost as much as several plain nodes; as plain nodes whose forces along the fixed axes
//! are left out they cost next to nothing, with bitwise equal results.

use core::ops::Range;

use powerhouse_model::Quad;

use crate::gather::CHUNK;
use crate::nodes::Storage;

/// A node and the coordinate axes along which it is fixed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RollerNode {
    pub(crate) node: u32,
    pub(crate) held: [bool; 3],
}

/// All roller nodes of a model, in rising order of nodes.
#[derive(Default)]
pub(crate) struct RollerNodes {
    all: Vec<RollerNode>,
    /// Range of the roller nodes in each chunk of nodes.
    chunks: Vec<Range<u32>>,
}

impl RollerNodes {
    /// From roller nodes in rising order of nodes.
    pub(crate) fn new(all: Vec<RollerNode>, node_count: usize) -> Self {
        let bound = |node: usize| all.partition_point(|s| (s.node as usize) < node) as u32;
        let chunks = (0..node_count.div_ceil(CHUNK))
            .map(|chunk| bound(chunk * CHUNK)..bound((chunk + 1) * CHUNK))
            .collect();
        Self { all, chunks }
    }

    /// The roller nodes in a chunk of nodes.
    #[inline]
    pub(crate) fn in_chunk(&self, chunk: usize) -> &[RollerNode] {
        let range = &self.chunks[chunk];
        &self.all[range.start as usize..range.end as usize]
    }

    /// All roller nodes.
    pub(crate) fn all(&self) -> &[RollerNode] {
        &self.all
    }

    /// The roller nodes from a node on.
    pub(crate) fn from(&self, node: usize) -> &[RollerNode] {
        &self.all[self.all.partition_point(|s| (s.node as usize) < node)..]
    }

    /// The roller node of a node, as a slice of one; empty if the node has no roller.
    pub(crate) fn of(&self, node: usize) -> &[RollerNode] {
        let index = self.all.binary_search_by_key(&(node as u32), |s| s.node);
        index.map_or(&[], |index| &self.all[index..=index])
    }

    /// Sets the velocities (m/s) along fixed axes to zero.
    pub(crate) fn stop<S: Storage>(&self, velocity: &mut [Quad<S>]) {
        for roller_node in &self.all {
            let velocity = &mut velocity[roller_node.node as usize].values;
            for (value, _) in velocity
                .iter_mut()
                .zip(roller_node.held)
                .filter(|(_, held)| *held)
            {
                *value = S::default();
            }
        }
    }
}

/// Makes the net force along fixed axes zero: there the internal forces of consecutive nodes from
/// `first` on are replaced by the applied ones. Returns the roller nodes after these nodes.
#[inline(always)]
pub(crate) fn hold<'a, S: Storage>(
    roller_nodes: &'a [RollerNode],
    first: usize,
    internal: &mut [Quad<S>],
    external: &[[S; 4]],
) -> &'a [RollerNode] {
    let mut rest = roller_nodes;
    while let [roller_node, others @ ..] = rest {
        let node = roller_node.node as usize;
        let Some(internal) = internal.get_mut(node - first) else {
            break;
        };
        let applied = external.get(node).copied().unwrap_or_default();
        for c in 0..3 {
            if roller_node.held[c] {
                internal.values[c] = applied[c];
            }
        }
        rest = others;
    }
    rest
}
