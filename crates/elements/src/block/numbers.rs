//! Aligned storage of numbers for SIMD registers.

use powerhouse_model::Scalar;

/// Bytes of a cache line, and of the widest register.
const LINE: usize = 64;

/// Value on the stack that is aligned to a cache line, so that no register load straddles two. The compiler
/// then aligns the whole stack frame, and with it the registers that it spills.
#[repr(align(64))]
pub(super) struct Aligned<T>(pub(super) T);

/// Numbers aligned to a cache line, so that no register load straddles two.
#[derive(Debug, Default)]
pub(super) struct AlignedNumbers<S> {
    numbers: Vec<S>,
    start: usize,
    length: usize,
}

impl<S: Scalar> AlignedNumbers<S> {
    /// A number of zeros.
    pub(super) fn zeros(length: usize) -> Self {
        let spare = LINE / size_of::<S>();
        let numbers = vec![S::default(); length + spare];
        let start = numbers.as_ptr().align_offset(LINE).min(spare);
        Self {
            numbers,
            start,
            length,
        }
    }
    /// Grows to a length; the numbers are zeros afterwards if they were fewer.
    #[inline(always)]
    pub(super) fn grow(&mut self, length: usize) {
        if self.length < length {
            *self = Self::zeros(length);
        }
    }
    /// All numbers.
    #[inline(always)]
    pub(super) fn as_slice(&self) -> &[S] {
        &self.numbers[self.start..self.start + self.length]
    }
    /// All numbers, mutable.
    #[inline(always)]
    pub(super) fn as_mut_slice(&mut self) -> &mut [S] {
        &mut self.numbers[self.start..self.start + self.length]
    }
}
