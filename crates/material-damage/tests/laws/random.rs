//! Pseudo-random numbers, the same in every run.

use powerhouse_model::{Mat3, Stress, Vec3};

/// A generator after Vigna (2015): splitmix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// A number in `[-1, 1)`.
    pub(crate) fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
    /// A number in `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        0.5 * (self.signed() + 1.0)
    }
    /// Six numbers in `[-1, 1)`.
    pub(crate) fn six(&mut self) -> [f64; 6] {
        core::array::from_fn(|_| self.signed())
    }
    /// A rotation about an axis of any direction.
    pub(crate) fn rotation(&mut self) -> Mat3 {
        let axis = Vec3::new(self.signed(), self.signed(), self.signed() + 1.5);
        let axis = nalgebra::Unit::new_normalize(axis);
        *nalgebra::Rotation3::from_axis_angle(&axis, 3.0 * self.signed()).matrix()
    }
    /// A stress with the given principal values and axes of any direction.
    pub(crate) fn with_principal(&mut self, values: [f64; 3]) -> Stress {
        let turn = self.rotation();
        let diagonal = Mat3::from_diagonal(&Vec3::from(values));
        Stress::from_matrix(&(turn * diagonal * turn.transpose()))
    }
}
