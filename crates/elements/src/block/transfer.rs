//! Gather of nodal values into lanes, and scatter of forces to nodes.

use powerhouse_model::{Quad, Scalar, Vec3};

use super::batches::Batch;
use super::exchange::{Exchange, Exchanges};
use super::memory::NodesOf;
use crate::lanes::{BatchLane, BatchScalar, MOST_LANES, Rows};

/// Gathers the nodal values of a batch, one element per lane.
///
/// Where nodes are stored in a higher precision than elements are computed in, values are taken relative to
/// those of the element's first node, in the precision of the nodes: only differences enter a strain.
#[inline(always)]
pub(super) fn gather<A, L, const N: usize>(
    token: L::Token,
    nodes: NodesOf<A, N>,
    values: &mut [[L; 3]; N],
) where
    A: BatchScalar,
    L: BatchLane<Scalar: BatchScalar>,
{
    let rounded = size_of::<A>() > size_of::<L::Scalar>();
    let mut first: Rows<A> = [[A::default(); 4]; MOST_LANES];
    if rounded {
        for j in 0..L::WIDTH {
            first[j] = nodes.value(j, 0);
        }
    }
    for a in 0..N {
        let mut rows: Rows<L::Scalar> = [[L::Scalar::default(); 4]; MOST_LANES];
        for j in 0..L::WIDTH {
            let mut value = nodes.value(j, a);
            if rounded {
                for c in 0..4 {
                    value[c] = value[c] - first[j][c];
                }
            }
            for c in 0..4 {
                rows[j][c] = convert(value[c]);
            }
        }
        values[a] = L::components(token, &rows);
    }
}

/// Adds forces to the nodes of a batch, element after element, for any width.
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
    let whole = batch.is_whole(L::WIDTH);
    for j in 0..L::WIDTH {
        batch.prefetch(j, L::WIDTH);
        if !whole && !batch.has(j) {
            continue;
        }
        for a in 0..N {
            let sum = &mut out[batch.connectivity[j][a] as usize].values;
            for c in 0..4 {
                sum[c] = sum[c] + convert(rows[a][j][c]);
            }
        }
    }
}

/// Nodal values of a block by local node index, so that its elements read a small contiguous piece of memory.
#[derive(Debug, Default)]
pub(super) struct Locals {
    /// Displacement since the reference (m).
    pub(super) displacement: Vec<Quad<f64>>,
    /// Velocity (m/s) in either storage.
    double: Vec<Quad<f64>>,
    single: Vec<Quad<f32>>,
}

/// Scalar type of nodal velocities and forces, and of the arithmetic of elements.
pub(super) trait NodeScalar: BatchScalar {
    /// Local displacements, and local velocities in this scalar type.
    fn local(locals: &mut Locals) -> (&mut Vec<Quad<f64>>, &mut Vec<Quad<Self>>);
    /// The exchange buffers in this scalar type.
    fn exchange(exchanges: &mut Exchanges) -> &mut Exchange<Self>;
}

impl NodeScalar for f64 {
    fn local(locals: &mut Locals) -> (&mut Vec<Quad<f64>>, &mut Vec<Quad<f64>>) {
        (&mut locals.displacement, &mut locals.double)
    }
    fn exchange(exchanges: &mut Exchanges) -> &mut Exchange<f64> {
        &mut exchanges.double
    }
}

impl NodeScalar for f32 {
    fn local(locals: &mut Locals) -> (&mut Vec<Quad<f64>>, &mut Vec<Quad<f32>>) {
        (&mut locals.displacement, &mut locals.single)
    }
    fn exchange(exchanges: &mut Exchanges) -> &mut Exchange<f32> {
        &mut exchanges.single
    }
}

impl Locals {
    /// No values.
    pub(super) const NONE: Self = Self {
        displacement: Vec::new(),
        double: Vec::new(),
        single: Vec::new(),
    };
    /// The last displacement of a node (m) by local index, zero if there is none.
    pub(super) fn displacement(&self, node: usize) -> Vec3 {
        let value = self.displacement.get(node);
        value.map_or_else(Vec3::zeros, |value| value.to_vector())
    }
}

/// Copies the values of the nodes of a block; its first run of successive numbers as a whole.
pub(super) fn copy_nodes<A: BatchScalar>(
    nodes: &[Quad<A>],
    of: &BlockNodes,
    to: &mut Vec<Quad<A>>,
) {
    to.clear();
    to.extend_from_slice(&nodes[of.run.clone()]);
    let rest = &of.numbers[of.run.len()..];
    to.extend(rest.iter().map(|&node| nodes[node as usize]));
}

/// Engine numbers of the nodes of a block, by local node index.
#[derive(Debug)]
pub(super) struct BlockNodes {
    /// Engine numbers of all nodes.
    pub(super) numbers: Vec<u32>,
    /// The longest run of successive numbers at the start.
    run: core::ops::Range<usize>,
}

impl BlockNodes {
    pub(super) fn new(numbers: Vec<u32>) -> Self {
        let first = numbers.first().map_or(0, |&number| number as usize);
        let run = (first..)
            .zip(&numbers)
            .take_while(|&(n, &number)| n == number as usize);
        let run = first..first + run.count();
        Self { numbers, run }
    }
}

/// A number converted to another scalar type, rounded.
#[inline(always)]
fn convert<A: Scalar, B: Scalar>(value: A) -> B {
    B::from_f64(value.to_f64())
}
