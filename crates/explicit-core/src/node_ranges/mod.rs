//! Sums over the nodes of the body: the same bits for any number of threads and any order of the blocks.
//!
//! # Why so
//! The bits of a floating-point sum depend on the order of its terms. Within a range of nodes that one block owns, terms
//! are added in the order of the nodes; the sums of the ranges are added exactly and rounded once, so that their order,
//! and who computes them, has no influence. An exact term costs as much as several plain ones, but there is one per
//! range only.

use core::ops::Range;

use powerhouse_model::Vec3;
use rayon::prelude::*;

use crate::gather::SlotTable;
use crate::ranks::Communicator;

/// Largest number of nodes of a range: a parallel task.
const MOST: usize = 4096;

/// Ranges of consecutive engine nodes, each owned by one block; together they are all nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeRanges(Vec<Range<usize>>);

impl NodeRanges {
    /// From the nodes that each block owns, which are divided into ranges of at most 4096, counted from their first one.
    pub(crate) fn new(owned: impl IntoIterator<Item = Range<usize>>) -> Self {
        let divided = owned.into_iter().flat_map(|own| {
            let end = own.end;
            (own.step_by(MOST)).map(move |start| start..(start + MOST).min(end))
        });
        Self(divided.collect())
    }

    /// From the slots of the nodes and the number of slots of each block: a node is owned by the block of its first slot.
    pub(crate) fn of_blocks(slots: &SlotTable, lengths: &[usize]) -> Self {
        let mut ends = Vec::with_capacity(lengths.len());
        for length in lengths {
            ends.push(ends.last().copied().unwrap_or(0) + length);
        }
        let owner = |node: usize| {
            let first = slots.of(node)[0] as usize;
            ends.partition_point(|&end| end <= first)
        };
        let owned = runs((0..slots.node_count()).map(owner));
        Self::new(owned.into_iter().map(|(_, range)| range))
    }

    /// The ranges, of those of a model on one rank, whose blocks are on a rank, in its numbers of the nodes: from the nodes
    /// of all blocks, the rank of each block, and the number of each node on this rank.
    pub(crate) fn of_rank(nodes: &[Vec<u32>], ranks: &[u32], rank: u32, local_of: &[u32]) -> Self {
        let mut owners = vec![usize::MAX; local_of.len()];
        for (block, nodes) in nodes.iter().enumerate() {
            for &node in nodes {
                let owner = &mut owners[node as usize];
                *owner = (*owner).min(block);
            }
        }
        let own = |owner: &usize| ranks.get(*owner) == Some(&rank);
        let owned = runs(owners.into_iter()).into_iter();
        // The nodes of a range are all here, and those here keep their order.
        Self::new(owned.filter(|(owner, _)| own(owner)).map(|(_, range)| {
            let start = local_of[range.start] as usize;
            start..start + range.len()
        }))
    }

    /// Whether a node is in one of them, which are in rising order.
    pub(crate) fn has(&self, node: usize) -> bool {
        let after = self.0.partition_point(|range| range.start <= node);
        after > 0 && node < self.0[after - 1].end
    }

    /// The ranges.
    pub(crate) fn ranges(&self) -> &[Range<usize>] {
        &self.0
    }
}

/// Sums over the nodes of the body, those of other ranks included.
#[derive(Clone, Copy)]
pub(crate) struct NodeSums<'a> {
    pub(crate) ranges: &'a NodeRanges,
    pub(crate) team: &'a Communicator,
}

impl NodeSums<'_> {
    /// The sum over all ranges of the sum of a range.
    pub(crate) fn sum(self, of_range: impl Fn(Range<usize>) -> f64 + Sync) -> f64 {
        let sums: Vec<f64> = (self.ranges.0.par_iter())
            .map(|range| of_range(range.clone()))
            .collect();
        self.team.total(sums.into_iter())
    }

    /// The inner product of two nodal vectors.
    pub(crate) fn dot(self, a: &[Vec3], b: &[Vec3]) -> f64 {
        self.sum(|range| {
            let pairs = a[range.clone()].iter().zip(&b[range]);
            pairs.map(|(a, b)| a.dot(b)).sum()
        })
    }

    /// The Euclidean norm of a nodal vector.
    pub(crate) fn norm(self, a: &[Vec3]) -> f64 {
        self.dot(a, a).sqrt()
    }
}

/// Runs of equal values: the value and the range of each.
fn runs(values: impl Iterator<Item = usize>) -> Vec<(usize, Range<usize>)> {
    let mut runs: Vec<(usize, Range<usize>)> = Vec::new();
    for (index, value) in values.enumerate() {
        match runs.last_mut() {
            Some((last, range)) if *last == value => range.end = index + 1,
            _ => runs.push((value, index..index + 1)),
        }
    }
    runs
}

#[cfg(test)]
mod tests;
