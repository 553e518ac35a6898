//! Hourglass energies of the element sets of a model.

use powerhouse_model::HourglassShare;

use crate::Model;
use crate::ledger::total_energy;
use crate::model::blocks_by_label;

impl Model {
    /// Stored hourglass and internal energy of each set at the present time.
    pub fn hourglass_shares(&self) -> Vec<HourglassShare> {
        let of_blocks = self.block_energies(0.0, false);
        let sets = blocks_by_label(&self.blocks).into_iter();
        let shares = sets.map(|(label, blocks)| {
            let energy = total_energy(blocks.iter().map(|&block| &of_blocks[block]));
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
