//! The energy ledger (energy balance of a run): energy stored and dissipated in elements, dissipated at nodes, and
//! external work.

mod sum;
mod work;

use core::ops::Range;
use std::collections::BTreeMap;

use powerhouse_model::{
    BlockContext, BlockEnergy, ConstraintWork, MassDampingRule, Precision, StepTime, Vec3,
};
use rayon::prelude::*;

use crate::groups::Groups;
use crate::nodes::{Storage, with_nodes};
use crate::{HourglassShare, Model};
use sum::Sum;
use work::{MidStep, NodalWork};

/// Factor between the reference energy of the residual and the energy lost to underflow in single precision.
const FAR_ABOVE: f64 = 1.0e8;

/// Energies that the constraints reported, and their work in the present step.
#[derive(Clone, Debug, Default)]
struct ConstraintEnergy {
    friction: Sum,
    bond: Sum,
    impact: Sum,
    external: Sum,
    /// Work of the constraints on the body in the halves of the present step (J).
    halves: [f64; 2],
    /// Energies reported for the present step.
    reported: ConstraintWork,
    /// Work (J) of the present step at nodes with prescribed motion.
    prescribed: f64,
}

/// Energy balance of one element set.
#[derive(Clone, Debug, Default)]
struct SetBalance {
    label: String,
    /// Work of the motion against the set's nodal forces (J).
    work: Sum,
    /// Energy of its elements when the ledger was opened (J).
    origin: f64,
    /// Largest hourglass work over the readings.
    hourglass: HourglassShare,
}

/// Energy balance of a run from its first step on.
///
/// At the time of the displacement the scheme conserves `1/2 v- . M v+` with the velocities half a step
/// before and after. Kinetic energy is output with their mean, never negative; the difference to the conserved form,
/// `-1/8 (v+ - v-) . M (v+ - v-)`, is the column "time step", which falls with the square of the step. The work of a
/// nodal force at time `t` is half with the velocity before, half with that after `t`; the energy of elements
/// follows from their stresses and strains. All columns then add up to a constant, to rounding.
/// The work of a constant load is its product with the displacement since the ledger was opened, which is computed
/// on demand.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ledger {
    /// Index of the element set of each block.
    set_of_block: Vec<usize>,
    sets: Vec<SetBalance>,
    by_set: bool,
    nodal: NodalWork<Sum>,
    constraints: ConstraintEnergy,
    /// Second halves of the nodal work of the present step (J).
    second: NodalWork<f64>,
    /// Kinetic and internal energy when the ledger was opened (J).
    origin: Option<f64>,
    /// Product of the constant loads with the displacement when the ledger was opened (J).
    potential: f64,
    /// Whether the first half of the present step has been recorded.
    first_half_recorded: bool,
    /// Reference of the residual: largest stored energy or external work so far (J), with a lower bound in single
    /// precision.
    scale: f64,
}

/// A reading of the energy ledger at one time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reading {
    pub(crate) columns: Vec<(&'static str, f64)>,
    /// Residual over the largest stored energy or external work so far.
    pub(crate) residual: f64,
    /// The element set with the largest share of the residual.
    pub(crate) worst_set: String,
    /// Hourglass and internal work of each element set until then.
    pub(crate) hourglass: Vec<HourglassShare>,
}

impl Model {
    /// Opens a ledger; with `by_set` each element set has its own balance, which identifies the set of an error.
    pub(crate) fn open_ledger(&mut self, by_set: bool) {
        let mut set_of_label: BTreeMap<&str, usize> = BTreeMap::new();
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
            let next = set_of_label.len();
            let set = *set_of_label.entry(block.label()).or_insert(next);
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

    /// Lower bound of the reference energy (J) in single precision, far above the energy that elements lose by
    /// underflow; motions with less energy are not checked.
    fn least_single_energy(&self) -> f64 {
        let (low, high) = self.mesh.bounding_box();
        let elements = self.mesh.element_count() as f64;
        FAR_ABOVE * f64::from(f32::MIN_POSITIVE) * (elements + (high - low).product())
    }

    pub(crate) fn close_ledger(&mut self) {
        self.ledger = None;
    }

    /// Records the first half of the work of the present nodal forces, between kick and drift; once
    /// per step.
    pub(crate) fn record_first_half(&mut self, step: f64) {
        let Some(mut ledger) = self.ledger.take() else {
            return;
        };
        if !ledger.first_half_recorded {
            ledger.first_half_recorded = true;
            let present = self.present(step);
            let [mut first, second] = present.work();
            first.loads = present.load_work();
            ledger.second = second;
            if ledger.origin.is_none() {
                // The balance begins at the present time.
                let energies = self.set_energies(&ledger, step);
                for (set, energy) in ledger.sets.iter_mut().zip(&energies) {
                    set.origin = energy.total();
                }
                let internal: f64 = energies.iter().map(BlockEnergy::total).sum();
                // Constraints report whole steps, of which the first half precedes the balance.
                let present = self.present(step);
                ledger.origin = Some(present.kinetic() + internal - ledger.constraints.halves[0]);
                ledger.potential = present.load_potential();
            } else {
                ledger.nodal.add(&first);
                self.record_sets(&mut ledger, step);
            }
        }
        self.ledger = Some(ledger);
    }

    /// Records the second half of the work, after the drift.
    pub(crate) fn record_second_half(&mut self, step: f64) {
        let Some(mut ledger) = self.ledger.take() else {
            return;
        };
        let mut second = ledger.second;
        second.loads = self.present(step).load_work();
        second.prescribed += ledger.constraints.prescribed;
        ledger.nodal.add(&second);
        let energy = &mut ledger.constraints;
        energy.friction.add(energy.reported.friction);
        energy.bond.add(energy.reported.bond);
        energy.impact.add(energy.reported.impact);
        energy.external.add(energy.reported.external);
        (energy.reported, energy.halves, energy.prescribed) = Default::default();
        self.record_sets(&mut ledger, step);
        ledger.first_half_recorded = false;
        self.ledger = Some(ledger);
    }

    /// Adds half a step's work against the forces of each block to its set.
    fn record_sets(&self, ledger: &mut Ledger, step: f64) {
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

    /// Reads the ledger between kick and drift; none if no ledger is open.
    pub(crate) fn read_ledger(&mut self, step: f64) -> Option<Reading> {
        self.record_first_half(step);
        let mut ledger = self.ledger.take()?;
        let energies = self.set_energies(&ledger, step);
        let reading = ledger.read(&self.present(step), &energies);
        self.ledger = Some(ledger);
        Some(reading)
    }
}

impl Ledger {
    /// Records the work of a constraint on its groups, from the predicted velocities (m/s) before the correction, and
    /// the energies that it reports.
    pub(crate) fn record_constraint(
        &mut self,
        groups: &Groups,
        (rule, step): (MassDampingRule, f64),
        own: Range<usize>,
        predicted: &[Vec3],
        report: ConstraintWork,
    ) {
        let energy = &mut self.constraints;
        let (mut halves, mut prescribed) = ([0.0; 2], false);
        for (g, before) in own.zip(predicted) {
            let after = groups.motion.next[g];
            let impulse = match groups.scalar_mass(g) {
                Some(mass) => (after - before) * mass,
                None => {
                    let group = &groups.groups[g];
                    prescribed |= !group.condition.prescribed.is_empty();
                    group.correction((rule, step), &(after - before))
                }
            };
            halves[0] += 0.5 * impulse.dot(&groups.motion.previous[g]);
            halves[1] += 0.5 * impulse.dot(&after);
        }
        energy.halves[0] += halves[0];
        energy.halves[1] += halves[1];
        energy.reported.friction += report.friction;
        energy.reported.bond += report.bond;
        energy.reported.impact += report.impact;
        energy.reported.external += report.external;
        if prescribed {
            let lost = report.friction + report.bond + report.impact + report.external;
            energy.prescribed += lost + halves[0] + halves[1];
        }
    }

    fn read(&mut self, present: &MidStep, energies: &[BlockEnergy]) -> Reading {
        let mut sum = BlockEnergy::default();
        for energy in energies {
            sum += *energy;
        }
        let (kinetic, loads) = (
            present.kinetic(),
            self.nodal.loads.total() + present.load_potential() - self.potential,
        );
        let difference = present.kinetic_difference();
        let (nodal, constraints) = (&self.nodal, &self.constraints);
        let initial = self.origin.unwrap_or(0.0);
        let pending = -constraints.halves[0] + 0.5 * constraints.prescribed;
        let prescribed = nodal.prescribed.total() + 0.5 * constraints.prescribed;
        let spent = [
            ("kinetic", kinetic + difference),
            ("time step", -difference),
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
        // The first two columns add up to the kinetic energy of the scheme.
        let rest: f64 = spent[2..].iter().map(|(_, energy)| energy).sum();
        let balance = kinetic + rest;
        let residual = balance - input - initial;
        for (set, energy) in self.sets.iter_mut().zip(energies) {
            set.hourglass.update(energy.hourglass, energy.total());
        }
        let shares = self.sets.iter().map(|set| set.hourglass.clone());
        let hourglass = HourglassShare::above_rounding(shares);
        let inside = kinetic.abs() + sum.total().abs();
        self.scale = self.scale.max(inside).max(input.abs());
        let mut columns = spent.to_vec();
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

    /// The element set whose nodal work and element energy differ most; without balances by set, the set
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
