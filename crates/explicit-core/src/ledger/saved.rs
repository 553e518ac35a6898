//! State of the energy ledger between two steps.

use powerhouse_model::{HourglassShare, StateError};
use serde::{Deserialize, Serialize};

use super::Ledger;
use super::sum::Sum;
use super::work::NodalWork;

/// Saved state of the energy ledger.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SavedLedger {
    by_set: bool,
    /// Name, initial energy (J) and largest hourglass work of each element set.
    sets: Vec<(String, f64, HourglassShare)>,
    work_of_block: Vec<Sum>,
    /// Work of the nodal forces in each range of nodes, and of the constraints: friction, bond, impact, external work.
    ranges: Vec<(NodalWork<Sum>, [Sum; 4])>,
    origin: Option<f64>,
    potential: f64,
    scale: f64,
}

impl Ledger {
    /// State between two steps, when no half of a step is pending.
    pub(crate) fn saved(&self) -> SavedLedger {
        let sets = self.sets.iter();
        SavedLedger {
            by_set: self.by_set,
            sets: sets
                .map(|set| (set.label.clone(), set.origin, set.hourglass.clone()))
                .collect(),
            work_of_block: self.work_of_block.clone(),
            ranges: (self.ranges.iter())
                .map(|range| (range.all, range.dissipated))
                .collect(),
            origin: self.origin,
            potential: self.potential,
            scale: self.scale,
        }
    }

    /// Restores the state of a ledger of an equal model.
    pub(crate) fn restore(&mut self, saved: &SavedLedger) -> Result<(), StateError> {
        StateError::expect_same("whether sets are balanced", saved.by_set, self.by_set)?;
        let found: Vec<&str> = saved.sets.iter().map(|set| set.0.as_str()).collect();
        let here: Vec<&str> = self.sets.iter().map(|set| set.label.as_str()).collect();
        StateError::expect_same("the list of element sets", found, here)?;
        let (found, here) = (saved.work_of_block.len(), self.work_of_block.len());
        StateError::expect_same("the number of blocks", found, here)?;
        let (found, here) = (saved.ranges.len(), self.ranges.len());
        StateError::expect_same("the number of node ranges", found, here)?;
        for (set, (_, origin, hourglass)) in self.sets.iter_mut().zip(&saved.sets) {
            (set.origin, set.hourglass) = (*origin, hourglass.clone());
        }
        self.work_of_block.clone_from(&saved.work_of_block);
        for (range, saved) in self.ranges.iter_mut().zip(&saved.ranges) {
            (range.all, range.dissipated) = *saved;
        }
        (self.origin, self.potential, self.scale) = (saved.origin, saved.potential, saved.scale);
        Ok(())
    }
}
