//! Unchecked reads and views as lanes: what an interpreter that finds undefined behaviour can run
//! (`cargo +nightly miri test -p powerhouse-elements --lib memory::tests`).

use powerhouse_model::{Lane, Quad, Vec3};

use super::{Connectivity, as_lanes, as_lanes_mut};
use crate::block::numbers::AlignedNumbers;
use crate::lanes::BatchScalar;

/// Values of the nodes of an element are read by their local indices.
#[test]
fn nodes_are_read_by_element() {
    let connectivity = Connectivity::new(vec![[0, 2], [2, 1], [1, 1]]);
    let nodes: Vec<Quad<f32>> = (0..3)
        .map(|n| Quad::from_vector(&Vec3::new(f64::from(n), 0.5, -1.0)))
        .collect();
    let later = connectivity.over(&nodes).elements(1, 2);
    let first = |j, a| later.value(j, a)[0];
    assert_eq!(
        [first(0, 0), first(0, 1), first(1, 0), first(1, 1)],
        [2.0, 1.0, 1.0, 1.0]
    );
}

/// Fewer nodes than the indices need are refused before any read.
#[test]
#[should_panic(expected = "exceeds the number of nodes")]
fn missing_nodes_are_refused() {
    let connectivity = Connectivity::new(vec![[0, 3]]);
    connectivity.over(&[Quad::<f64>::default(); 3]);
}

/// No element beyond the last is read.
#[test]
#[should_panic(expected = "range")]
fn missing_elements_are_refused() {
    let connectivity = Connectivity::new(vec![[0, 1], [1, 0]]);
    connectivity
        .over(&[Quad::<f64>::default(); 2])
        .elements(1, 2);
}

/// Sums at the nodes of an element are written by the same indices, and nothing else; fewer sums are refused.
#[test]
fn sums_are_written_by_element() {
    let connectivity = Connectivity::new(vec![[0, 2], [2, 1], [1, 1]]);
    let mut sums = [Quad::<f64>::default(); 3];
    let mut view = connectivity.over_sums(&mut sums);
    let mut later = view.elements(1, 2);
    for (j, a) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        later.sum(j, a)[1] += 1.0;
    }
    assert_eq!(sums.map(|sum| sum.to_vector().y), [0.0, 3.0, 1.0]);
    let refused = std::panic::catch_unwind(|| {
        connectivity.over_sums(&mut [Quad::<f64>::default(); 2]);
    });
    assert!(refused.is_err());
}

/// Lanes view the numbers that they are stored as, and write them.
#[test]
fn lanes_are_views_of_numbers() {
    fn check<S: BatchScalar + From<u8> + PartialEq + core::fmt::Debug>() {
        type Narrow<S> = <S as BatchScalar>::Wide<pulp::Scalar>;
        let token = pulp::Scalar::new();
        let width = <Narrow<S> as Lane>::WIDTH;
        let mut numbers = AlignedNumbers::<S>::zeros(3 * width);
        for (i, number) in numbers.as_mut_slice().iter_mut().enumerate() {
            *number = S::from(i as u8);
        }
        let lanes = as_lanes::<Narrow<S>>(token, numbers.as_slice());
        assert_eq!(lanes.len(), 3);
        let copied = lanes[1];
        as_lanes_mut::<Narrow<S>>(token, numbers.as_mut_slice())[2] = copied;
        assert_eq!(numbers.as_slice()[2 * width], S::from(width as u8));
    }
    check::<f64>();
    check::<f32>();
}
