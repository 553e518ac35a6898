//! Values at nodes, as the engine stores them.

use crate::{Scalar, Vec3};

/// What nodal values are stored as: `f64` (precisions `f64` and `mixed`) or `f32`.
pub trait NodalScalar: Scalar {
    #[doc(hidden)]
    type Alignment: Copy + Send + Sync + Default + core::fmt::Debug + 'static;
}

#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub struct Align32;
#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(16))]
pub struct Align16;

impl NodalScalar for f64 {
    type Alignment = Align32;
}
impl NodalScalar for f32 {
    type Alignment = Align16;
}

/// Four numbers of one node, aligned so that they never straddle a cache line: x, y, z and one
/// spare that is zero.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Quad<S: NodalScalar> {
    /// x, y, z, spare.
    pub values: [S; 4],
    alignment: [S::Alignment; 0],
}

impl<S: NodalScalar> Quad<S> {
    /// Three components; the spare is zero.
    #[inline(always)]
    pub fn new(x: S, y: S, z: S) -> Self {
        Self {
            values: [x, y, z, S::default()],
            alignment: [],
        }
    }
    /// Rounds a vector to this storage.
    #[inline(always)]
    pub fn from_vector(vector: &Vec3) -> Self {
        Self::new(
            S::from_f64(vector.x),
            S::from_f64(vector.y),
            S::from_f64(vector.z),
        )
    }
    /// The first three components in double precision.
    #[inline(always)]
    pub fn to_vector(self) -> Vec3 {
        Vec3::new(
            self.values[0].to_f64(),
            self.values[1].to_f64(),
            self.values[2].to_f64(),
        )
    }
}

/// Read access to one nodal field in engine numbering, in either storage.
#[derive(Clone, Copy, Debug)]
pub enum NodalView<'a> {
    /// Nodes in double precision.
    F64(&'a [Quad<f64>]),
    /// Nodes in single precision.
    F32(&'a [Quad<f32>]),
}

impl NodalView<'_> {
    /// The vector at an engine node.
    ///
    /// # Panics
    /// If `node` is out of range.
    #[inline]
    pub fn vector(&self, node: usize) -> Vec3 {
        match self {
            Self::F64(values) => values[node].to_vector(),
            Self::F32(values) => values[node].to_vector(),
        }
    }
    /// How many nodes the field has.
    pub fn len(&self) -> usize {
        match self {
            Self::F64(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }
    /// Whether the field has no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Write access to the values of a block's own nodes, in the order of
/// [`ElementBlock::nodes`](crate::ElementBlock::nodes).
#[derive(Debug)]
pub enum NodalViewMut<'a> {
    /// Nodes in double precision.
    F64(&'a mut [Quad<f64>]),
    /// Nodes in single precision.
    F32(&'a mut [Quad<f32>]),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quad_never_straddles_a_cache_line() {
        assert_eq!(core::mem::size_of::<Quad<f64>>(), 32);
        assert_eq!(core::mem::align_of::<Quad<f64>>(), 32);
        assert_eq!(core::mem::size_of::<Quad<f32>>(), 16);
        assert_eq!(core::mem::align_of::<Quad<f32>>(), 16);
    }
}
