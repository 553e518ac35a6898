//! Gather of nodal values into lanes, and scatter of forces to nodes.

use powerhouse_model::{NodalView, NodalViewMut, Scalar};

use super::batches::Batch;
use super::exchange::{Exchange, Exchanges};
use super::memory::{Connectivity, NodesOf, SumsOf};
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

/// Gathers nodal values in the storage that they have, which is known at run time alone: kernels and laws are compiled once for
/// both.
///
/// # Panics
/// If values in single precision are given to elements in double precision, which convert them before.
#[inline(always)]
pub(super) fn gather_view<L, const N: usize>(
    token: L::Token,
    connectivity: &Connectivity<N>,
    (nodes, first): (NodalView, usize),
    values: &mut [[L; 3]; N],
) where
    L: BatchLane<Scalar: BatchScalar>,
{
    match nodes {
        NodalView::F64(nodes) => {
            let nodes = connectivity.over(nodes).elements(first, L::WIDTH);
            gather::<f64, L, N>(token, nodes, values);
        }
        NodalView::F32(nodes) if const { size_of::<L::Scalar>() == size_of::<f32>() } => {
            let nodes = connectivity.over(nodes).elements(first, L::WIDTH);
            gather::<f32, L, N>(token, nodes, values);
        }
        NodalView::F32(_) => panic!("{CONVERTED}"),
    }
}

/// Panic message of elements in double precision that are given nodal values in single precision.
const CONVERTED: &str = "elements in double precision convert nodal values in single precision";

/// Adds forces to the nodes of a batch, element after element, for any width.
///
/// # Panics
/// As [`gather_view`].
#[inline(always)]
pub(super) fn scatter<L, const N: usize>(
    forces: &[[L; 3]; N],
    batch: &Batch<L::Scalar, N>,
    rows: &mut [Rows<L::Scalar>; N],
    (connectivity, out): (&Connectivity<N>, &mut NodalViewMut),
) where
    L: BatchLane<Scalar: BatchScalar>,
{
    for a in 0..N {
        L::write_rows(forces[a], &mut rows[a]);
    }
    match out {
        NodalViewMut::F64(out) => {
            let out = &mut connectivity.over_sums(out);
            add::<f64, L, N>(rows, batch, out.elements(batch.first, L::WIDTH));
        }
        NodalViewMut::F32(out) if const { size_of::<L::Scalar>() == size_of::<f32>() } => {
            let out = &mut connectivity.over_sums(out);
            add::<f32, L, N>(rows, batch, out.elements(batch.first, L::WIDTH));
        }
        NodalViewMut::F32(_) => panic!("{CONVERTED}"),
    }
}

/// Adds rows of forces to the sums at the nodes of a batch.
#[inline(always)]
fn add<A, L, const N: usize>(
    rows: &[Rows<L::Scalar>; N],
    batch: &Batch<L::Scalar, N>,
    mut out: SumsOf<A, N>,
) where
    A: BatchScalar,
    L: BatchLane<Scalar: BatchScalar>,
{
    // A loop of its own for whole batches, without a branch between elements.
    if batch.is_whole(L::WIDTH) {
        for j in 0..L::WIDTH {
            batch.prefetch(j, L::WIDTH);
            add_element(j, rows, &mut out);
        }
    } else {
        for j in 0..L::WIDTH {
            if batch.has(j) {
                add_element(j, rows, &mut out);
            }
        }
    }
}

/// Adds the forces of element `j` of a batch to its nodes.
#[inline(always)]
fn add_element<A: BatchScalar, S: BatchScalar, const N: usize>(
    j: usize,
    rows: &[Rows<S>; N],
    out: &mut SumsOf<A, N>,
) {
    for a in 0..N {
        let sum = out.sum(j, a);
        for c in 0..4 {
            sum[c] = sum[c] + convert(rows[a][j][c]);
        }
    }
}

/// Scalar type of nodal velocities and forces, and of the arithmetic of elements.
pub(super) trait NodeScalar: BatchScalar {
    /// The exchange buffers in this scalar type.
    fn exchange(exchanges: &mut Exchanges) -> &mut Exchange<Self>;
}

impl NodeScalar for f64 {
    fn exchange(exchanges: &mut Exchanges) -> &mut Exchange<f64> {
        &mut exchanges.double
    }
}

impl NodeScalar for f32 {
    fn exchange(exchanges: &mut Exchanges) -> &mut Exchange<f32> {
        &mut exchanges.single
    }
}

/// A number converted to another scalar type, rounded.
#[inline(always)]
fn convert<A: Scalar, B: Scalar>(value: A) -> B {
    B::from_f64(value.to_f64())
}
