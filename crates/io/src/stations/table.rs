//! Motions of stations in a table.

use std::path::Path;

use super::{StationFileFault, StationForm, StationMotions, check_memory};
use crate::TableColumn;

/// Memory (bytes) that reading a table takes at most for each byte of it: of its numbers, eight for the shortest of two
/// characters, of the text, and of growing lists.
const BYTES_PER_BYTE: u64 = 10;
/// Largest difference of a time from a uniform one, over the step.
const UNIFORM: f64 = 0.01;
/// Units of length and of speed, with their factors.
const PLACE: [(&str, f64); 2] = [("m", 1.0), ("km", 1000.0)];
const DISPLACEMENT: [(&str, f64); 3] = [("m", 1.0), ("cm", 0.01), ("mm", 0.001)];
const VELOCITY: [(&str, f64); 3] = [("m/s", 1.0), ("cm/s", 0.01), ("mm/s", 0.001)];

pub(super) fn read(file: &Path, most: u64) -> Result<StationMotions, StationFileFault> {
    let bytes = crate::read_whole(file, most / BYTES_PER_BYTE).map_err(StationFileFault::Read)?;
    let columns = crate::parse_table(&bytes, file).map_err(StationFileFault::Table)?;
    drop(bytes);
    of_columns(&columns, most)
}

fn of_columns(columns: &[TableColumn], most: u64) -> Result<StationMotions, StationFileFault> {
    let places = ["x", "y", "z"].map(|name| column(columns, name, &PLACE));
    let [x, y, z] = places;
    let places = [x?, y?, z?];
    let inner = column(columns, "inner", &[("1", 1.0)])?;
    let time = column(columns, "time", &[("s", 1.0)])?;
    let [x, y, z] = ["ux", "uy", "uz"].map(|name| column(columns, name, &DISPLACEMENT));
    let mut motions = vec![x?, y?, z?];
    let velocity = ["vx", "vy", "vz"];
    let has_velocity = columns.iter().any(|c| velocity.contains(&c.name.as_str()));
    if has_velocity {
        let [x, y, z] = velocity.map(|name| column(columns, name, &VELOCITY));
        motions.extend([x?, y?, z?]);
    }
    let rows = time.numbers.len();
    if rows < 2 {
        let reason = "there must be two samples of a station at least".into();
        return Err(StationFileFault::Row { row: rows, reason });
    }
    let place = |row: usize| places.each_ref().map(|column| column.at(row));
    let first = place(0);
    let samples = (1..rows).find(|row| place(*row) != first).unwrap_or(rows);
    let (start, step) = (
        time.at(0),
        (time.at(samples - 1) - time.at(0)) / (samples.max(2) - 1) as f64,
    );
    let fault = |row: usize, reason: String| StationFileFault::Row {
        row: row + 1,
        reason,
    };
    if samples < 2 {
        let reason = "the first station has one row, it needs two samples at least; rows are sorted by station, then by time";
        return Err(fault(1, reason.into()));
    }
    if !(step > 0.0 && step.is_finite() && start.is_finite()) {
        let reason =
            format!("the times of the first station, from {start} s by {step} s, do not rise");
        return Err(fault(0, reason));
    }
    check_memory(
        (rows / samples) as u64,
        samples as u64,
        motions.len() as u64,
        most,
    )?;
    let mut found = StationMotions {
        form: StationForm::Table,
        positions: Vec::with_capacity(rows / samples),
        inner: Vec::with_capacity(rows / samples),
        origin: [0.0; 3],
        start,
        step,
        samples,
        has_velocity,
        motion: Vec::with_capacity(rows * motions.len()),
        other_order: None,
        warnings: Vec::new(),
    };
    for row in 0..rows {
        let sample = row % samples;
        let (here, side) = (place(row), inner.at(row));
        if sample == 0 {
            if here.iter().any(|x| !x.is_finite()) || (side != 0.0 && side != 1.0) {
                let reason = format!(
                    "a station at {here:?} m with inner = {side}; expected finite coordinates, and inner = 0 or 1"
                );
                return Err(fault(row, reason));
            }
            found.positions.push(here);
            found.inner.push(side == 1.0);
        }
        let is_same = found.positions.last() == Some(&here);
        if !is_same || found.inner.last() != Some(&(side == 1.0)) {
            let reason = format!(
                "sample {sample} of a station at {here:?} m, inner = {side}, after those of {:?}: every station has {samples} rows, as the first one",
                found.positions.last().unwrap_or(&first)
            );
            return Err(fault(row, reason));
        }
        let expected = start + step * sample as f64;
        let uniform = (time.at(row) - expected).abs() <= UNIFORM * step;
        if !uniform {
            let reason = format!(
                "time {} s is not the expected {expected} s: all stations have the same uniform times",
                time.at(row)
            );
            return Err(fault(row, reason));
        }
        for motion in &motions {
            let number = motion.at(row);
            if !number.is_finite() {
                return Err(fault(row, format!("{number} is not finite")));
            }
            found.motion.push(number);
        }
    }
    if !rows.is_multiple_of(samples) {
        let reason = format!(
            "the last station has {} rows, the first one {samples}",
            rows % samples
        );
        return Err(fault(rows - 1, reason));
    }
    Ok(found)
}

/// Numbers of a column, and the factor of their unit.
struct Column<'t> {
    numbers: &'t [f64],
    factor: f64,
}

impl Column<'_> {
    fn at(&self, row: usize) -> f64 {
        self.factor * self.numbers[row]
    }
}

fn column<'t>(
    columns: &'t [TableColumn],
    name: &'static str,
    units: &[(&str, f64)],
) -> Result<Column<'t>, StationFileFault> {
    let named = columns.iter().filter(|column| column.name == name);
    let mut known = named.filter_map(|column| {
        let (_, factor) = units.iter().find(|(unit, _)| *unit == column.unit)?;
        Some(Column {
            numbers: &column.values,
            factor: *factor,
        })
    });
    known.next().ok_or_else(|| {
        let found = columns.iter().map(|c| format!("{} [{}]", c.name, c.unit));
        let units: Vec<String> = units.iter().map(|(unit, _)| format!("[{unit}]")).collect();
        StationFileFault::NoColumn {
            name,
            units: units.join(" or "),
            found: found.take(20).collect::<Vec<_>>().join(", "),
        }
    })
}
