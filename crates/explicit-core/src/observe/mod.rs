//! Observers: what is kept of a run.
//!
//! | observer | keeps | memory |
//! |---|---|---|
//! | [`History`] | motion at probes, relative motion, stress at elements, against time | 8 bytes a column and row |
//! | [`EnergyHistory`] | the columns of the energy ledger | 8 bytes a column and row |
//! | [`SectionForces`] | normal force, shears and moments of cuts through linings and pillars | 8 bytes a column and row, 144 a node of each element of the cut |
//! | [`Envelope`] | largest motion of nodes, greatest and least principal stress of elements, with their times | 16 bytes a node and kind of motion, 32 an element |
//! | [`JointHistories`] | state, slip, opening, tractions and energies of joints, and their pairs as they were last | 8 bytes a column and row, 350 a pair |
//! | [`BoltHistories`] | the greatest axial force of sets of bolts, and that of each segment with its time | 8 bytes a set and row, 16 a segment |
//! | [`StatePeaks`] | the envelopes of history variables of laws, with its time | 16 bytes an element and amount |
//! | [`Snapshots`] | nothing: hands whole fields to a [`SnapshotSink`] | one copy of each field wanted |
//!
//! An observer goes into the run and is lost to its maker; what it collects is read through a
//! [`Recording`], during the run or after it. Results of the first three are [`HistoryTable`]s;
//! [`PeakTable`] sums up tables and envelopes for a report.
//!
//! # Why so
//! *Stresses are changes of stress*: observers see what the engine computes, and an initial stress
//! does not change. *Section forces are a virtual work*, see [`SectionForces`]: integrated
//! tractions of element stresses lose the moment of a lining of one element, and balance no
//! loads on a coarse mesh.
//! *Tables know names and units*, so that whoever writes a file needs no second list of them.

mod bolts;
mod energy;
mod envelope;
mod error;
mod history;
mod joints;
mod peaks;
mod place;
mod principal;
mod recording;
mod section;
mod snapshots;
mod state;
mod table;

pub use bolts::{BoltHistories, BoltPeaks, BoltTables};
pub use energy::EnergyHistory;
pub use envelope::{Envelope, EnvelopeTable, PeakField};
pub use error::ObserveError;
pub use history::{History, HistoryBuilder};
pub use joints::{
    JointHistories, JointOutcome, JointQuantities, JointTable, JointTables, JointWatch,
    TractionPeaks,
};
pub use peaks::{PeakPlace, PeakRow, PeakTable};
pub use place::{Motion, Place, Spot, StressPlace};
pub use principal::principal_stresses;
pub use recording::Recording;
pub use section::{Cut, SectionForces, SectionGeometry};
pub use snapshots::{Snapshot, SnapshotFields, SnapshotSink, Snapshots};
pub use state::{StatePeaks, StateTable};
pub use table::{Column, HistoryTable};

use powerhouse_model::{Cadence, ParameterError};

/// Accepts a cadence of at least one step, or of a positive time.
fn check_cadence(cadence: Cadence) -> Result<(), ParameterError> {
    cadence.check()
}
