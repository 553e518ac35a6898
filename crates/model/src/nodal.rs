//! Storage of nodal vectors.

use crate::{Scalar, Vec3};

/// Number format of nodal values: `f64` (precisions `f64` and `mixed`) or `f32`.
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

/// A nodal vector x, y, z padded with a zero to four numbers, aligned so that it never straddles a cache
/// line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Quad<S: NodalScalar> {
    /// Components x, y, z and the padding.
    pub values: [S; 4],
    alignment: [S::Alignment; 0],
}

impl<S: NodalScalar> Quad<S> {
    /// A nodal vector of three components.
    #[inline(always)]
    pub fn new(x: S, y: S, z: S) -> Self {
        Self {
            values: [x, y, z, S::default()],
            alignment: [],
        }
    }
    /// A nodal vector from a double precision vector, rounded to this number format.
    #[inline(always)]
    pub fn from_vector(vector: &Vec3) -> Self {
        Self::new(
            S::from_f64(vector.x),
            S::from_f64(vector.y),
            S::from_f64(vector.z),
        )
    }
    /// The vector x, y, z in double precision.
    #[inline(always)]
    pub fn to_vector(self) -> Vec3 {
        Vec3::new(
            self.values[0].to_f64(),
            self.values[1].to_f64(),
            self.values[2].to_f64(),
        )
    }
}

/// Read access to a nodal vector field in engine numbering, in either number format.
#[derive(Clone, Copy, Debug)]
pub enum NodalView<'a> {
    /// Nodal vectors in double precision.
    F64(&'a [Quad<f64>]),
    /// Nodal vectors in single precision.
    F32(&'a [Quad<f32>]),
}

impl NodalView<'_> {
    /// Vector at an engine node.
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
    /// Number of nodes for which the field has a vector.
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

/// Write access to the nodal vectors of a block, in the order of
/// [`ElementBlock::nodes`](crate::ElementBlock::nodes).
#[derive(Debug)]
pub enum NodalViewMut<'a> {
    /// Nodal vectors in double precision.
    F64(&'a mut [Quad<f64>]),
    /// Nodal vectors in single precision.
    F32(&'a mut [Quad<f32>]),
}

impl NodalViewMut<'_> {
    /// The same access for a shorter time.
    pub fn reborrow(&mut self) -> NodalViewMut<'_> {
        match self {
            Self::F64(values) => NodalViewMut::F64(values),
            Self::F32(values) => NodalViewMut::F32(values),
        }
    }
    /// Read access.
    pub fn view(&self) -> NodalView<'_> {
        match self {
            Self::F64(values) => NodalView::F64(values),
            Self::F32(values) => NodalView::F32(values),
        }
    }
    /// Adds a vector at an engine node, rounded.
    ///
    /// # Panics
    /// If `node` is out of range.
    #[inline]
    pub fn add(&mut self, node: usize, vector: &Vec3) {
        match self {
            Self::F64(values) => {
                values[node] = Quad::from_vector(&(values[node].to_vector() + vector));
            }
            Self::F32(values) => {
                values[node] = Quad::from_vector(&(values[node].to_vector() + vector));
            }
        }
    }
    /// Sets all vectors to zero.
    pub fn clear(&mut self) {
        match self {
            Self::F64(values) => values.fill(Quad::default()),
            Self::F32(values) => values.fill(Quad::default()),
        }
    }
    /// Replaces all vectors, rounded.
    ///
    /// # Panics
    /// If there are fewer vectors than nodes.
    pub fn set(&mut self, vectors: &[Quad<f64>]) {
        match self {
            Self::F64(values) => values.copy_from_slice(&vectors[..values.len()]),
            Self::F32(values) => {
                for (node, value) in values.iter_mut().enumerate() {
                    *value = Quad::from_vector(&vectors[node].to_vector());
                }
            }
        }
    }
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
