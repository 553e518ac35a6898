//! Nodal values of blocks: precision, sums and differences.

use powerhouse_model::{NodalView, Quad};

use super::transfer::NodeScalar;

/// Whether nodal values are stored in a lower precision than elements are computed in.
pub(super) fn is_narrower<S: NodeScalar>(nodes: &NodalView) -> bool {
    matches!(nodes, NodalView::F32(_)) && const { size_of::<f32>() < size_of::<S>() }
}

/// Nodal values in double precision.
pub(super) fn doubled<A: NodeScalar>(values: &[Quad<A>]) -> Vec<Quad<f64>> {
    let values = values.iter();
    values
        .map(|value| Quad::from_vector(&value.to_vector()))
        .collect()
}

/// Adds vectors times a factor.
pub(super) fn add<A: NodeScalar>(to: &mut [Quad<f64>], values: &[Quad<A>], factor: f64) {
    for (to, value) in to.iter_mut().zip(values) {
        *to = Quad::from_vector(&(to.to_vector() + value.to_vector() * factor));
    }
}

/// The vector `a - b`.
pub(super) fn difference(a: Quad<f64>, b: Quad<f64>) -> Quad<f64> {
    Quad::from_vector(&(a.to_vector() - b.to_vector()))
}

/// Nodal values of a view in double precision.
pub(super) fn in_double(view: NodalView) -> Vec<Quad<f64>> {
    match view {
        NodalView::F64(values) => values.to_vec(),
        NodalView::F32(values) => doubled(values),
    }
}
