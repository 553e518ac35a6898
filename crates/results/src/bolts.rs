//! Tables of axial forces of bolts.

use powerhouse_io::TableColumn;
use powerhouse_observe::PeakField;
use powerhouse_scene::BoltForces;

/// Table of the bolts of a group: forces at the end of the run, and the greatest over it.
pub(crate) fn columns(of: &BoltForces) -> Vec<TableColumn> {
    let bolts = of.bolts.iter().map(|&bolt| bolt as f64 + 1.0);
    let elements = of.elements.iter().map(|&element| element as f64);
    let end = |i: usize| of.ends.iter().map(|ends| ends[i]).collect();
    let mut columns = vec![
        TableColumn::new("bolt", "1", bolts.collect()),
        TableColumn::new("element", "1", elements.collect()),
        TableColumn::new("from", "m", end(0)),
        TableColumn::new("to", "m", end(1)),
        TableColumn::new("axial force", "N", of.forces.clone()),
    ];
    if let Some(PeakField { values, times }) = &of.greatest {
        columns.push(TableColumn::new("greatest force", "N", values.clone()));
        columns.push(TableColumn::new("time of it", "s", times.clone()));
    }
    columns
}
