//! Observers: output of a run.
//!
//! | observer | records | memory |
//! |---|---|---|
//! | [`History`] | motion at locations, relative motion, stress and history variables of elements, against time | 8 bytes a column and row |
//! | [`MotionPeaks`] | the peaks of the motions of a [`History`] in every step | nothing of its own |
//! | [`BandLimited`] | the accelerations of a [`History`] up to a frequency, at short even intervals | 8 bytes a column and row |
//! | [`EnergyHistory`] | the columns of the energy balance | 8 bytes a column and row |
//! | [`SectionForces`] | normal force, shear forces and moments of sections through linings and pillars | 8 bytes a column and row, 144 a node of each element at the section |
//! | [`Envelope`] | envelopes of nodal motion, and of greatest and least principal stress of elements | 16 bytes a node and kind of motion, 32 an element |
//! | [`JointHistories`] | state, slip, opening, tractions and energies of joints, and their pairs as they were last | 8 bytes a column and row, 350 a pair |
//! | [`BoltHistories`] | the greatest axial force of sets of bolts against time, and the envelope of each segment | 8 bytes a set and row, 16 a segment |
//! | [`StatePeaks`] | envelopes of the history variables of laws | 16 bytes an element and variable |
//! | [`Snapshots`] | nothing: passes whole fields to a [`SnapshotSink`] | one copy of each field requested |
//!
//! A run takes ownership of its observers; their results are read through a
//! [`Recording`], during the run or after it. Results of the first three are [`HistoryTable`]s;
//! [`PeakTable`] lists the extreme values of tables and envelopes for a report.
//!
//! # Why so
//! *Section forces are computed as virtual work*, see [`SectionForces`]: integrated
//! tractions of element stresses lose the bending moment of a lining of one element, and are not in equilibrium
//! with loads on a coarse mesh.
//! *Tables contain names and units*, so that a writer of files needs no second list of them.

mod band_limited;
mod bolts;
mod capacity;
mod energy;
mod envelope;
mod error;
mod history;
mod joints;
mod motion_peaks;
mod peaks;
mod place;
mod principal;
mod recording;
mod sampler;
mod section;
mod snapshots;
mod state;
mod table;

pub use band_limited::BandLimited;
pub use bolts::{BoltHistories, BoltPeaks, BoltTables};
pub use capacity::{SectionCapacity, SectionReinforcement};
pub use energy::EnergyHistory;
pub use envelope::{Envelope, EnvelopeTable, PeakField};
pub use error::ObserveError;
pub use history::{History, HistoryBuilder};
pub use joints::{
    JointHistories, JointOutcome, JointQuantities, JointTable, JointTables, JointWatch,
    TractionPeaks,
};
pub use motion_peaks::MotionPeaks;
pub use peaks::{PeakPlace, PeakRow, PeakTable};
pub use place::{AccelerationRule, Motion, ObservationPoint, Place, StressPlace};
pub use principal::principal_stresses;
pub use recording::Recording;
pub use sampler::HistorySampler;
pub use section::{
    CrossSection, RingSection, SectionForces, SectionGeometry, SectionPiece, SectionRing,
};
pub use snapshots::{Snapshot, SnapshotFields, SnapshotSink, Snapshots};
pub use state::{StatePeaks, StateTable};
pub use table::{Column, HistoryTable};

use powerhouse_model::{Cadence, ParameterError};

/// Steps that an observer of a [`HistoryTable`] sees, for rows at a cadence.
fn table_cadence(rows: Cadence) -> Cadence {
    match rows {
        Cadence::Seconds(interval) => Cadence::Around(interval),
        other => other,
    }
}

/// Accepts a cadence of at least one step, or of a positive time.
fn check_cadence(cadence: Cadence) -> Result<(), ParameterError> {
    cadence.check()
}
