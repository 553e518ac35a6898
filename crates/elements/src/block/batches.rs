//! The elements of a block, batch by batch.

use super::memory::{Cache, Connectivity, prefetch};
use crate::lanes::{Arrangement, BatchScalar};

/// Number of batches ahead of their use at which geometry is prefetched.
const AHEAD: usize = 2;

/// Elements of a block as a sequence of batches.
#[derive(Clone, Copy)]
pub(super) struct Batches<'a, S, const N: usize> {
    /// Number of elements; the last batch is filled with copies of the last element.
    pub(super) elements: usize,
    /// Local node indices of the elements, whole batches.
    pub(super) connectivity: &'a Connectivity<N>,
    /// Which elements are active; all if `None`.
    pub(super) active: Option<&'a [bool]>,
    /// Geometry numbers of whole batches, or of one batch if all elements are alike.
    pub(super) geometry: &'a [S],
    /// Lanes of the elements of a batch.
    pub(super) arrangement: Arrangement,
}

/// One batch of elements.
#[derive(Clone, Copy)]
pub(super) struct Batch<'a, S, const N: usize> {
    /// Index of its first element in the block.
    pub(super) first: usize,
    /// Number of its elements.
    pub(super) count: usize,
    /// Which elements are active.
    pub(super) active: Option<&'a [bool]>,
    /// Geometry numbers.
    pub(super) geometry: &'a [S],
    /// Geometry numbers of a later batch, to be prefetched.
    ahead: &'a [S],
    /// Lanes of the elements of a batch.
    pub(super) arrangement: Arrangement,
}

impl<'a, S: BatchScalar, const N: usize> Batches<'a, S, N> {
    /// Number of batches of a width.
    #[inline(always)]
    pub(super) fn count(&self, width: usize) -> usize {
        self.elements.div_ceil(width)
    }
    /// One batch of a width, with a number of geometry numbers per element.
    #[inline(always)]
    pub(super) fn batch(&self, index: usize, width: usize, numbers: usize) -> Batch<'a, S, N> {
        let first = index * width;
        let count = width.min(self.elements - first);
        let numbers = numbers * width;
        prefetch(
            Cache::Nearest,
            self.connectivity.as_slice(),
            first + AHEAD * width,
            width,
        );
        let geometry = if self.geometry.len() == numbers {
            self.geometry
        } else {
            &self.geometry[index * numbers..][..numbers]
        };
        Batch {
            first,
            count,
            active: self.active.map(|active| &active[first..][..count]),
            geometry,
            ahead: self
                .geometry
                .get((index + AHEAD) * numbers..)
                .unwrap_or(&[]),
            arrangement: self.arrangement,
        }
    }
}

impl<S, const N: usize> Batch<'_, S, N> {
    /// Prefetches a share of the geometry of a later batch: all of it at once would delay the reads of the
    /// present one.
    #[inline(always)]
    pub(super) fn prefetch(&self, share: usize, of: usize) {
        if !self.ahead.is_empty() {
            let count = self.geometry.len() / of;
            prefetch(Cache::Nearest, self.ahead, share * count, count);
        }
    }
    /// Whether all elements of a batch of a width exist and are active.
    #[inline(always)]
    pub(super) fn is_whole(&self, width: usize) -> bool {
        self.count == width && self.active.is_none()
    }
    /// Whether element `j` of the batch exists and is active.
    #[inline(always)]
    pub(super) fn has(&self, j: usize) -> bool {
        j < self.count && self.active.is_none_or(|active| active[j])
    }
}
