//! Hourglass energies of the element sets of a model.

use powerhouse_model::{BlockEnergy, HourglassShare};

use crate::Model;
use crate::ledger::total_energy;

impl Model {
    /// Stored hourglass and internal energy of each set at the present time.
    pub fn hourglass_shares(&self) -> Vec<HourglassShare> {
        let of_blocks = self.block_energies(0.0, false);
        let mut sets: Vec<(&str, Vec<BlockEnergy>)> = Vec::new();
        for (block, energy) in self.blocks.iter().zip(of_blocks) {
            match sets.iter_mut().find(|(label, _)| *label == block.label()) {
                Some((_, blocks)) => blocks.push(energy),
                None => sets.push((block.label(), vec![energy])),
            }
        }
        let shares = sets.into_iter().map(|(label, blocks)| {
            let energy = total_energy(blocks.iter());
            let mut share = HourglassShare {
                set: label.into(),
                ..HourglassShare::default()
            };
            share.update(energy.hourglass, energy.elastic.abs() + energy.hourglass);
            share
        });
        HourglassShare::above_rounding(shares)
    }
}
