//! Sums over the steps, and exact sums of them over the body.

use powerhouse_model::BlockEnergy;
use serde::{Deserialize, Serialize};

use crate::exact::ExactSum;
use crate::ranks::Communicator;

/// A compensated sum, accurate for terms of very different size (Neumaier 1974).
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Sum {
    value: f64,
    lost: f64,
}

impl Sum {
    pub(super) fn add(&mut self, term: f64) {
        let sum = self.value + term;
        self.lost += if self.value.abs() >= term.abs() {
            (self.value - sum) + term
        } else {
            (term - sum) + self.value
        };
        self.value = sum;
    }

    /// The exact sum of several sums.
    pub(super) fn exact(sums: impl Iterator<Item = Self>) -> ExactSum {
        sums.flat_map(|sum| [sum.value, sum.lost]).collect()
    }
}

/// The sum of the energies of blocks, those of other ranks included, the same bits in any order.
pub(crate) fn total_energy<'a>(
    blocks: impl Iterator<Item = &'a BlockEnergy> + Clone,
    team: &Communicator,
) -> BlockEnergy {
    let sum = |column: fn(&BlockEnergy) -> f64| blocks.clone().map(column).collect();
    let mut all = BlockEnergy::default();
    [
        all.elastic,
        all.hourglass,
        all.bending,
        all.plastic,
        all.damage,
        all.recovery,
        all.integration,
        all.damping,
        all.relaxation,
    ] = team.totals([
        sum(|energy| energy.elastic),
        sum(|energy| energy.hourglass),
        sum(|energy| energy.bending),
        sum(|energy| energy.plastic),
        sum(|energy| energy.damage),
        sum(|energy| energy.recovery),
        sum(|energy| energy.integration),
        sum(|energy| energy.damping),
        sum(|energy| energy.relaxation),
    ]);
    all
}
