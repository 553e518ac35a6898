//! A cell of the atlas, and a row of cells.

use super::column::Column;

/// Reason of a refusal.
pub(super) type Refusal = Box<dyn std::error::Error>;

/// Result of a cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell {
    /// Stable: bounded motion and a closed energy balance.
    Stable,
    /// Refused before its first step, with the reason.
    Refused(String),
}

/// A cell, or a fault that no cell may have.
pub(super) type Found = Result<Cell, String>;

/// A row: an extreme, tested in every column.
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
