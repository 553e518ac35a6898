//! Work of nodal forces in a step.

use powerhouse_model::{MassDampingRule, Vec3};
use rayon::prelude::*;

use super::sum::Sum;
use crate::Model;
use crate::applied::LoadSums;
use crate::gather::{CHUNK, Gather, SlotTable};
use crate::groups::Groups;
use crate::nodes::{Nodes, with_nodes};

/// Work of nodal forces (J): energy dissipated or stored by damping, dashpots and springs, and external work of loads
/// and prescribed motion.
#[derive(Clone, Copy, Debug, Default)]
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
    rule: MassDampingRule,
    step: f64,
}

impl Model {
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
            rule: self
                .prepared
                .map_or(MassDampingRule::Implicit, |(rule, _)| rule),
            step,
        }
    }
}

impl MidStep<'_> {
    /// Half a step's work of all nodal forces but the loads, with the velocities before and with
    /// those after.
    pub(super) fn work(&self) -> [NodalWork<f64>; 2] {
        let count = self.groups.kicked();
        let chunks: Vec<[NodalWork<f64>; 2]> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut halves = [NodalWork::default(); 2];
                for g in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                    self.add_group(g, &mut halves);
                }
                halves
            })
            .collect();
        let mut halves = [NodalWork::default(); 2];
        for chunk in &chunks {
            for (half, part) in halves.iter_mut().zip(chunk) {
                half.mass_damping += part.mass_damping;
                half.dashpots += part.dashpots;
                half.springs += part.springs;
                half.prescribed += part.prescribed;
            }
        }
        if !self.mass_damping.is_empty() {
            for (half, work) in halves.iter_mut().zip(self.plain_damping()) {
                half.mass_damping += work;
            }
        }
        halves
    }

    fn add_group(&self, g: usize, halves: &mut [NodalWork<f64>; 2]) {
        if self.mass_damping.is_empty() && self.groups.scalar_mass(g).is_some() {
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
        let motion = &self.groups.motion;
        let (before, after) = (&motion.previous[g], &motion.next[g]);
        let impulse = group.impulse((self.rule, self.step), before, after);
        let residual = impulse - force * self.step;
        residual - group.condition.free(residual)
    }

    /// Half a step's work of the mass damping of plain nodes.
    fn plain_damping(&self) -> [f64; 2] {
        let [_, before, across, after, _] = self.plain_products();
        let half = 0.5 * self.step;
        let damped = |old: f64, new: f64| self.rule.damped_velocity(old, 0.5 * (old + new));
        [half * damped(before, across), half * damped(across, after)]
    }

    fn plain_products(&self) -> [f64; 5] {
        let grouped = |node: usize| self.groups.if_kicked(self.group_of[node]).is_some();
        let groups = (&self.groups.motion, grouped);
        with_nodes!(self.nodes, arrays => {
            arrays.products(self.gather, groups, self.mass, self.mass_damping)
        })
    }

    /// Product of the constant loads with the present displacement (J).
    pub(super) fn load_potential(&self) -> f64 {
        with_nodes!(self.nodes, arrays => {
            let displacement = |node: usize| arrays.displacement[node].to_vector();
            self.sums.potential(displacement)
        })
    }

    /// Half a step's work of the time-dependent loads with the present velocities, which are
    /// those before the drift or those after it.
    pub(super) fn load_work(&self) -> f64 {
        with_nodes!(self.nodes, arrays => {
            let velocity = |node: usize| arrays.velocity[node].to_vector();
            self.sums.power(velocity) * 0.5 * self.step
        })
    }

    /// Kinetic energy of the mean velocity less that of the scheme (J), `1/8 (v+ - v-) . M (v+ - v-)`.
    pub(super) fn kinetic_difference(&self) -> f64 {
        let motion = &self.groups.motion;
        let grouped: f64 = (self.groups.groups.iter())
            .zip(motion.previous.iter().zip(&motion.next))
            .map(|(group, (before, after))| group.mass * (after - before).norm_squared())
            .sum();
        0.125 * (self.plain_products()[4] + grouped)
    }

    /// Kinetic energy of the scheme (J), `1/2 v- . M v+`.
    pub(super) fn kinetic(&self) -> f64 {
        let motion = &self.groups.motion;
        let grouped: f64 = (self.groups.groups.iter())
            .zip(motion.previous.iter().zip(&motion.next))
            .map(|(group, (before, after))| group.mass * before.dot(after))
            .sum();
        0.5 * (self.plain_products()[0] + grouped)
    }
}
