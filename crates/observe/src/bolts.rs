//! Histories and envelopes of axial bolt forces.

use powerhouse_model::{
    AXIAL_FORCE, Cadence, EmbeddedBars, Fields, Flow, ModelError, Observer, Reach, StateError,
    StepView,
};
use serde::{Deserialize, Serialize};

use super::{HistoryTable, ObserveError, PeakField, Recording, check_cadence, table_cadence};

/// Envelope of the axial forces of a set of bolts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoltPeaks {
    /// Name of the set of bolts.
    pub name: String,
    /// Greatest axial force (N, tension positive) of each segment with its time, bolt by bolt.
    pub greatest: PeakField,
}

/// Results of [`BoltHistories`]: histories and envelopes of axial forces.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoltTables {
    /// Histories: a column `NAME.greatest` for each set, the greatest axial force (N) among its segments at
    /// each time.
    pub history: HistoryTable,
    /// Greatest axial force of each segment over the run with its time, one entry per set.
    pub peaks: Vec<BoltPeaks>,
}

/// Observer of axial bolt forces: the greatest of each set against time, and the envelope
/// of each segment.
///
/// Memory: 8 bytes per set and row, 16 per segment.
pub struct BoltHistories {
    cadence: Cadence,
    recording: Recording<BoltTables>,
}

impl BoltHistories {
    /// An observer of some sets of bolts of the model.
    ///
    /// # Errors
    /// A cadence out of range, two sets with the same name.
    pub fn new<'b, B: EmbeddedBars + 'b>(
        cadence: Cadence,
        sets: impl IntoIterator<Item = &'b B>,
    ) -> Result<Self, ObserveError> {
        check_cadence(cadence)?;
        let mut tables = BoltTables::default();
        for set in sets {
            let column = format!("{}.greatest", set.name());
            tables.history.add_column(column, "N")?;
            tables.peaks.push(BoltPeaks {
                name: set.name().into(),
                greatest: PeakField::new(set.segment_count(), f64::NEG_INFINITY),
            });
        }
        Ok(Self {
            cadence,
            recording: Recording::new(tables),
        })
    }
    /// Shared access to the results.
    pub fn recording(&self) -> Recording<BoltTables> {
        self.recording.clone()
    }
}

impl Observer for BoltHistories {
    fn name(&self) -> &str {
        "bolts"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn reach(&self) -> Reach {
        Reach::NONE.with_embedded()
    }
    fn cadence(&self) -> Cadence {
        table_cadence(self.cadence)
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        self.recording.save()
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        self.recording.restore(saved, |found, here| {
            let sizes = |tables: &BoltTables| -> Vec<(String, usize)> {
                let peaks = tables.peaks.iter();
                peaks
                    .map(|set| (set.name.clone(), set.greatest.values.len()))
                    .collect()
            };
            StateError::expect_same("the list of bolts", sizes(found), sizes(here))
        })
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let time = view.time();
        let mut guard = self.recording.lock();
        let BoltTables { history, peaks } = &mut *guard;
        let mut row = Vec::with_capacity(peaks.len());
        for BoltPeaks { name, greatest } in peaks {
            let forces = view.embedded(name, AXIAL_FORCE);
            let forces = forces.filter(|forces| forces.len() == greatest.values.len());
            let Some(forces) = forces else {
                let name = name.clone();
                return Err(ObserveError::NoSuchBolts { name }.into());
            };
            for (segment, force) in forces.iter().enumerate() {
                greatest.raise(segment, *force, time);
            }
            row.push(forces.into_iter().fold(f64::NEG_INFINITY, f64::max));
        }
        history.see(self.cadence, view, &row);
        Ok(Flow::Continue)
    }
}
