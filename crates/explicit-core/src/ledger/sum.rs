//! Sums over the steps, and exact sums of them over the body.

use powerhouse_model::BlockEnergy;
use serde::{Deserialize, Serialize};

use crate::exact::ExactSum;

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
    pub(super) fn total(self) -> f64 {
        self.value + self.lost
    }

    /// The total of several sums, the same bits in any order.
    pub(super) fn total_of(sums: impl Iterator<Item = Self>) -> f64 {
        total(sums.flat_map(|sum| [sum.value, sum.lost]))
    }
}

/// The sum of terms, the same bits in any order.
pub(super) fn total(terms: impl Iterator<Item = f64>) -> f64 {
    terms.collect::<ExactSum>().round()
}

/// The sum of the energies of blocks, the same bits in any order.
pub(crate) fn total_energy<'a>(
    blocks: impl Iterator<Item = &'a BlockEnergy> + Clone,
) -> BlockEnergy {
    let sum = |column: fn(&BlockEnergy) -> f64| total(blocks.clone().map(column));
    let mut all = BlockEnergy::default();
    all.elastic = sum(|energy| energy.elastic);
    all.hourglass = sum(|energy| energy.hourglass);
    all.plastic = sum(|energy| energy.plastic);
    all.damage = sum(|energy| energy.damage);
    all.recovery = sum(|energy| energy.recovery);
    all.integration = sum(|energy| energy.integration);
    all.damping = sum(|energy| energy.damping);
    all.relaxation = sum(|energy| energy.relaxation);
    all
}
