//! Storage of numbers for whole registers.

use powerhouse_model::Scalar;

/// Bytes of a cache line, and of the widest register.
const LINE: usize = 64;

/// Numbers that begin at a cache line, so that no register load straddles two.
#[derive(Debug, Default)]
pub(super) struct AlignedNumbers<S> {
    numbers: Vec<S>,
    start: usize,
    length: usize,
}

impl<S: Scalar> AlignedNumbers<S> {
    /// So many zeros.
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
    /// All of them.
    #[inline(always)]
    pub(super) fn as_slice(&self) -> &[S] {
        &self.numbers[self.start..self.start + self.length]
    }
    /// All of them, to be changed.
    #[inline(always)]
    pub(super) fn as_mut_slice(&mut self) -> &mut [S] {
        &mut self.numbers[self.start..self.start + self.length]
    }
}
