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

use crate::exact::ExactSum;
use crate::gather::SlotTable;

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
        let mut owned: Vec<(usize, Range<usize>)> = Vec::new();
        for node in 0..slots.node_count() {
            let block = owner(node);
            match owned.last_mut() {
                Some((last, range)) if *last == block => range.end = node + 1,
                _ => owned.push((block, node..node + 1)),
            }
        }
        Self::new(owned.into_iter().map(|(_, range)| range))
    }

    /// The ranges.
    pub(crate) fn ranges(&self) -> &[Range<usize>] {
        &self.0
    }

    /// The sum over all ranges of the sum of a range.
    pub(crate) fn sum(&self, of_range: impl Fn(Range<usize>) -> f64 + Sync) -> f64 {
        let sums: Vec<f64> = (self.0.par_iter())
            .map(|range| of_range(range.clone()))
            .collect();
        sums.into_iter().collect::<ExactSum>().round()
    }

    /// The inner product of two nodal vectors.
    pub(crate) fn dot(&self, a: &[Vec3], b: &[Vec3]) -> f64 {
        self.sum(|range| {
            let pairs = a[range.clone()].iter().zip(&b[range]);
            pairs.map(|(a, b)| a.dot(b)).sum()
        })
    }

    /// The Euclidean norm of a nodal vector.
    pub(crate) fn norm(&self, a: &[Vec3]) -> f64 {
        self.dot(a, a).sqrt()
    }
}

#[cfg(test)]
mod tests;
