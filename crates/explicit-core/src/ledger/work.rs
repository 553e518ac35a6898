//! Work of nodal forces in a step.

use core::ops::Range;

use powerhouse_model::{ConstraintWork, MassDampingRule, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::sum::Sum;
use crate::Model;
use crate::applied::LoadSums;
use crate::gather::{Gather, SlotTable};
use crate::groups::Groups;
use crate::nodes::{Nodes, with_nodes};
use crate::ranks::Communicator;

/// Work of nodal forces (J): energy dissipated or stored by damping, dashpots and springs, and external work of loads
/// and prescribed motion.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct NodalWork<T> {
    pub(super) mass_damping: T,
    pub(super) dashpots: T,
    pub(super) springs: T,
    pub(super) loads: T,
    pub(super) prescribed: T,
}

impl NodalWork<Sum> {
    pub(super) fn add(&mut self, work: &NodalWork<f64>) {
        self.mass_damping.add(work.mass_damping);
        self.dashpots.add(work.dashpots);
        self.springs.add(work.springs);
        self.loads.add(work.loads);
        self.prescribed.add(work.prescribed);
    }
}

/// Work of the forces at one range of nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct RangeWork {
    nodes: Range<usize>,
    /// The groups, without roller nodes, whose lead node is one of them, in the order of the groups.
    groups: Vec<u32>,
    /// Indices of the time-dependent loads at the nodes, and of the constant ones, in the order of the loads.
    changing: Vec<u32>,
    constant: Vec<u32>,
    /// Work of all steps (J).
    pub(super) all: NodalWork<Sum>,
    /// Second halves of the work of the present step (J).
    pub(super) second: NodalWork<f64>,
    /// Work of the constraints on the groups in the halves of the present step (J).
    pub(super) constraints: [f64; 2],
    /// Work (J) in the present step of those constraints that have nodes with prescribed motion.
    pub(super) prescribed: f64,
    /// Sum of the absolute works of the constraints on the groups in all steps (J), component by component.
    pub(super) exchanged: f64,
    /// Energies that the constraints reported for the present step.
    pub(super) reported: ConstraintWork,
    /// The same in all steps before (J): friction, bond, energy stored by bonds, impact, external
    /// work.
    pub(super) dissipated: [Sum; 5],
}

impl RangeWork {
    /// The nodes.
    pub(super) fn nodes(&self) -> Range<usize> {
        self.nodes.clone()
    }
    /// Completes a step with the second half of the work of the loads (J).
    pub(super) fn complete(&mut self, loads: f64) {
        self.second.loads = loads;
        self.second.prescribed += self.prescribed;
        self.all.add(&self.second);
        let ConstraintWork {
            friction,
            bond,
            stored,
            impact,
            external,
            ..
        } = core::mem::take(&mut self.reported);
        let reported = [friction, bond, stored, impact, external];
        for (sum, work) in self.dissipated.iter_mut().zip(reported) {
            sum.add(work);
        }
        (self.constraints, self.prescribed) = Default::default();
    }
}

/// Read access to the nodal data of a model between kick and drift, shared among threads.
pub(super) struct MidStep<'a> {
    nodes: &'a Nodes,
    slots: &'a SlotTable,
    gather: &'a Gather,
    groups: &'a Groups,
    group_of: &'a [Option<u32>],
    sums: &'a LoadSums,
    mass: &'a [f64],
    mass_damping: &'a [f64],
    /// Whether the model has added masses, on any rank.
    pub(super) has_added_masses: bool,
    pub(super) team: &'a Communicator,
    rule: MassDampingRule,
    step: f64,
}

impl Model {
    /// The ranges of nodes with their groups and loads, and the range of each group without roller nodes.
    pub(super) fn range_work(&self) -> (Vec<RangeWork>, Vec<u32>) {
        // Nodes of ranges of other ranks have none.
        let mut range_of_node = vec![u32::MAX; self.mass.len()];
        let mut all: Vec<RangeWork> = Vec::new();
        for nodes in self.subdomain.node_ranges.ranges() {
            range_of_node[nodes.clone()].fill(all.len() as u32);
            all.push(RangeWork {
                nodes: nodes.clone(),
                ..RangeWork::default()
            });
        }
        let range_of = |node: u32| range_of_node[node as usize];
        let groups = &self.groups.groups[..self.groups.kicked()];
        let of_groups: Vec<u32> = (groups.iter())
            .map(|group| range_of(group.members[0]))
            .collect();
        for (group, &range) in (0..).zip(&of_groups) {
            if let Some(range) = all.get_mut(range as usize) {
                range.groups.push(group);
            }
        }
        for (index, (node, constant)) in (0..).zip(self.loads.sums.places()) {
            let range = range_of_node.get(node as usize);
            let Some(range) = range.and_then(|&range| all.get_mut(range as usize)) else {
                continue;
            };
            let indices = if constant {
                &mut range.constant
            } else {
                &mut range.changing
            };
            indices.push(index);
        }
        (all, of_groups)
    }

    pub(super) fn present(&self, step: f64) -> MidStep<'_> {
        MidStep {
            nodes: &self.nodes,
            slots: &self.subdomain.slots,
            gather: &self.subdomain.gather,
            groups: &self.groups,
            group_of: &self.group_of,
            sums: &self.loads.sums,
            mass: &self.mass,
            mass_damping: &self.mass_damping,
            has_added_masses: self.has_added_masses,
            team: &self.ranks.team,
            rule: self
                .prepared
                .map_or(MassDampingRule::Implicit, |(rule, _)| rule),
            step,
        }
    }
}

impl MidStep<'_> {
    /// Half a step's work of all nodal forces of a range but the loads, with the velocities before and with those after.
    pub(super) fn work(&self, range: &RangeWork) -> [NodalWork<f64>; 2] {
        let mut halves = [NodalWork::default(); 2];
        for &g in &range.groups {
            self.add_group(g as usize, &mut halves);
        }
        if !self.mass_damping.is_empty() {
            for (half, work) in halves.iter_mut().zip(self.plain_damping(range)) {
                half.mass_damping += work;
            }
        }
        halves
    }

    fn add_group(&self, g: usize, halves: &mut [NodalWork<f64>; 2]) {
        if self.groups.is_bare(g) {
            return;
        }
        let motion = &self.groups.motion;
        let (before, after) = (motion.previous[g], motion.next[g]);
        let mean = (before + after) * 0.5;
        let mean_change = (after - before) * (0.25 * self.step);
        let (spring, dashpot, mass_damping, prescribed);
        if let Some((diagonal, stretch)) = self.groups.diagonal_group(g) {
            spring = diagonal.spring.component_mul(&(stretch + mean_change));
            dashpot = diagonal.dashpot.component_mul(&mean);
            mass_damping = diagonal.mass_damping;
            prescribed = Vec3::zeros();
        } else {
            let group = &self.groups.groups[g];
            spring = group.spring * (self.stretch(g) + mean_change);
            dashpot = group.dashpot * mean;
            mass_damping = group.mass_damping;
            prescribed = if group.condition.prescribed.is_empty() {
                Vec3::zeros()
            } else {
                self.prescribed_impulse(g) / self.step
            };
        }
        let damping = self.rule.damped_velocity(before, mean) * mass_damping;
        for (half, velocity) in halves.iter_mut().zip([before, after]) {
            let along = velocity * (0.5 * self.step);
            half.dashpots += dashpot.dot(&along);
            half.springs += spring.dot(&along);
            half.mass_damping += damping.dot(&along);
            half.prescribed += prescribed.dot(&along);
        }
    }

    /// Elongation of a group's spring (m).
    fn stretch(&self, g: usize) -> Vec3 {
        let lead = self.groups.groups[g].members[0] as usize;
        with_nodes!(self.nodes, arrays => {
            arrays.displacement[lead].to_vector() - self.groups.origin[g]
        })
    }

    /// Impulse (N s) of the reaction that makes a group follow its prescribed motion: the residual of its equation of
    /// motion in the fixed and prescribed directions, `A v+ - (...) v- - dt f`.
    fn prescribed_impulse(&self, g: usize) -> Vec3 {
        let group = &self.groups.groups[g];
        let mut force = self.sums.on_group(g) - group.spring * self.stretch(g);
        with_nodes!(self.nodes, arrays => {
            for &node in &group.members {
                force -= arrays.internal(self.slots, node as usize);
            }
        });
        let impulse = self.groups.impulse(g, (self.rule, self.step));
        let residual = impulse - force * self.step;
        residual - group.condition.free(residual)
    }

    /// Half a step's work of the mass damping of the plain nodes of a range.
    fn plain_damping(&self, range: &RangeWork) -> [f64; 2] {
        let [_, before, across, after, _] = self.plain_products(range);
        let half = 0.5 * self.step;
        let damped = |old: f64, new: f64| self.rule.damped_velocity(old, 0.5 * (old + new));
        [half * damped(before, across), half * damped(across, after)]
    }

    fn plain_products(&self, range: &RangeWork) -> [f64; 5] {
        let grouped = |node: usize| self.groups.if_kicked(self.group_of[node]).is_some();
        let groups = (&self.groups.motion, grouped);
        let nodes = range.nodes.clone();
        with_nodes!(self.nodes, arrays => {
            arrays.products(nodes, self.gather, groups, self.mass, self.mass_damping)
        })
    }

    /// Product of the constant loads with the present displacement (J).
    pub(super) fn load_potential(&self, ranges: &[RangeWork]) -> f64 {
        self.constant_loads(ranges, Vec3::dot)
    }

    /// Sum of the absolute products of the components of constant loads and present displacements (J).
    pub(super) fn load_exchange(&self, ranges: &[RangeWork]) -> f64 {
        self.constant_loads(ranges, |force, u| force.abs().dot(&u.abs()))
    }

    /// Sum of products of the constant loads with the present displacement.
    fn constant_loads(
        &self,
        ranges: &[RangeWork],
        product: impl Fn(&Vec3, &Vec3) -> f64 + Sync,
    ) -> f64 {
        let of_range = |range: &RangeWork| {
            with_nodes!(self.nodes, arrays => {
                let displacement = |node: usize| arrays.displacement[node].to_vector();
                self.sums.product(&range.constant, displacement, &product)
            })
        };
        let of_ranges: Vec<f64> = ranges.par_iter().map(of_range).collect();
        self.team.total(of_ranges.into_iter())
    }

    /// Half a step's work of the time-dependent loads of a range with the present velocities, which are those before
    /// the drift or those after it.
    pub(super) fn load_work(&self, range: &RangeWork) -> f64 {
        with_nodes!(self.nodes, arrays => {
            let velocity = |node: usize| arrays.velocity[node].to_vector();
            self.sums.product(&range.changing, velocity, Vec3::dot) * 0.5 * self.step
        })
    }

    /// Kinetic energy of the scheme (J) without added masses, `1/2 v- . M v+`, and what the kinetic energy of the mean velocity has in
    /// addition, `1/8 (v+ - v-) . M (v+ - v-)`.
    pub(super) fn kinetic(&self, ranges: &[RangeWork]) -> [f64; 2] {
        let motion = &self.groups.motion;
        let of_range = |range: &RangeWork| {
            let plain = self.plain_products(range);
            let (mut across, mut squares) = (plain[0], plain[4]);
            for &g in &range.groups {
                let (before, after) = (motion.previous[g as usize], motion.next[g as usize]);
                let mass = self.groups.groups[g as usize].mass;
                across += mass * before.dot(&after);
                squares += mass * (after - before).norm_squared();
            }
            [0.5 * across, 0.125 * squares]
        };
        let of_ranges: Vec<[f64; 2]> = ranges.par_iter().map(of_range).collect();
        let column = |column: usize| of_ranges.iter().map(|energies| energies[column]).collect();
        self.team.totals([column(0), column(1)])
    }

    /// The same of the added masses.
    pub(super) fn kinetic_of_added(&self, ranges: &[RangeWork]) -> [f64; 2] {
        if !self.has_added_masses {
            return [0.0; 2];
        }
        let motion = &self.groups.motion;
        let of_range = |range: &RangeWork| {
            let (mut across, mut squares) = (0.0, 0.0);
            for &g in &range.groups {
                let group = &self.groups.groups[g as usize];
                if group.has_directed_mass() {
                    let (before, after) = (motion.previous[g as usize], motion.next[g as usize]);
                    let change = after - before;
                    across += before.dot(&(group.directed_mass * after));
                    squares += change.dot(&(group.directed_mass * change));
                }
            }
            [0.5 * across, 0.125 * squares]
        };
        let of_ranges: Vec<[f64; 2]> = ranges.par_iter().map(of_range).collect();
        let column = |column: usize| of_ranges.iter().map(|energies| energies[column]).collect();
        self.team.totals([column(0), column(1)])
    }

    /// The same of the inertia that fibres add, and the kinetic energy of their masses at the mean velocity (J).
    pub(super) fn kinetic_of_fibres(&self) -> [f64; 3] {
        let motion = &self.groups.motion;
        let all = (self.groups.fibres).kinetic(&motion.previous, &motion.next);
        let column = |column: usize| all.iter().map(|energies| energies[column]).collect();
        self.team.totals([column(0), column(1), column(2)])
    }

    /// Whether the model has fibres.
    pub(super) fn has_fibres(&self) -> bool {
        !self.groups.fibres.is_empty()
    }
}
