//! Tables of histories while a run goes on.

use powerhouse_observe::HistoryTable;

/// Table of histories of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunTable {
    /// Motions, stresses and history variables.
    Histories,
    /// Section forces.
    Sections,
    /// Energies.
    Energies,
    /// Joints.
    Joints,
    /// Bolts.
    Bolts,
    /// Band-limited accelerations.
    Accelerations,
}

/// Receiver of the tables of a run while it goes on, such as a writer of files that grow.
pub trait TableSink: Send {
    /// Whether the tables are to be given after this step.
    fn is_due(&mut self) -> bool;
    /// Takes a table with all its rows until now.
    fn take(&mut self, table: RunTable, rows: &HistoryTable);
}
