//! Reads of nodal values without a bounds check each, views of numbers as lanes, and prefetching: the only
//! unsafe code of the crate.
//!
//! Measured gain, on distorted one-point bricks and one thread of a Zen 4 core: the check at
//! every read takes a step from 24 to 28 ns per element in mixed precision with a benign fallback,
//! and to 47 ns with a panic, because a possible panic between two reads forbids the compiler to
//! combine them. Prefetching takes 132,651 elements in f64 from 43 to 37 ns: a batch reads its geometry
//! in one burst and then computes for a while, so that the processor's own prefetching starts anew
//! at every burst. Histories are prefetched further ahead and into the second-level cache: the first
//! level has few outstanding lines, and a batch with 18 variables needs more (a step of 110,592 elements
//! with flat damping from 65 to 55 ns).
#![expect(unsafe_code)]

#[cfg(test)]
mod tests;

use powerhouse_model::{NodalScalar, Quad};

use crate::lanes::BatchLane;

/// Bytes of a cache line.
const LINE: usize = 64;

/// Connectivity of elements in local node indices of the block, all below a bound.
#[derive(Debug)]
pub(super) struct Connectivity<const N: usize> {
    /// Invariant: every number is below `bound`.
    of_elements: Vec<[u32; N]>,
    bound: usize,
}

impl<const N: usize> Connectivity<N> {
    /// A connectivity from the local node indices of each element.
    pub(super) fn new(of_elements: Vec<[u32; N]>) -> Self {
        let indices = of_elements.as_flattened().iter();
        let bound = indices.max().map_or(0, |&largest| largest as usize + 1);
        Self { of_elements, bound }
    }
    /// Local node indices of all elements.
    pub(super) fn as_slice(&self) -> &[[u32; N]] {
        &self.of_elements
    }
    /// A view of nodal values by element.
    ///
    /// # Panics
    /// If an index exceeds the number of nodes.
    #[inline(always)]
    pub(super) fn over<'a, A: NodalScalar>(&'a self, nodes: &'a [Quad<A>]) -> NodesOf<'a, A, N> {
        assert!(
            self.bound <= nodes.len(),
            "an index exceeds the number of nodes"
        );
        NodesOf {
            connectivity: &self.of_elements,
            nodes,
        }
    }
    /// A view of nodal sums by element.
    ///
    /// # Panics
    /// If an index exceeds the number of nodes.
    #[inline(always)]
    pub(super) fn over_sums<'a, A: NodalScalar>(
        &'a self,
        nodes: &'a mut [Quad<A>],
    ) -> SumsOf<'a, A, N> {
        assert!(
            self.bound <= nodes.len(),
            "an index exceeds the number of nodes"
        );
        SumsOf {
            connectivity: &self.of_elements,
            nodes,
        }
    }
}

/// View of nodal sums by element.
pub(super) struct SumsOf<'a, A: NodalScalar, const N: usize> {
    /// Invariant: every number is an index of `nodes`.
    connectivity: &'a [[u32; N]],
    nodes: &'a mut [Quad<A>],
}

impl<A: NodalScalar, const N: usize> SumsOf<'_, A, N> {
    /// The view of a range of the elements.
    ///
    /// # Panics
    /// If the range exceeds the elements.
    #[inline(always)]
    pub(super) fn elements(&mut self, first: usize, count: usize) -> SumsOf<'_, A, N> {
        SumsOf {
            connectivity: &self.connectivity[first..][..count],
            nodes: self.nodes,
        }
    }
    /// The sum at node `a` of element `j`.
    ///
    /// # Panics
    /// If there is no such element or node.
    #[inline(always)]
    pub(super) fn sum(&mut self, j: usize, a: usize) -> &mut [A; 4] {
        let index = self.connectivity[j][a] as usize;
        // SAFETY: as for `NodesOf::value`; `Connectivity::over_sums` is the only other maker.
        &mut unsafe { self.nodes.get_unchecked_mut(index) }.values
    }
}

/// View of nodal values by element.
#[derive(Clone, Copy)]
pub(super) struct NodesOf<'a, A: NodalScalar, const N: usize> {
    /// Invariant: every number is an index of `nodes`.
    connectivity: &'a [[u32; N]],
    nodes: &'a [Quad<A>],
}

impl<'a, A: NodalScalar, const N: usize> NodesOf<'a, A, N> {
    /// The view of a range of the elements.
    ///
    /// # Panics
    /// If the range exceeds the elements.
    #[inline(always)]
    pub(super) fn elements(self, first: usize, count: usize) -> Self {
        Self {
            connectivity: &self.connectivity[first..][..count],
            nodes: self.nodes,
        }
    }
    /// The value at node `a` of element `j`.
    ///
    /// # Panics
    /// If there is no such element or node.
    #[inline(always)]
    pub(super) fn value(self, j: usize, a: usize) -> [A; 4] {
        let index = self.connectivity[j][a] as usize;
        // SAFETY: `Connectivity::over` is the only maker of this type and found all indices of
        // `Connectivity::of_elements` below `Connectivity::bound`, and that not above the number of nodes;
        // `elements` only takes fewer of them. Both slices are borrowed for the life of `self`.
        unsafe { self.nodes.get_unchecked(index) }.values
    }
}

/// View of numbers as the lanes that they fill, so that a law reads and writes history variables where they
/// are stored: a step with flat damping, or in which everything yields, takes some 3 % less than with
/// copies.
///
/// # Panics
/// If they do not fill whole lanes.
#[inline(always)]
pub(super) fn as_lanes<L: BatchLane>(_token: L::Token, numbers: &[L::Scalar]) -> &[L] {
    const { assert!(size_of::<L>() == L::WIDTH * size_of::<L::Scalar>()) };
    // SAFETY: a lane is `WIDTH` numbers and nothing else, since what proves that the processor has its
    // instructions has no size; such a proof exists, since the caller has it. Any bits are
    // numbers. `align_to` returns only lanes that are aligned.
    let (before, lanes, after) = unsafe { numbers.align_to() };
    assert!(before.is_empty() && after.is_empty(), "{SPLIT}");
    lanes
}

/// Mutable view of numbers as the lanes that they fill.
///
/// # Panics
/// As [`as_lanes`].
#[inline(always)]
pub(super) fn as_lanes_mut<L: BatchLane>(_token: L::Token, numbers: &mut [L::Scalar]) -> &mut [L] {
    const { assert!(size_of::<L>() == L::WIDTH * size_of::<L::Scalar>()) };
    // SAFETY: as for `as_lanes`; and whatever lane is written leaves numbers.
    let (before, lanes, after) = unsafe { numbers.align_to_mut() };
    assert!(before.is_empty() && after.is_empty(), "{SPLIT}");
    lanes
}

/// Panic message of [`as_lanes`].
const SPLIT: &str = "numbers fill whole lanes";

/// Cache level of a prefetch.
#[derive(Clone, Copy)]
pub(super) enum Cache {
    Nearest,
    Second,
}

/// Prefetches `slice[start..start + count]`, as far as it exists.
#[inline(always)]
pub(super) fn prefetch<T>(cache: Cache, slice: &[T], start: usize, count: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::{_MM_HINT_T0, _MM_HINT_T1, _mm_prefetch};
        let first = slice.as_ptr().wrapping_add(start).cast::<i8>();
        let mut offset = 0;
        while offset < count * size_of::<T>() {
            let line = first.wrapping_add(offset);
            // SAFETY: every x86-64 processor has the instruction; it neither faults nor changes
            // anything that a program can see, whatever the address.
            unsafe {
                match cache {
                    Cache::Nearest => _mm_prefetch::<_MM_HINT_T0>(line),
                    Cache::Second => _mm_prefetch::<_MM_HINT_T1>(line),
                }
            }
            offset += LINE;
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (cache, slice, start, count, LINE);
}
