//! The atlas of extremes: each row is an extreme, each column a kernel, number format and scheme, and
//! every cell is stable, or refused before its first step with a reason.
//!
//! The atlas is stored in `docs/extremes.md`; the tests here compute it and compare. To write it again, run
//! them with `POWERHOUSE_ATLAS=write`.

mod amplitudes;
mod cell;
mod column;
mod damping;
mod interfaces;
mod losses;
mod media;
mod shapes;
mod sizes;
mod surroundings;
mod table;
mod trial;

use cell::Row;
use column::Column;

/// All rows with short computing times.
fn rows() -> Vec<Row> {
    let shelves = [
        media::rows(),
        shapes::rows(),
        damping::rows(),
        surroundings::rows(),
        amplitudes::rows(),
        interfaces::rows(),
        losses::rows(),
        sizes::rows(),
    ];
    shelves.into_iter().flatten().collect()
}

/// Every cell of at least 150 is stable or refused before its first step, and the atlas in the
/// documentation says the same.
#[test]
fn every_cell_is_stable_or_refused_before_its_first_step() {
    let rows = rows();
    assert!(rows.len() * Column::ALL.len() >= 150);
    table::compare("Extremes", &rows, &table::fill(&rows));
}

/// The same of a million steps, and of a million elements.
#[test]
#[ignore = "minutes: a million steps, a million elements"]
fn every_cell_of_a_million_is_stable_or_refused() {
    let rows = sizes::rows_of_a_million();
    table::compare("A million", &rows, &table::fill(&rows));
}
