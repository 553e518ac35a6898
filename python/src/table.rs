//! Tables of time histories.

use numpy::PyArray1;
use powerhouse::engine::observe::HistoryTable;
use pyo3::prelude::*;

use crate::arrays::of_list;

/// Time histories with common times: times (s), names, units and values of the columns.
#[pyclass(frozen, module = "powerhouse_fe._core")]
pub(crate) struct Table {
    #[pyo3(get)]
    times: Py<PyArray1<f64>>,
    #[pyo3(get)]
    names: Vec<String>,
    #[pyo3(get)]
    units: Vec<String>,
    #[pyo3(get)]
    values: Vec<Py<PyArray1<f64>>>,
}

impl Table {
    /// The table, whose arrays have the memory of the recorded columns.
    pub(crate) fn new(py: Python<'_>, table: HistoryTable) -> Self {
        let mut found = Self {
            times: of_list(py, table.times).unbind(),
            names: Vec::new(),
            units: Vec::new(),
            values: Vec::new(),
        };
        for column in table.columns {
            found.names.push(column.name);
            found.units.push(column.unit.to_owned());
            found.values.push(of_list(py, column.values).unbind());
        }
        found
    }
}
