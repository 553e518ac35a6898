//! From nodes to lanes and back.

use powerhouse_model::{Quad, Scalar, Vec3};

use crate::lanes::{Arrangement, BatchLane, BatchScalar, MOST_LANES, Rows};

/// The elements of a block, batch by batch.
#[derive(Clone, Copy)]
pub(super) struct Batches<'a, S, const N: usize> {
    /// How many elements; the rest of the last batch repeats the last element.
    pub(super) elements: usize,
    /// Places of their nodes in the block, whole batches.
    pub(super) places: &'a [[u32; N]],
    /// Which elements take part; all if `None`.
    pub(super) active: Option<&'a [bool]>,
    /// Geometry numbers of whole batches.
    pub(super) geometry: &'a [S],
    /// Geometry numbers of one element.
    pub(super) geometry_len: usize,
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
    /// Where elements sit.
    pub(super) arrangement: Arrangement,
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
            places: &self.places[first..first + width],
            active: self.active.map(|active| &active[first..first + count]),
            geometry: &self.geometry[index * numbers..(index + 1) * numbers],
            arrangement: self.arrangement,
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

/// Nodal values of a block by place, so that its elements read a small contiguous piece of memory.
#[derive(Debug, Default)]
pub(super) struct Local<A: BatchScalar> {
    /// Displacement since the reference (m).
    pub(super) displacement: Vec<Quad<A>>,
    /// Velocity (m/s).
    pub(super) velocity: Vec<Quad<A>>,
}

/// [`Local`] values in either storage.
#[derive(Debug, Default)]
pub(super) struct Locals {
    double: Local<f64>,
    single: Local<f32>,
}

/// A storage of nodes.
pub(super) trait NodeScalar: BatchScalar {
    /// The local values in this storage.
    fn local(locals: &mut Locals) -> &mut Local<Self>;
}

impl NodeScalar for f64 {
    fn local(locals: &mut Locals) -> &mut Local<f64> {
        &mut locals.double
    }
}

impl NodeScalar for f32 {
    fn local(locals: &mut Locals) -> &mut Local<f32> {
        &mut locals.single
    }
}

impl Locals {
    /// The displacement that was last used at a place (m), zero if none was.
    pub(super) fn displacement(&self, place: usize) -> Vec3 {
        match (
            self.double.displacement.get(place),
            self.single.displacement.get(place),
        ) {
            (Some(value), _) => value.to_vector(),
            (None, Some(value)) => value.to_vector(),
            (None, None) => Vec3::zeros(),
        }
    }
}

/// Takes over the values of a block's nodes.
pub(super) fn collect<A: BatchScalar>(
    local: &mut Vec<Quad<A>>,
    places: &[u32],
    value: impl Fn(usize, usize) -> Quad<A>,
) {
    local.clear();
    local.extend(
        places
            .iter()
            .enumerate()
            .map(|(place, &node)| value(place, node as usize)),
    );
}

/// From one scalar to the other, rounded.
#[inline(always)]
fn convert<A: Scalar, B: Scalar>(value: A) -> B {
    B::from_f64(value.to_f64())
}
