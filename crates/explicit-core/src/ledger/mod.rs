//! The energy ledger: what the elements hold and lose, what the nodes lose, what came in.

mod sum;
mod work;

use core::ops::Range;
use std::collections::BTreeMap;

use powerhouse_model::{
    BlockContext, BlockEnergy, ConstraintWork, MassDampingRule, StepTime, Vec3,
};
use rayon::prelude::*;

use crate::groups::Groups;
use crate::nodes::{Storage, with_nodes};
use crate::{HourglassShare, Model, Precision};
use sum::Sum;
use work::{NodalWork, Present};

/// Over what is lost, so that it is no residual.
const FAR_ABOVE: f64 = 1.0e8;

/// What the constraints reported, and what they really did in the present step.
#[derive(Clone, Debug, Default)]
struct ConstraintAccount {
    friction: Sum,
    bond: Sum,
    impact: Sum,
    external: Sum,
    /// Work of the constraints on the body in the halves of the present step (J).
    halves: [f64; 2],
    /// What they reported for the present step.
    reported: ConstraintWork,
    /// The part of it that belongs to prescribed motions.
    driven: f64,
}

/// One set's balance.
#[derive(Clone, Debug, Default)]
struct SetBalance {
    label: String,
    /// Work of the motion against the set's nodal forces (J).
    work: Sum,
    /// Energy of its elements when the ledger was opened (J).
    origin: f64,
    /// What hourglass resistance took at most, as far as the ledger was read.
    hourglass: HourglassShare,
}

/// The account of a run from its first step on.
///
/// At the time of the displacement the scheme conserves `1/2 v- . M v+` with the velocities half a step
/// before and after. Kinetic energy is shown with their mean, never negative; what the scheme's own form
/// has less, `1/8 (v+ - v-) . M (v+ - v-)`, stands in the column "time step", not positive: it falls with
/// the square of the step. A nodal force `F` of time
/// `t` works half with the velocity before, half with that after `t`; the energy of elements is
/// what their own stresses and strains give. All columns then add up to a constant, to rounding.
/// Those halves of a force that does not change add up to its product with the displacement since the
/// ledger was opened, which is all that is ever computed of constant loads.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ledger {
    /// Which set each block belongs to.
    set_of_block: Vec<usize>,
    sets: Vec<SetBalance>,
    by_set: bool,
    nodal: NodalWork<Sum>,
    constraints: ConstraintAccount,
    /// Second halves of the present step's work.
    second: NodalWork<f64>,
    /// Kinetic and internal energy when the ledger was opened (J).
    origin: Option<f64>,
    /// What the constant loads would have done over the displacement of that time (J).
    potential: f64,
    /// Whether the first half of the present step is booked.
    half_booked: bool,
    /// The largest energy held or put in so far (J), or what counts as one.
    scale: f64,
}

/// What the ledger says at a time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reading {
    pub(crate) columns: Vec<(&'static str, f64)>,
    /// Residual over the largest energy held or put in so far.
    pub(crate) residual: f64,
    /// The set with the largest share of it.
    pub(crate) worst_set: String,
    /// What hourglass resistance took of each set until then.
    pub(crate) hourglass: Vec<HourglassShare>,
}

impl Model {
    /// Opens a ledger; `by_set` keeps a balance for each set, so that a fault names its set.
    pub(crate) fn open_ledger(&mut self, by_set: bool) {
        let mut places: BTreeMap<&str, usize> = BTreeMap::new();
        let scale = match self.precision {
            Precision::F64 => 0.0,
            _ => self.least_single_energy(),
        };
        let mut ledger = Ledger {
            by_set,
            scale,
            ..Ledger::default()
        };
        for block in &self.blocks {
            let next = places.len();
            let set = *places.entry(block.label()).or_insert(next);
            if set == next {
                ledger.sets.push(SetBalance {
                    label: block.label().into(),
                    hourglass: HourglassShare {
                        set: block.label().into(),
                        ..HourglassShare::default()
                    },
                    ..SetBalance::default()
                });
            }
            ledger.set_of_block.push(set);
        }
        self.ledger = Some(Box::new(ledger));
    }

    /// An energy (J) far above what elements lose whose energy, or whose density of it, is below the
    /// numbers of single precision: of motions with less the balance says nothing.
    fn least_single_energy(&self) -> f64 {
        let (low, high) = self.mesh.bounding_box();
        let elements = self.mesh.element_count() as f64;
        FAR_ABOVE * f64::from(f32::MIN_POSITIVE) * (elements + (high - low).product())
    }

    pub(crate) fn close_ledger(&mut self) {
        self.ledger = None;
    }

    /// Accounts for the first half of the work of the present nodal forces, between kick and drift; once
    /// per step.
    pub(crate) fn book_first_half(&mut self, step: f64) {
        let Some(mut ledger) = self.ledger.take() else {
            return;
        };
        if !ledger.half_booked {
            ledger.half_booked = true;
            let present = self.present(step);
            let [mut first, second] = present.work();
            first.loads = present.load_work();
            ledger.second = second;
            if ledger.origin.is_none() {
                // The account begins at the present time: what came before it is not booked.
                let energies = self.set_energies(&ledger, step);
                for (set, energy) in ledger.sets.iter_mut().zip(&energies) {
                    set.origin = energy.total();
                }
                let internal: f64 = energies.iter().map(BlockEnergy::total).sum();
                // Constraints report whole steps, of which the first half came before.
                let present = self.present(step);
                ledger.origin = Some(present.kinetic() + internal - ledger.constraints.halves[0]);
                ledger.potential = present.load_potential();
            } else {
                ledger.nodal.add(&first);
                self.book_sets(&mut ledger, step);
            }
        }
        self.ledger = Some(ledger);
    }

    /// Accounts for the second half, after the drift.
    pub(crate) fn book_second_half(&mut self, step: f64) {
        let Some(mut ledger) = self.ledger.take() else {
            return;
        };
        let mut second = ledger.second;
        second.loads = self.present(step).load_work();
        second.prescribed += ledger.constraints.driven;
        ledger.nodal.add(&second);
        let account = &mut ledger.constraints;
        account.friction.add(account.reported.friction);
        account.bond.add(account.reported.bond);
        account.impact.add(account.reported.impact);
        account.external.add(account.reported.external);
        (account.reported, account.halves, account.driven) = Default::default();
        self.book_sets(&mut ledger, step);
        ledger.half_booked = false;
        self.ledger = Some(ledger);
    }

    /// Half a step's work against the forces of each block, added to its set.
    fn book_sets(&self, ledger: &mut Ledger, step: f64) {
        if !ledger.by_set {
            return;
        }
        let work: Vec<f64> = with_nodes!(&self.nodes, arrays => {
            let mut start = 0;
            let buffers: Vec<_> = (self.blocks.iter().zip(&self.lengths))
                .map(|(block, &length)| {
                    let buffer = &arrays.forces[start..start + length];
                    start += length;
                    (block, buffer)
                })
                .collect();
            buffers
                .par_iter()
                .map(|(block, buffer)| {
                    let power = block.nodes().iter().zip(*buffer).map(|(&node, force)| {
                        force.to_vector().dot(&arrays.velocity[node as usize].to_vector())
                    });
                    power.sum::<f64>() * 0.5 * step
                })
                .collect()
        });
        for (&set, work) in ledger.set_of_block.iter().zip(work) {
            ledger.sets[set].work.add(work);
        }
    }

    /// Energies of the elements of each set at the present time.
    fn set_energies(&self, ledger: &Ledger, step: f64) -> Vec<BlockEnergy> {
        let of_blocks: Vec<BlockEnergy> = with_nodes!(&self.nodes, arrays => {
            let when = StepTime {
                number: self.number,
                time: self.time,
                step,
            };
            let context = BlockContext::new(
                when,
                Storage::view(&arrays.displacement),
                Storage::view(&arrays.velocity),
            )
            .with_ledger(true);
            self.blocks.par_iter().map(|block| block.energy(&context)).collect()
        });
        let mut of_sets = vec![BlockEnergy::default(); ledger.sets.len()];
        for (&set, energy) in ledger.set_of_block.iter().zip(of_blocks) {
            of_sets[set] += energy;
        }
        of_sets
    }

    /// Reads the ledger between kick and drift; nothing if none is open.
    pub(crate) fn read_ledger(&mut self, step: f64) -> Option<Reading> {
        self.book_first_half(step);
        let mut ledger = self.ledger.take()?;
        let energies = self.set_energies(&ledger, step);
        let reading = ledger.read(&self.present(step), &energies);
        self.ledger = Some(ledger);
        Some(reading)
    }
}

impl Ledger {
    /// Accounts for what a constraint did to its groups: predicted velocities (m/s) before, and its own
    /// report.
    pub(crate) fn book_constraint(
        &mut self,
        groups: &Groups,
        (rule, step): (MassDampingRule, f64),
        own: Range<usize>,
        predicted: &[Vec3],
        report: ConstraintWork,
    ) {
        let account = &mut self.constraints;
        let (mut halves, mut driven) = ([0.0; 2], false);
        for (g, before) in own.zip(predicted) {
            let after = groups.motion.next[g];
            let impulse = match groups.bare_mass(g) {
                Some(mass) => (after - before) * mass,
                None => {
                    let group = &groups.groups[g];
                    driven |= !group.condition.prescribed.is_empty();
                    group.correction((rule, step), &(after - before))
                }
            };
            halves[0] += 0.5 * impulse.dot(&groups.motion.previous[g]);
            halves[1] += 0.5 * impulse.dot(&after);
        }
        account.halves[0] += halves[0];
        account.halves[1] += halves[1];
        account.reported.friction += report.friction;
        account.reported.bond += report.bond;
        account.reported.impact += report.impact;
        account.reported.external += report.external;
        if driven {
            let lost = report.friction + report.bond + report.impact + report.external;
            account.driven += lost + halves[0] + halves[1];
        }
    }

    fn read(&mut self, present: &Present, energies: &[BlockEnergy]) -> Reading {
        let mut sum = BlockEnergy::default();
        for energy in energies {
            sum += *energy;
        }
        let (kinetic, loads) = (
            present.kinetic(),
            self.nodal.loads.total() + present.load_potential() - self.potential,
        );
        let apart = present.apart();
        let (nodal, constraints) = (&self.nodal, &self.constraints);
        let initial = self.origin.unwrap_or(0.0);
        let pending = -constraints.halves[0] + 0.5 * constraints.driven;
        let prescribed = nodal.prescribed.total() + 0.5 * constraints.driven;
        let held = [
            ("kinetic", kinetic + apart),
            ("time step", -apart),
            ("elastic", sum.elastic),
            ("hourglass", sum.hourglass),
            ("plastic", sum.plastic),
            ("damage", sum.damage),
            ("recovery", sum.recovery),
            ("integration", sum.integration),
            ("relaxation", sum.relaxation),
            ("stiffness damping", sum.damping),
            ("mass damping", nodal.mass_damping.total()),
            ("dashpots", nodal.dashpots.total()),
            ("springs", nodal.springs.total()),
            ("friction", constraints.friction.total()),
            ("bond", constraints.bond.total()),
            ("impact", constraints.impact.total()),
            ("constraints", constraints.external.total() + pending),
        ];
        let input = loads + prescribed;
        // Those of the scheme's own form add up as one.
        let rest: f64 = held[2..].iter().map(|(_, energy)| energy).sum();
        let balance = kinetic + rest;
        let residual = balance - input - initial;
        for (set, energy) in self.sets.iter_mut().zip(energies) {
            set.hourglass.see(energy.hourglass, energy.total());
        }
        let shares = self.sets.iter().map(|set| set.hourglass.clone());
        let hourglass = HourglassShare::above_rounding(shares);
        let inside = kinetic.abs() + sum.total().abs();
        self.scale = self.scale.max(inside).max(input.abs());
        let mut columns = held.to_vec();
        columns.extend([
            ("initial", initial),
            ("loads", loads),
            ("prescribed motion", prescribed),
            ("residual", residual),
        ]);
        Reading {
            columns,
            residual: if self.scale > 0.0 {
                residual / self.scale
            } else {
                residual
            },
            worst_set: self.worst_set(energies),
            hourglass,
        }
    }

    /// The set whose nodal work and element energy differ most; without balances by set, the one
    /// whose energy changed most.
    fn worst_set(&self, energies: &[BlockEnergy]) -> String {
        let gap = |(set, energy): &(&SetBalance, &BlockEnergy)| {
            let gained = energy.total() - set.origin;
            let gap = if self.by_set {
                set.work.total() - gained
            } else {
                gained
            };
            gap.abs()
        };
        let worst = self.sets.iter().zip(energies);
        let worst = worst.max_by(|a, b| gap(a).total_cmp(&gap(b)));
        worst.map_or_else(String::new, |(set, _)| set.label.clone())
    }
}
