//! Histories of the energy balance.

use powerhouse_model::{Cadence, Fields, Flow, ModelError, Observer, Reach, StateError, StepView};

use super::{HistoryTable, ObserveError, Recording, check_cadence, table_cadence};

/// Observer of the energy balance: its columns (J) against time, under the engine's names; the last step is
/// the last row.
///
/// Memory: 8 bytes per column and row.
pub struct EnergyHistory {
    cadence: Cadence,
    row: Vec<f64>,
    recording: Recording<HistoryTable>,
}

impl EnergyHistory {
    /// An observer with a cadence.
    ///
    /// # Errors
    /// A cadence out of range.
    pub fn new(cadence: Cadence) -> Result<Self, ObserveError> {
        check_cadence(cadence)?;
        Ok(Self {
            cadence,
            row: Vec::new(),
            recording: Recording::default(),
        })
    }
    /// Shared access to the table; it has columns after the first observed step.
    pub fn recording(&self) -> Recording<HistoryTable> {
        self.recording.clone()
    }
}

impl Observer for EnergyHistory {
    fn name(&self) -> &str {
        "energy history"
    }
    fn fields(&self) -> Fields {
        Fields::default().with_energy(true)
    }
    fn reach(&self) -> Reach {
        Reach::NONE
    }
    fn cadence(&self) -> Cadence {
        table_cadence(self.cadence)
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        self.recording.save()
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        self.recording.restore(saved, |found, here| {
            // There are no columns before the first observed step.
            if here.columns.is_empty() {
                Ok(())
            } else {
                StateError::expect_same("the list of columns", found.names(), here.names())
            }
        })
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let energies = view.energies();
        if energies.is_empty() {
            return Err(ObserveError::NoLedger.into());
        }
        let mut table = self.recording.lock();
        if table.is_new() {
            table.columns.clear();
            for (name, _) in energies {
                table.add_column((*name).into(), "J")?;
            }
        }
        let expected = table.columns.iter().map(|column| column.name.as_str());
        if !expected.clone().eq(energies.iter().map(|energy| energy.0)) {
            return Err(ObserveError::LedgerChanged {
                found: energies.iter().map(|energy| energy.0.into()).collect(),
                expected: expected.map(String::from).collect(),
            }
            .into());
        }
        self.row.clear();
        self.row.extend(energies.iter().map(|energy| energy.1));
        table.see(self.cadence, view, &self.row);
        Ok(Flow::Continue)
    }
    fn finish(&mut self) -> Result<(), ModelError> {
        self.recording.lock().end();
        Ok(())
    }
}
