//! The elements of a block, batch by batch.

use super::memory::{Cache, Places, prefetch};
use crate::lanes::{Arrangement, BatchScalar};

/// How many batches ahead of their use numbers are asked for.
const AHEAD: usize = 2;

/// The elements of a block.
#[derive(Clone, Copy)]
pub(super) struct Batches<'a, S, const N: usize> {
    /// How many elements; the rest of the last batch repeats the last element.
    pub(super) elements: usize,
    /// Places of their nodes in the block, whole batches.
    pub(super) places: &'a Places<N>,
    /// Which elements take part; all if `None`.
    pub(super) active: Option<&'a [bool]>,
    /// Geometry numbers of whole batches, or of one if all elements are alike.
    pub(super) geometry: &'a [S],
    /// Where elements sit.
    pub(super) arrangement: Arrangement,
}

/// One batch.
#[derive(Clone, Copy)]
pub(super) struct Batch<'a, S, const N: usize> {
    /// Number of its first element in the block.
    pub(super) first: usize,
    /// How many elements it holds.
    pub(super) count: usize,
    /// Places of the nodes.
    pub(super) places: &'a [[u32; N]],
    /// Which elements take part.
    pub(super) active: Option<&'a [bool]>,
    /// Geometry numbers.
    pub(super) geometry: &'a [S],
    /// Geometry numbers from some batches further on.
    ahead: &'a [S],
    /// Where elements sit.
    pub(super) arrangement: Arrangement,
}

impl<'a, S: BatchScalar, const N: usize> Batches<'a, S, N> {
    /// How many batches of a width.
    #[inline(always)]
    pub(super) fn count(&self, width: usize) -> usize {
        self.elements.div_ceil(width)
    }
    /// One batch of a width, with so many geometry numbers per element.
    #[inline(always)]
    pub(super) fn batch(&self, index: usize, width: usize, numbers: usize) -> Batch<'a, S, N> {
        let first = index * width;
        let count = width.min(self.elements - first);
        let numbers = numbers * width;
        prefetch(
            Cache::Nearest,
            self.places.as_slice(),
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
            places: &self.places.as_slice()[first..][..width],
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
    /// Asks for a share of the geometry of a later batch: all at once would leave no room for the
    /// reads of the present one.
    #[inline(always)]
    pub(super) fn ask_ahead(&self, share: usize, of: usize) {
        if !self.ahead.is_empty() {
            let count = self.geometry.len() / of;
            prefetch(Cache::Nearest, self.ahead, share * count, count);
        }
    }
    /// Whether all elements of a batch of a width exist and take part.
    #[inline(always)]
    pub(super) fn is_whole(&self, width: usize) -> bool {
        self.count == width && self.active.is_none()
    }
    /// Whether element `j` of the batch exists and takes part.
    #[inline(always)]
    pub(super) fn has(&self, j: usize) -> bool {
        j < self.count && self.active.is_none_or(|active| active[j])
    }
}
