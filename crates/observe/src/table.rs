//! Tables of named time histories.

use super::ObserveError;

/// A time history of one quantity, with name and unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name of the quantity, such as `crown.ux`.
    pub name: String,
    /// Unit of the values, such as `m/s2`.
    pub unit: &'static str,
    /// Values, one per time of the table.
    pub values: Vec<f64>,
}

/// A table of time histories with common times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HistoryTable {
    /// Times (s), rising.
    pub times: Vec<f64>,
    /// Columns, each as long as `times`.
    pub columns: Vec<Column>,
}

impl HistoryTable {
    /// The column with a name; none if there is no such column.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }
    /// Adds an empty column.
    pub(super) fn add_column(
        &mut self,
        name: String,
        unit: &'static str,
    ) -> Result<(), ObserveError> {
        if self.column(&name).is_some() {
            return Err(ObserveError::NameTwice { name });
        }
        self.columns.push(Column {
            name,
            unit,
            values: Vec::new(),
        });
        Ok(())
    }
    /// Adds a row, one value per column.
    pub(super) fn push(&mut self, time: f64, row: &[f64]) {
        self.times.push(time);
        for (column, &value) in self.columns.iter_mut().zip(row) {
            column.values.push(value);
        }
    }
}
