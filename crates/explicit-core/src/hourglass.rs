//! Hourglass energies of the element sets of a model.

use powerhouse_model::HourglassShare;

use crate::Model;
use crate::ledger::total_energy;

impl Model {
    /// Stored hourglass and internal energy of each set at the present time.
    pub fn hourglass_shares(&self) -> Vec<HourglassShare> {
        let of_blocks = self.block_energies(0.0, false);
        let shares = self.ranks.sets.iter().map(|set| {
            let blocks = self.blocks.iter().zip(&of_blocks);
            let own = blocks.filter(|(block, _)| block.label() == set);
            let energy = total_energy(own.map(|(_, energy)| energy), &self.ranks.team);
            let mut share = HourglassShare {
                set: set.clone(),
                ..HourglassShare::default()
            };
            let stored = energy.elastic.abs() + energy.bending;
            share.update(energy.hourglass, stored + energy.hourglass);
            share
        });
        HourglassShare::above_rounding(shares)
    }
}
