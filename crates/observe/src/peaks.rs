//! Table of the extreme values of a run.

use core::fmt;

use powerhouse_model::Mesh;

use super::{EnvelopeTable, HistoryTable, PeakField, StateTable};

/// Location of a peak, by the user's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeakPlace {
    /// A node.
    Node(u64),
    /// An element.
    Element(u64),
}

impl fmt::Display for PeakPlace {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Node(number) => write!(formatter, "node {number}"),
            Self::Element(number) => write!(formatter, "element {number}"),
        }
    }
}

/// A peak: the value of largest magnitude of one quantity, with time and location.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakRow {
    /// Name of the quantity: that of a column such as `crown.ux`, or of an envelope.
    pub name: String,
    /// Unit of the value in SI, such as `m/s2`.
    pub unit: &'static str,
    /// The value with its sign, in the [unit](Self::unit).
    pub value: f64,
    /// Time of the peak (s).
    pub time: f64,
    /// Location of the peak, unless the name implies it.
    pub place: Option<PeakPlace>,
}

/// Table of the peaks of a run, one row per quantity.
///
/// ```
/// use powerhouse_observe::{Column, HistoryTable, PeakTable};
/// let column = Column::new("crown.ux", "m", vec![0.0, -0.03, 0.02]);
/// let table = HistoryTable::new(vec![0.0, 0.1, 0.2], vec![column]);
/// let mut peaks = PeakTable::default();
/// peaks.add_history(&table);
/// assert_eq!((peaks.rows[0].value, peaks.rows[0].time), (-0.03, 0.1));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PeakTable {
    /// Peaks of the run, one for each quantity.
    pub rows: Vec<PeakRow>,
}

/// Share of the largest peak with the same unit below which a peak counts as rounding. Rounding errors of a
/// displacement, about 1e-16 of the largest, are divided by the square of the step in an acceleration; 1e-9 of the
/// largest is above both, and below any relevant motion.
const ROUNDING: f64 = 1e-9;

impl PeakTable {
    /// Whether a peak is a rounding error: not zero, but below 1e-9 of the largest peak with the same unit.
    pub fn is_rounding(&self, row: &PeakRow) -> bool {
        let of_unit = self.rows.iter().filter(|other| other.unit == row.unit);
        let largest = of_unit.fold(0.0_f64, |most, other| most.max(other.value.abs()));
        row.value != 0.0 && row.value.abs() < ROUNDING * largest
    }

    /// Adds the [peak](super::Column::peak) of every column.
    pub fn add_history(&mut self, table: &HistoryTable) {
        for column in &table.columns {
            if let Some((value, time)) = column.peak(&table.times) {
                self.rows.push(PeakRow {
                    name: column.name.clone(),
                    unit: column.unit,
                    value,
                    time,
                    place: None,
                });
            }
        }
    }

    /// Adds the greatest instants of the accelerations of a table, [all steps](super::Column::instant_peak) counted, as
    /// `NAME (instant)`.
    pub fn add_instants(&mut self, table: &HistoryTable) {
        for column in &table.columns {
            if let Some((value, time)) = column.instant_peak() {
                self.rows.push(PeakRow {
                    name: format!("{} (instant)", column.name),
                    unit: column.unit,
                    value,
                    time,
                    place: None,
                });
            }
        }
    }

    /// Adds the extremes of an envelope over all its nodes and elements, with names that begin with `name`; none
    /// without observations.
    ///
    /// # Panics
    /// If the envelope is of another mesh, with more nodes or elements.
    pub fn add_envelope(&mut self, name: &str, table: &EnvelopeTable, mesh: &Mesh) {
        if table.observations == 0 {
            return;
        }
        let node = |index: usize| PeakPlace::Node(mesh.node_tags()[table.nodes[index] as usize]);
        let element =
            |index: usize| PeakPlace::Element(mesh.element_tags()[table.elements[index] as usize]);
        self.add_extreme(
            format!("{name} displacement"),
            "m",
            &table.displacement,
            1.0,
            node,
        );
        self.add_extreme(
            format!("{name} velocity"),
            "m/s",
            &table.velocity,
            1.0,
            node,
        );
        self.add_extreme(
            format!("{name} acceleration"),
            "m/s2",
            &table.acceleration,
            1.0,
            node,
        );
        self.add_extreme(
            format!("{name} greatest stress"),
            "Pa",
            &table.greatest_stress,
            1.0,
            element,
        );
        self.add_extreme(
            format!("{name} least stress"),
            "Pa",
            &table.least_stress,
            -1.0,
            element,
        );
    }

    /// Adds the extremes of the envelopes of history variables, where they are above zero.
    ///
    /// # Panics
    /// If the table is of another mesh, with more elements.
    pub fn add_state(&mut self, table: &StateTable, mesh: &Mesh) {
        let element =
            |index: usize| PeakPlace::Element(mesh.element_tags()[table.elements[index] as usize]);
        for (variable, field) in &table.peaks {
            if field.values.iter().any(|value| *value > 0.0) {
                self.add_extreme(variable.name.into(), variable.unit, field, 1.0, element);
            }
        }
    }

    /// Adds the greatest of the values times a sign.
    fn add_extreme(
        &mut self,
        name: String,
        unit: &'static str,
        field: &PeakField,
        sign: f64,
        place: impl Fn(usize) -> PeakPlace,
    ) {
        let values = field.values.iter().enumerate();
        let extreme = values.reduce(|a, b| if sign * b.1 > sign * a.1 { b } else { a });
        if let Some((index, &value)) = extreme {
            self.rows.push(PeakRow {
                name,
                unit,
                value,
                time: field.times[index],
                place: Some(place(index)),
            });
        }
    }
}

impl fmt::Display for PeakTable {
    /// One line per row: name, value, unit, time and location; zero with the note `below rounding` for rounding errors.
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let width = self
            .rows
            .iter()
            .map(|row| row.name.len())
            .max()
            .unwrap_or(0);
        for row in &self.rows {
            let PeakRow {
                name,
                unit,
                value,
                time,
                place,
            } = row;
            if self.is_rounding(row) {
                writeln!(
                    formatter,
                    "{name:width$}  {:>12} {unit:<6} below rounding",
                    0
                )?;
                continue;
            }
            write!(
                formatter,
                "{name:width$}  {value:>12.4e} {unit:<6} at {time:>9.4} s"
            )?;
            match place {
                Some(place) => writeln!(formatter, ", {place}")?,
                None => writeln!(formatter)?,
            }
        }
        Ok(())
    }
}
