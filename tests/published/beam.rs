//! A notched beam in three-point bending.

use super::page::{Row, compare};
use super::{at, greatest, run};

/// Petersson's beam (1981) with bricks of 20, 10 and 5 mm in its ligament, against two points of the curve that code_aster has of it,
/// at the deflections of its ninth and fifteenth step: within 5 %. The greatest load is that of a crack without width.
#[test]
#[ignore = "minutes: cargo test --release --test shelves petersson -- --ignored"]
fn petersson() {
    let mut rows = Vec::new();
    for size in [20, 10, 5] {
        let results = run("beam.toml", &[format!("mesh.file=beam_{size}.msh")]);
        let history = |name: &str| &results.histories().column(name).expect("a history").values;
        let deflections: Vec<f64> = history("load.uz").iter().map(|u| -1e3 * u).collect();
        let shears = &results
            .sections()
            .column("half.shear_across")
            .expect("a section")
            .values;
        let loads: Vec<f64> = shears.iter().map(|half| 2.0 * half.abs()).collect();
        let peak = greatest(&loads);
        let mut row = |what: &str, known: f64, found: f64| {
            rows.push(Row::new(format!("{size} mm, {what}"), known, found, 0.05));
        };
        row("load at 0.36 mm (N)", 774.0, at(&deflections, &loads, 0.36));
        row("load at 0.60 mm (N)", 598.0, at(&deflections, &loads, 0.6));
        row("greatest load (N)", 776.0, loads[peak]);
    }
    compare("Petersson", &rows);
}
