//! A cell of the atlas, and a row of cells.

use super::column::Column;

/// Why something was refused.
pub(super) type Refusal = Box<dyn std::error::Error>;

/// What a cell came to.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell {
    /// It ran, stayed within its bounds and kept its account of energies.
    Stable,
    /// It was refused before its first step, for this reason.
    Refused(String),
}

/// A cell, or what no cell may come to.
pub(super) type Found = Result<Cell, String>;

/// An extreme, tried in every column.
pub(super) struct Row {
    pub(super) name: String,
    pub(super) cell: Box<dyn Fn(&Column) -> Found + Sync>,
}

impl Row {
    pub(super) fn new(
        name: impl Into<String>,
        cell: impl Fn(&Column) -> Found + Sync + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            cell: Box::new(cell),
        }
    }
}
