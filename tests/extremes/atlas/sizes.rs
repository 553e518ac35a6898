//! Bodies of one element, of one layer and of a million; runs of a million steps.

use powerhouse_material_damage::media;
use powerhouse_model::Vec3;

use super::cell::Row;
use super::trial::{Trial, body, elastic};

/// A row of a box of cells of a metre.
fn boxed(name: &'static str, cells: [usize; 3], steps: u64) -> Row {
    Row::new(name, move |column| {
        Trial::of(column).steps(steps).play(|damping| {
            let mesh = column.boxed(Vec3::from_fn(|axis, _| cells[axis] as f64), cells)?;
            body(column, &mesh, &elastic(media::ROCK), damping)
        })
    })
}

pub(super) fn rows() -> Vec<Row> {
    vec![
        boxed("one cell", [1, 1, 1], 1_000),
        boxed("one layer", [5, 4, 1], 1_000),
        boxed("one column", [1, 1, 12], 1_000),
    ]
}

pub(super) fn rows_of_a_million() -> Vec<Row> {
    let million = Row::new("a million elements", |column| {
        let along = (1e6 / column.elements_per_cell() as f64).cbrt().ceil() as usize;
        Trial::of(column).steps(50).play(|damping| {
            let mesh = column.boxed(Vec3::repeat(along as f64), [along; 3])?;
            body(column, &mesh, &elastic(media::ROCK), damping)
        })
    });
    vec![
        boxed("a million steps of one cell", [1, 1, 1], 1_000_000),
        boxed("a million steps of eight cells", [2, 2, 2], 1_000_000),
        million,
    ]
}
