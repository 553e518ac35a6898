//! From nodes to lanes and back.

use powerhouse_model::{Quad, Scalar};

use crate::lanes::{BatchLane, BatchScalar, MOST_LANES, Rows};

/// The elements of a block, batch by batch.
#[derive(Clone, Copy)]
pub(super) struct Batches<'a, S, const N: usize> {
    /// How many elements; the rest of the last batch repeats the last element.
    pub(super) elements: usize,
    /// Engine numbers of their nodes, whole batches.
    pub(super) engine: &'a [[u32; N]],
    /// Places of their nodes in the block, whole batches.
    pub(super) places: &'a [[u32; N]],
    /// Which elements take part; all if `None`.
    pub(super) active: Option<&'a [bool]>,
    /// Geometry numbers of whole batches.
    pub(super) geometry: &'a [S],
    /// Geometry numbers of one element.
    pub(super) geometry_len: usize,
}

/// One batch.
#[derive(Clone, Copy)]
pub(super) struct Batch<'a, S, const N: usize> {
    /// Number of its first element in the block.
    pub(super) first: usize,
    /// How many elements it holds.
    pub(super) count: usize,
    /// Engine numbers of the nodes.
    pub(super) engine: &'a [[u32; N]],
    /// Places of the nodes.
    pub(super) places: &'a [[u32; N]],
    /// Which elements take part.
    pub(super) active: Option<&'a [bool]>,
    /// Geometry numbers.
    pub(super) geometry: &'a [S],
}

impl<'a, S: BatchScalar, const N: usize> Batches<'a, S, N> {
    /// How many batches of a width.
    #[inline(always)]
    pub(super) fn count(&self, width: usize) -> usize {
        self.elements.div_ceil(width)
    }
    /// One batch of a width.
    #[inline(always)]
    pub(super) fn batch(&self, index: usize, width: usize) -> Batch<'a, S, N> {
        let first = index * width;
        let count = width.min(self.elements - first);
        let numbers = self.geometry_len * width;
        Batch {
            first,
            count,
            engine: &self.engine[first..first + width],
            places: &self.places[first..first + width],
            active: self.active.map(|active| &active[first..first + count]),
            geometry: &self.geometry[index * numbers..(index + 1) * numbers],
        }
    }
}

impl<S, const N: usize> Batch<'_, S, N> {
    /// Whether element `j` of the batch exists and takes part.
    #[inline(always)]
    pub(super) fn has(&self, j: usize) -> bool {
        j < self.count && self.active.is_none_or(|active| active[j])
    }
}

/// Nodal values of a batch, one element per lane.
///
/// Where nodes are stored in more digits than elements are computed in, values are taken against
/// those of the element's first node, in the nodes' digits: only differences enter a strain.
#[inline(always)]
pub(super) fn gather<A, L, const N: usize>(
    token: L::Token,
    nodes: &[Quad<A>],
    elements: &[[u32; N]],
) -> [[L; 3]; N]
where
    A: BatchScalar,
    L: BatchLane<Scalar: BatchScalar>,
{
    let mut values = [[L::splat(token, 0.0); 3]; N];
    for a in 0..N {
        let mut rows: Rows<L::Scalar> = [[L::Scalar::default(); 4]; MOST_LANES];
        for j in 0..L::WIDTH {
            let mut value = nodes[elements[j][a] as usize].values;
            if size_of::<A>() > size_of::<L::Scalar>() {
                let first = nodes[elements[j][0] as usize].values;
                for c in 0..4 {
                    value[c] = value[c] - first[c];
                }
            }
            for c in 0..4 {
                rows[j][c] = convert(value[c]);
            }
        }
        values[a] = L::components(token, &rows);
    }
    values
}

/// Adds forces to the nodes of a batch, element after element, whatever the width.
#[inline(always)]
pub(super) fn scatter<A, L, const N: usize>(
    forces: &[[L; 3]; N],
    batch: &Batch<L::Scalar, N>,
    rows: &mut [Rows<L::Scalar>; N],
    out: &mut [Quad<A>],
) where
    A: BatchScalar,
    L: BatchLane<Scalar: BatchScalar>,
{
    for a in 0..N {
        L::write_rows(forces[a], &mut rows[a]);
    }
    for j in 0..L::WIDTH {
        if !batch.has(j) {
            continue;
        }
        for a in 0..N {
            let sum = &mut out[batch.places[j][a] as usize].values;
            for c in 0..4 {
                sum[c] = sum[c] + convert(rows[a][j][c]);
            }
        }
    }
}

/// From one scalar to the other, rounded.
#[inline(always)]
fn convert<A: Scalar, B: Scalar>(value: A) -> B {
    B::from_f64(value.to_f64())
}

/// [`gather`], measured from a reference displacement that is stored by place.
#[inline(always)]
pub(super) fn gather_from<A, L, const N: usize>(
    token: L::Token,
    nodes: &[Quad<A>],
    reference: Option<&[Quad<f64>]>,
    batch: &Batch<L::Scalar, N>,
) -> [[L; 3]; N]
where
    A: BatchScalar,
    L: BatchLane<Scalar: BatchScalar>,
{
    let Some(reference) = reference else {
        return gather(token, nodes, batch.engine);
    };
    let relative = |j: usize, a: usize| -> [f64; 3] {
        let value = nodes[batch.engine[j][a] as usize].values;
        let from = reference[batch.places[j][a] as usize].values;
        [
            value[0].to_f64() - from[0],
            value[1].to_f64() - from[1],
            value[2].to_f64() - from[2],
        ]
    };
    let mut values = [[L::splat(token, 0.0); 3]; N];
    for a in 0..N {
        let mut rows: Rows<L::Scalar> = [[L::Scalar::default(); 4]; MOST_LANES];
        for j in 0..L::WIDTH {
            let (value, first) = (relative(j, a), relative(j, 0));
            for c in 0..3 {
                rows[j][c] = convert(value[c] - first[c]);
            }
        }
        values[a] = L::components(token, &rows);
    }
    values
}
