//! What hourglass resistance takes of the internal work of a set.

use powerhouse_model::{BlockContext, BlockEnergy, StepTime};

use crate::Model;
use crate::nodes::{Storage, with_nodes};

/// Below this share of the largest internal work of all sets, the work of a set is rounding.
const NOTHING: f64 = 1.0e-9;

/// The work of hourglass resistance in a set of elements, beside the internal work.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HourglassShare {
    /// The set.
    pub set: String,
    /// Largest work of hourglass resistance (J), held or taken.
    pub hourglass: f64,
    /// Largest internal work (J), hourglass included: of a run all that elements hold and take, of a
    /// stage what they hold.
    pub internal: f64,
}

impl HourglassShare {
    /// Above this share displacements and stresses of a set are the hourglass resistance's as much as
    /// the material's.
    ///
    /// Around a hole in associated rock of 42 degrees, meshed to twenty radii, the wall closes to less than half
    /// where the share of the whole ring is 1.5 %: far elements hold most of the work.
    pub const LIMIT: f64 = 0.01;

    /// The one over the other.
    pub fn share(&self) -> f64 {
        if self.internal > 0.0 {
            self.hourglass / self.internal
        } else {
            0.0
        }
    }

    /// Takes the energies (J) of the set at another time.
    pub(crate) fn see(&mut self, hourglass: f64, internal: f64) {
        self.hourglass = self.hourglass.max(hourglass.abs());
        self.internal = self.internal.max(internal.abs()).max(self.hourglass);
    }

    /// Those whose work is more than rounding.
    pub(crate) fn above_rounding(sets: impl Iterator<Item = Self>) -> Vec<Self> {
        let sets: Vec<Self> = sets.collect();
        let most = sets
            .iter()
            .fold(0.0_f64, |most, set| most.max(set.internal));
        let counts = |set: &Self| set.internal > NOTHING * most;
        sets.into_iter().filter(counts).collect()
    }
}

impl Model {
    /// What hourglass resistance holds in each set at the present time.
    pub(crate) fn hourglass_shares(&self) -> Vec<HourglassShare> {
        let of_blocks: Vec<BlockEnergy> = with_nodes!(&self.nodes, arrays => {
            let when = StepTime {
                number: self.number,
                time: self.time,
                step: 0.0,
            };
            let context = BlockContext::new(
                when,
                Storage::view(&arrays.displacement),
                Storage::view(&arrays.velocity),
            );
            self.blocks.iter().map(|block| block.energy(&context)).collect()
        });
        let mut sums: Vec<(&str, BlockEnergy)> = Vec::new();
        for (block, energy) in self.blocks.iter().zip(of_blocks) {
            match sums.iter_mut().find(|(label, _)| *label == block.label()) {
                Some((_, sum)) => *sum += energy,
                None => sums.push((block.label(), energy)),
            }
        }
        let shares = sums.into_iter().map(|(label, energy)| {
            let mut share = HourglassShare {
                set: label.into(),
                ..HourglassShare::default()
            };
            share.see(energy.hourglass, energy.elastic.abs() + energy.hourglass);
            share
        });
        HourglassShare::above_rounding(shares)
    }
}
