//! State of the energy ledger between two steps.

use powerhouse_model::{HourglassShare, StateError};
use serde::{Deserialize, Serialize};

use super::Ledger;
use super::sum::Sum;
use super::work::NodalWork;
use crate::ranks::Ranked;

/// Saved state of the energy ledger.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SavedLedger {
    by_set: bool,
    /// Name, initial energy (J) and largest hourglass work of each element set.
    sets: Vec<(String, f64, HourglassShare)>,
    /// Work of each block, by its global number.
    work_of_block: Vec<(u32, Sum)>,
    ranges: Vec<SavedRange>,
    origin: Option<f64>,
    potential: f64,
    scale: f64,
}

/// First engine node of a range, work of the nodal forces in it, that of the constraints (friction, bond, stored, impact, external
/// work), and the sum of their absolute works (J).
type SavedRange = (u32, NodalWork<Sum>, [Sum; 5], f64);

impl Ledger {
    /// State between two steps, when no half of a step is pending, of all ranks on rank 0.
    pub(crate) fn saved(&self, ranks: &Ranked) -> SavedLedger {
        let sets = self.sets.iter();
        let numbers = ranks.block_numbers.iter().copied();
        let own: Vec<(u32, Sum)> = numbers.zip(self.work_of_block.iter().copied()).collect();
        let of_ranges = self.ranges.iter().map(|range| {
            let first = ranks.engine(range.nodes().start) as u32;
            (first, range.all, range.dissipated, range.exchanged)
        });
        let mut work_of_block = ranks.team.all_at_first(&own).concat();
        work_of_block.sort_by_key(|(number, _)| *number);
        let own: Vec<SavedRange> = of_ranges.collect();
        let mut ranges = ranks.team.all_at_first(&own).concat();
        ranges.sort_by_key(|(first, ..)| *first);
        SavedLedger {
            by_set: self.by_set,
            sets: sets
                .map(|set| (set.label.clone(), set.origin, set.hourglass.clone()))
                .collect(),
            work_of_block,
            ranges,
            origin: self.origin,
            potential: self.potential,
            scale: self.scale,
        }
    }

    /// Restores the state of a ledger of an equal model.
    pub(crate) fn restore(
        &mut self,
        saved: &SavedLedger,
        ranks: &Ranked,
    ) -> Result<(), StateError> {
        StateError::expect_same("whether sets are balanced", saved.by_set, self.by_set)?;
        let found: Vec<&str> = saved.sets.iter().map(|set| set.0.as_str()).collect();
        let here: Vec<&str> = self.sets.iter().map(|set| set.label.as_str()).collect();
        StateError::expect_same("the list of element sets", found, here)?;
        if ranks.is_single() {
            let (found, here) = (saved.work_of_block.len(), self.work_of_block.len());
            StateError::expect_same("the number of blocks", found, here)?;
            let (found, here) = (saved.ranges.len(), self.ranges.len());
            StateError::expect_same("the number of node ranges", found, here)?;
        }
        for (set, (_, origin, hourglass)) in self.sets.iter_mut().zip(&saved.sets) {
            (set.origin, set.hourglass) = (*origin, hourglass.clone());
        }
        for (work, number) in self.work_of_block.iter_mut().zip(&ranks.block_numbers) {
            let of_block = &saved.work_of_block;
            let found = of_block.binary_search_by_key(number, |(number, _)| *number);
            *work = of_block[found.map_err(|_| StateError::Missing)?].1;
        }
        for range in &mut self.ranges {
            let first = ranks.engine(range.nodes().start) as u32;
            let found = (saved.ranges).binary_search_by_key(&first, |(first, ..)| *first);
            let (_, all, dissipated, exchanged) =
                saved.ranges[found.map_err(|_| StateError::Missing)?];
            (range.all, range.dissipated, range.exchanged) = (all, dissipated, exchanged);
        }
        (self.origin, self.potential, self.scale) = (saved.origin, saved.potential, saved.scale);
        Ok(())
    }
}
