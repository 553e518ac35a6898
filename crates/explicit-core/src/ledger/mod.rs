//! The energy ledger (energy balance of a run): energy stored and dissipated in elements, dissipated at nodes, and
//! external work.

mod saved;
mod sum;
mod work;

use core::ops::Range;
use std::collections::BTreeMap;

use powerhouse_model::{
    BlockContext, BlockEnergy, DividedWork, HourglassShare, MassDampingRule, NodalView, Precision,
    Vec3,
};
use rayon::prelude::*;

use crate::Model;
use crate::bay::BayEnergy;
use crate::delayed::DelayedWork;
use crate::groups::Groups;
use crate::nodes::{Nodes, with_nodes};
use crate::ranks::Communicator;
use sum::Sum;
use work::{MidStep, NodalWork, RangeWork};

pub(crate) use saved::SavedLedger;
pub(crate) use sum::total_energy;

/// Factor between the reference energy of the residual and the energy lost to underflow in single precision.
const FAR_ABOVE: f64 = 1.0e8;
/// Rounding errors of the nodal arithmetic that sums of works may contain, as a multiple of one.
const MOST_ROUNDED: f64 = 64.0;

/// Energy balance of one element set.
#[derive(Clone, Debug, Default)]
struct SetBalance {
    label: String,
    /// Energy of its elements when the ledger was opened (J).
    origin: f64,
    /// Largest hourglass work over the readings.
    hourglass: HourglassShare,
}

/// Energy balance of a run from its first step on.
///
/// At the time of the displacement the scheme conserves `1/2 v- . M v+` with the velocities half a step
/// before and after. Kinetic energy is output with their mean, never negative; the difference to the conserved form,
/// `-1/8 (v+ - v-) . M (v+ - v-)`, is the column "time step", which falls with the square of the step. Of
/// added masses, and of the inertia that fibres add, columns of their own have the energy at the mean velocity. The work of a
/// nodal force at time `t` is half with the velocity before, half with that after `t`; the energy of elements
/// follows from their stresses and strains. All columns then add up to a constant, to rounding.
/// Sums over the steps are kept for each block, each range of nodes and each constraint; at a reading they are added
/// exactly, so that the order of the blocks has no influence.
/// The work of a constant load is its product with the displacement since the ledger was opened, which is computed
/// on demand.
///
/// Great forces in equilibrium with each other, as of a joint under the weight of the ground, do works on both sides that
/// cancel but for their rounding. The residual counts where it is above that: `MOST_ROUNDED` rounding errors of the sum of
/// the absolute works of constraints and constant loads. For a limit below `MOST_ROUNDED` rounding errors all of it counts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ledger {
    /// Index of the element set of each block.
    set_of_block: Vec<usize>,
    sets: Vec<SetBalance>,
    by_set: bool,
    /// Work of the motion against the nodal forces of each block (J).
    work_of_block: Vec<Sum>,
    ranges: Vec<RangeWork>,
    /// Index of the range of each group.
    range_of_group: Vec<u32>,
    /// Whether each constraint has nodes with prescribed motion, those of other ranks included.
    prescribed: Vec<bool>,
    /// Kinetic and internal energy when the ledger was opened (J).
    origin: Option<f64>,
    /// Product of the constant loads with the displacement when the ledger was opened (J).
    potential: f64,
    /// Whether the first half of the present step has been recorded.
    first_half_recorded: bool,
    /// Reference of the residual: largest stored energy or external work so far (J), with a lower bound in single
    /// precision.
    scale: f64,
    /// Rounding error of the nodal arithmetic (1).
    rounding: f64,
}

/// A reading of the energy ledger at one time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reading {
    pub(crate) columns: Vec<(&'static str, f64)>,
    /// Residual beyond the rounding of works that cancel, over the largest stored energy or external work so far.
    pub(crate) residual: f64,
    /// The element set with the largest share of the residual.
    pub(crate) worst_set: String,
    /// Hourglass and internal work of each element set until then.
    pub(crate) hourglass: Vec<HourglassShare>,
    /// Kinetic energy of the added inertia of fibres, and of their masses (J).
    pub(crate) fibres: [f64; 2],
}

impl Model {
    /// Opens a ledger; with `by_set` each element set has its own balance, which identifies the set of an error.
    pub(crate) fn open_ledger(&mut self, by_set: bool) {
        let scale = match self.precision {
            Precision::F64 => 0.0,
            _ => self.least_single_energy(),
        };
        let (ranges, range_of_group) = self.range_work();
        let prescribed = self.prescribed_constraints();
        let mut ledger = Ledger {
            by_set,
            scale,
            rounding: match self.nodes {
                Nodes::F64(_) => f64::EPSILON,
                _ => f32::EPSILON.into(),
            },
            ranges,
            range_of_group,
            prescribed,
            work_of_block: vec![Sum::default(); self.blocks.len()],
            ..Ledger::default()
        };
        let sets = self.ranks.sets.iter();
        let set_of_label: BTreeMap<&str, usize> = sets.map(String::as_str).zip(0..).collect();
        let labels = self.blocks.iter().map(|block| block.label());
        ledger.set_of_block = (labels.filter_map(|label| set_of_label.get(label)))
            .copied()
            .collect();
        for label in &self.ranks.sets {
            ledger.sets.push(SetBalance {
                label: label.clone(),
                hourglass: HourglassShare {
                    set: label.clone(),
                    ..HourglassShare::default()
                },
                ..SetBalance::default()
            });
        }
        self.ledger = Some(Box::new(ledger));
    }

    /// Whether each constraint has nodes with prescribed motion on any rank.
    fn prescribed_constraints(&self) -> Vec<bool> {
        let prescribed = &self.groups.prescribed;
        let own = self.constraints.iter().map(|bound| {
            let own = bound.groups();
            prescribed
                .iter()
                .any(|&group| own.contains(&(group as usize)))
        });
        self.ranks.of_constraints(&own.collect::<Vec<bool>>())
    }

    /// Lower bound of the reference energy (J) in single precision, far above the energy that elements lose by
    /// underflow; motions with less energy are not checked.
    fn least_single_energy(&self) -> f64 {
        let (low, high) = self.mesh.bounding_box();
        let elements = self.mesh.element_count() as f64;
        FAR_ABOVE * f64::from(f32::MIN_POSITIVE) * (elements + (high - low).product())
    }

    pub(crate) fn close_ledger(&mut self) {
        if let Some(slice) = &mut self.delayed {
            slice.work = DelayedWork::default();
        }
        self.ledger = None;
    }

    /// Records the first half of the work of the present nodal forces, between kick and drift; once
    /// per step.
    pub(crate) fn record_first_half(&mut self, step: f64) {
        let begins = |ledger: &Ledger| ledger.origin.is_none();
        let mut of_bay = None;
        if self.ledger.as_deref().is_some_and(begins) {
            of_bay = self.bay_energy(step);
        }
        let Some(mut ledger) = self.ledger.take() else {
            return;
        };
        if !ledger.first_half_recorded {
            ledger.first_half_recorded = true;
            let present = self.present(step);
            let begins = ledger.origin.is_none();
            ledger.ranges.par_iter_mut().for_each(|range| {
                let [mut first, second] = present.work(range);
                range.second = second;
                if !begins {
                    first.loads = present.load_work(range);
                    range.all.add(&first);
                }
            });
            if begins {
                // The balance begins at the present time.
                let energies = self.block_energies(step, true);
                let of_sets = ledger.set_energies(&energies, present.team);
                for (set, energy) in ledger.sets.iter_mut().zip(&of_sets) {
                    set.origin = energy.total();
                }
                let internal = total_energy(energies.iter(), present.team).total();
                let [kinetic, _] = present.kinetic(&ledger.ranges);
                let [of_added, _] = present.kinetic_of_added(&ledger.ranges);
                let [of_fibres, ..] = present.kinetic_of_fibres();
                // Constraints report whole steps, of which the first half precedes the balance.
                let of_constraints = ledger.constraint_work(0, present.team);
                let flux = of_bay.map_or(0.0, |energy| energy.flux + energy.lent);
                let body = kinetic + of_added + of_fibres + internal + flux;
                ledger.origin = Some(body - of_constraints);
                ledger.potential = present.load_potential(&ledger.ranges);
            } else {
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
        let present = self.present(step);
        (ledger.ranges.par_iter_mut()).for_each(|range| range.complete(present.load_work(range)));
        self.record_sets(&mut ledger, step);
        ledger.first_half_recorded = false;
        self.ledger = Some(ledger);
    }

    /// Adds half a step's work against the forces of each block.
    fn record_sets(&self, ledger: &mut Ledger, step: f64) {
        if !ledger.by_set {
            return;
        }
        let work: Vec<f64> = with_nodes!(&self.nodes, arrays => {
            let subdomain = &self.subdomain;
            (0..self.blocks.len())
                .into_par_iter()
                .map(|block| {
                    let nodes = subdomain.nodes_of(block).iter();
                    let forces = subdomain.forces_of(block, &arrays.forces);
                    let power = nodes.zip(forces).map(|(&node, force)| {
                        force.to_vector().dot(&arrays.velocity[node as usize].to_vector())
                    });
                    power.sum::<f64>() * 0.5 * step
                })
                .collect()
        });
        for (sum, work) in ledger.work_of_block.iter_mut().zip(work) {
            sum.add(work);
        }
    }

    /// Energies (J) of each block at the present displacement; with `ledger` in a model with an energy ledger.
    pub(crate) fn block_energies(&self, step: f64, ledger: bool) -> Vec<BlockEnergy> {
        let when = self.present_step(step);
        let (nodes, subdomain, slice) = (&self.nodes, &self.subdomain, self.delayed.as_ref());
        let mut of_bay = self.displacements_of_bay();
        of_bay.resize(self.blocks.len(), None);
        (self.blocks.par_iter().zip(of_bay).enumerate())
            .map(|(index, (block, of_bay))| {
                let displacement = match (slice, of_bay) {
                    (Some(slice), _) => slice.displacement_of_block(subdomain, nodes, index),
                    (_, Some(delayed)) => delayed,
                    _ => with_nodes!(nodes, arrays => {
                        subdomain.values(index, &arrays.displacement)
                    }),
                };
                let velocity = NodalView::F64(&[]);
                let context = BlockContext::new(when, NodalView::F64(&displacement), velocity);
                block.energy(&context.with_ledger(ledger))
            })
            .collect()
    }

    /// Reads the ledger between kick and drift, for a residual with a limit (1); none if no ledger is open.
    pub(crate) fn read_ledger(&mut self, step: f64, limit: f64) -> Option<Reading> {
        if self.delayed.is_some() {
            return self.read_slice_ledger(step);
        }
        self.record_first_half(step);
        let of_bay = self.bay_energy(step);
        let mut ledger = self.ledger.take()?;
        let energies = self.block_energies(step, true);
        let present = self.present(step);
        let reading = ledger.read(&present, (&energies, of_bay), limit);
        self.ledger = Some(ledger);
        Some(reading)
    }
}

impl Ledger {
    /// Records the work of a constraint on its groups, from the predicted velocities (m/s) before the correction, and
    /// the energies that it reports, in the ranges of its nodes.
    pub(crate) fn record_constraint(
        &mut self,
        groups: &Groups,
        (rule, step): (MassDampingRule, f64),
        (index, own): (usize, Range<usize>),
        predicted: &[Vec3],
        report: DividedWork,
    ) {
        let is_prescribed = self.prescribed.get(index) == Some(&true);
        for (&node, work) in report.nodes.iter().zip(report.work) {
            let range = self.range_of_group[own.start + node as usize];
            let Some(range) = self.ranges.get_mut(range as usize) else {
                continue;
            };
            range.reported += *work;
            if is_prescribed {
                range.prescribed +=
                    work.friction + work.bond + work.stored + work.impact + work.external;
            }
        }
        for (g, before) in own.zip(predicted) {
            let after = groups.motion.next[g];
            let impulse = groups.correction(g, (rule, step), &(after - before));
            let halves = [groups.motion.previous[g], after].map(|v| 0.5 * impulse.dot(&v));
            let Some(range) = self.ranges.get_mut(self.range_of_group[g] as usize) else {
                continue;
            };
            range.constraints[0] += halves[0];
            range.constraints[1] += halves[1];
            let speeds = groups.motion.previous[g].abs() + after.abs();
            range.exchanged += 0.5 * impulse.abs().dot(&speeds);
            if is_prescribed {
                range.prescribed += halves[0] + halves[1];
            }
        }
    }

    /// Energies of the elements of each set from those of the blocks.
    fn set_energies(&self, blocks: &[BlockEnergy], team: &Communicator) -> Vec<BlockEnergy> {
        let of_set = |set| {
            let own = self.set_of_block.iter().zip(blocks);
            let own = own.filter(|(other, _)| **other == set);
            total_energy(own.map(|(_, energy)| energy), team)
        };
        (0..self.sets.len()).map(of_set).collect()
    }

    /// Work (J) of the constraints on the body in a half of the present step.
    fn constraint_work(&self, half: usize, team: &Communicator) -> f64 {
        team.total(self.ranges.iter().map(|range| range.constraints[half]))
    }

    /// Nodal work of all steps (J).
    fn nodal_work(&self, team: &Communicator) -> NodalWork<f64> {
        let sums = |column: fn(&NodalWork<Sum>) -> Sum| {
            self.ranges.iter().map(move |range| column(&range.all))
        };
        let [mass_damping, dashpots, springs, loads, prescribed] = team.totals([
            Sum::exact(sums(|work| work.mass_damping)),
            Sum::exact(sums(|work| work.dashpots)),
            Sum::exact(sums(|work| work.springs)),
            Sum::exact(sums(|work| work.loads)),
            Sum::exact(sums(|work| work.prescribed)),
        ]);
        NodalWork {
            mass_damping,
            dashpots,
            springs,
            loads,
            prescribed,
        }
    }

    /// Energies that the constraints reported in all steps (J): friction, bond, stored by bonds, impact, external work.
    fn reported_energies(&self, team: &Communicator) -> [f64; 5] {
        let sum = |i: usize| Sum::exact(self.ranges.iter().map(|range| range.dissipated[i]));
        team.totals([sum(0), sum(1), sum(2), sum(3), sum(4)])
    }

    fn read(
        &mut self,
        present: &MidStep,
        (energies, of_bay): (&[BlockEnergy], Option<BayEnergy>),
        limit: f64,
    ) -> Reading {
        let team = present.team;
        let sum = total_energy(energies.iter(), team);
        let energies = &self.set_energies(energies, team)[..];
        let of_mass = present.kinetic(&self.ranges);
        let of_fibres = present.kinetic_of_fibres();
        let of_added = present.kinetic_of_added(&self.ranges);
        let BayEnergy { flux, less, lent } = of_bay.unwrap_or_default();
        let kinetic = of_mass[0] + of_added[0] + of_fibres[0] + flux + lent;
        let nodal = self.nodal_work(team);
        let [friction, bond, stored, impact, external] = self.reported_energies(team);
        let loads = nodal.loads + present.load_potential(&self.ranges) - self.potential;
        let initial = self.origin.unwrap_or(0.0);
        let of_step = team.total(self.ranges.iter().map(|range| range.prescribed));
        let pending = 0.5 * of_step - self.constraint_work(0, team);
        let prescribed = nodal.prescribed + 0.5 * of_step;
        let spent = [
            ("kinetic", of_mass[0] + of_mass[1] + less),
            ("time step", lent - of_mass[1] - of_added[1] - of_fibres[1]),
            ("elastic", sum.elastic + stored),
            ("bending", sum.bending),
            ("hourglass", sum.hourglass),
            ("plastic", sum.plastic),
            ("damage", sum.damage),
            ("recovery", sum.recovery),
            ("integration", sum.integration),
            ("relaxation", sum.relaxation),
            ("stiffness damping", sum.damping),
            ("mass damping", nodal.mass_damping),
            ("dashpots", nodal.dashpots),
            ("springs", nodal.springs),
            ("friction", friction),
            ("bond", bond),
            ("impact", impact),
            ("constraints", external + pending),
        ];
        let input = loads + prescribed;
        // The first two columns, and those of added masses and fibres, add up to the kinetic energy of the scheme.
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
        let exchanged = team.total(self.ranges.iter().map(|range| range.exchanged));
        let cancelled = exchanged + present.load_exchange(&self.ranges);
        // A limit below rounding is taken at its word.
        let rounding = match MOST_ROUNDED * self.rounding {
            of_one if limit < of_one => 0.0,
            of_one => of_one * cancelled,
        };
        // NaN counts as a residual.
        let beyond = if residual.abs() <= rounding {
            0.0
        } else {
            residual - rounding.copysign(residual)
        };
        let mut columns = spent.to_vec();
        if of_bay.is_some() {
            columns.insert(1, ("delay", of_added[0] + of_added[1] - less + flux));
        } else if present.has_added_masses {
            columns.insert(1, ("added mass", of_added[0] + of_added[1]));
        }
        if present.has_fibres() {
            columns.insert(1, ("added inertia", of_fibres[0] + of_fibres[1]));
        }
        columns.extend([
            ("initial", initial),
            ("loads", loads),
            ("prescribed motion", prescribed),
            ("residual", residual),
        ]);
        Reading {
            columns,
            residual: if self.scale > 0.0 {
                beyond / self.scale
            } else {
                beyond
            },
            worst_set: self.worst_set(energies, team),
            hourglass,
            fibres: [of_fibres[0] + of_fibres[1], of_fibres[2]],
        }
    }

    /// The element set whose nodal work and element energy differ most; without balances by set, the set
    /// whose energy changed most.
    fn worst_set(&self, energies: &[BlockEnergy], team: &Communicator) -> String {
        let work = |set: usize| {
            let own = self.set_of_block.iter().zip(&self.work_of_block);
            let own = own.filter(|(other, _)| **other == set);
            let [work] = team.totals([Sum::exact(own.map(|(_, work)| *work))]);
            work
        };
        let gap = |set: usize| {
            let gained = energies[set].total() - self.sets[set].origin;
            let gap = if self.by_set {
                work(set) - gained
            } else {
                gained
            };
            gap.abs()
        };
        let gaps = (0..self.sets.len()).map(|set| (set, gap(set)));
        let worst = gaps.max_by(|a, b| a.1.total_cmp(&b.1));
        worst.map_or_else(String::new, |(set, _)| self.sets[set].label.clone())
    }
}
