//! The operations of a step of a bay.

use std::borrow::Cow;

use powerhouse_model::{ForceTerms, MassDampingRule, Mat3, Operator, Quad, RunError, Vec3};
use rayon::prelude::*;

use super::Bay;
use crate::Model;
use crate::groups::Groups;
use crate::node_group::NodeGroup;
use crate::nodes::{NodalArrays, Nodes};

impl Bay {
    /// Share of the mass of a group (kg) that it has as inertia, which is left of it.
    pub(crate) fn share_left(&self, group: usize, left: f64) -> f64 {
        left / (left + self.taken[group])
    }

    /// Engine number of a node of the mesh of a group.
    pub(crate) fn lead(&self, group: u32) -> u32 {
        self.leads[group as usize]
    }

    /// Velocity (m/s) of each group in the last half step.
    fn velocity(&self, arrays: &NodalArrays<f64>) -> Vec<Vec3> {
        let of = |node: &u32| arrays.velocity[*node as usize].to_vector();
        self.leads.iter().map(of).collect()
    }

    /// Displacement (m) that an engine node has beside that of its group, by a velocity (m/s) of the groups.
    pub(super) fn delay(&self, node: usize, velocity: impl Fn(usize) -> Vec3) -> Vec3 {
        let (group, offset) = self.place[node];
        velocity(group as usize) * (-self.slowness * offset)
    }

    /// Sum of the values of the engine nodes of a group, times their offsets (m).
    pub(super) fn moment(&self, group: &NodeGroup, value: impl Fn(usize) -> Vec3) -> Vec3 {
        let nodes = group.members.iter().map(|node| *node as usize);
        nodes.map(|node| value(node) * self.place[node].1).sum()
    }

    /// Adds the delay to the predicted velocities of the groups.
    fn turn(&mut self, groups: &mut Groups, (rule, step): (MassDampingRule, f64)) -> bool {
        let constrained = groups.constrained();
        let (coefficients, all) = (&groups.coefficients, &groups.groups);
        let motion = &mut groups.motion;
        let response = |g: usize, force: &Vec3| coefficients[g].inverse * force;
        if !self.excess.is_empty() {
            for (g, (next, excess)) in motion.next.iter_mut().zip(&self.excess).enumerate() {
                *next += response(g, excess) * step;
            }
        }
        let mut b: Vec<Vec3> = (motion.previous.iter().zip(&motion.next))
            .map(|(before, after)| before + after)
            .collect();
        if self.motion.free.len() == constrained && constrained > 0 {
            let mut changed = vec![Vec3::zeros(); all.len()];
            for ((changed, free), now) in
                (changed.iter_mut().zip(&self.motion.free)).zip(&motion.previous)
            {
                *changed = now - free;
            }
            let mut turned = Vec::new();
            self.skew.times(&changed, &mut turned);
            for (g, (b, turned)) in b.iter_mut().zip(&turned).enumerate() {
                *b -= response(g, turned) * (0.5 * step);
            }
        }
        let [last, earlier] = &self.motion.turned;
        let mut x = b.clone();
        if last.len() == x.len() {
            for (g, x) in x.iter_mut().enumerate() {
                let before = earlier.get(g).unwrap_or(&last[g]);
                *x -= response(g, &(last[g] * 2.0 - before)) * (0.5 * step);
            }
        }
        if self.inertia.0 != Some((rule, step)) {
            let of = |group: &NodeGroup| {
                let units = [Vec3::x(), Vec3::y(), Vec3::z()];
                let still = Vec3::zeros();
                Mat3::from_columns(&units.map(|unit| group.impulse((rule, step), &still, &unit)))
            };
            self.inertia = (Some((rule, step)), all.iter().map(of).collect());
        }
        let inertia = &self.inertia.1;
        let of_group = |g: usize| [&coefficients[g].inverse, &inertia[g]];
        let Some((_, turned)) = self.skew.solve((&b, &mut x), step, of_group) else {
            return false;
        };
        for ((next, before), sum) in motion.next.iter_mut().zip(&motion.previous).zip(&x) {
            *next = sum - before;
        }
        self.motion.turned.swap(0, 1);
        self.motion.turned[0] = turned;
        self.motion.before.clone_from(&motion.previous);
        self.motion.free = motion.next[..constrained].to_vec();
        true
    }
}

impl Model {
    /// Values of all nodes of a bay from those of the nodes of the mesh: copies have those of their node. Of any other body, or of all
    /// nodes, the same values.
    pub(crate) fn with_copies<'v>(&self, values: &'v [Vec3]) -> Cow<'v, [Vec3]> {
        let count = self.mesh.node_count();
        let (Some(bay), true) = (&self.bay, values.len() == count) else {
            return Cow::Borrowed(values);
        };
        let numbering = &self.subdomain.numbering;
        let of_copy = |&local: &u32| {
            let group = self.group_of[local as usize]?;
            let lead = bay.leads[group as usize];
            values.get(numbering.mesh_of[lead as usize] as usize)
        };
        let copies = numbering.local_of[count..].iter();
        let copies = copies.map(|local| of_copy(local).copied().unwrap_or_default());
        Cow::Owned(values.iter().copied().chain(copies).collect())
    }

    /// Forces of a bay at the present time.
    pub(crate) fn bay_forces(&mut self, terms: ForceTerms, step: f64) -> Result<(), RunError> {
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        let Some(mut bay) = self.bay.take() else {
            return Ok(());
        };
        let done = if bay.is_linear {
            self.evaluate(terms, self.present_step(step))
        } else {
            self.evaluate_delayed(&mut bay, terms, step)
        };
        self.bay = Some(bay);
        done
    }

    /// Forces of laws that are not linear at an extrapolated velocity, and what takes its linear part off again.
    fn evaluate_delayed(
        &mut self,
        bay: &mut Bay,
        terms: ForceTerms,
        step: f64,
    ) -> Result<(), RunError> {
        let (nodes, Nodes::F64(arrays)) = (self.mass.len(), &self.nodes) else {
            return Ok(());
        };
        let velocity = bay.velocity(arrays);
        let predicted: Vec<Vec3> = match &bay.motion.before[..] {
            [] => velocity.clone(),
            before => (velocity.iter().zip(before))
                .map(|(velocity, before)| velocity * 1.5 - before * 0.5)
                .collect(),
        };
        let delay = |node: usize| bay.delay(node, |g| predicted[g]);
        let delays: Vec<Vec3> = (0..nodes).map(delay).collect();
        let (moved, moving) = (arrays.displacement.clone(), arrays.velocity.clone());
        let placed: Vec<Vec3> = (moved.iter().zip(&delays))
            .map(|(moved, delay)| moved.to_vector() + delay)
            .collect();
        let of_delays = self.elastic_product(Operator::Elastic, &delays, &|_| 1.0);
        let elastic = self.elastic_product(Operator::Elastic, &placed, &|_| 1.0);
        if let Nodes::F64(arrays) = &mut self.nodes {
            for (displacement, placed) in arrays.displacement.iter_mut().zip(&placed) {
                *displacement = Quad::from_vector(placed);
            }
            if let [_, ..] = &bay.motion.predicted[..] {
                // Elements are told how their strain has changed since the forces before.
                let rate = |g: usize| (predicted[g] - bay.motion.predicted[g]) / step;
                for (node, velocity) in arrays.velocity.iter_mut().enumerate() {
                    *velocity = Quad::from_vector(&(velocity.to_vector() + bay.delay(node, rate)));
                }
            }
        }
        let done = self.evaluate(terms, self.present_step(step));
        if let Nodes::F64(arrays) = &mut self.nodes {
            (arrays.displacement, arrays.velocity) = (moved, moving);
            let slots = &self.subdomain.slots;
            let groups = self.groups.groups.par_iter();
            let relaxed: Vec<Vec3> = groups
                .map(|group| bay.moment(group, |node| elastic[node] - arrays.internal(slots, node)))
                .collect();
            let [last, earlier] = &bay.motion.relaxed;
            let groups = self.groups.groups.iter().enumerate();
            let excess = groups.map(|(g, group)| {
                let members = group.members.iter();
                let linear: Vec3 = members.map(|node| of_delays[*node as usize]).sum();
                let before = earlier.get(g).or(last.get(g)).unwrap_or(&relaxed[g]);
                linear + (relaxed[g] - before) * (0.5 * bay.slowness / step)
            });
            bay.excess = excess.collect();
            bay.motion.relaxed.swap(0, 1);
            bay.motion.relaxed[0] = relaxed;
            bay.motion.predicted = predicted;
        }
        done
    }

    /// Adds the delay of a bay to the predicted velocities.
    pub(crate) fn turn_bay(&mut self, rule: MassDampingRule, step: f64) {
        let Some(bay) = &mut self.bay else {
            return;
        };
        if !bay.turn(&mut self.groups, (rule, step)) && self.fault.is_none() {
            self.fault = Some(self.divergence());
        }
    }

    /// Displacement (m) of the nodes of a block of a bay, in the block's order, with the delay of each element; none in any other body.
    pub(crate) fn delayed_displacement(&self, block: usize) -> Option<Vec<Quad<f64>>> {
        let (Some(bay), Nodes::F64(arrays)) = (&self.bay, &self.nodes) else {
            return None;
        };
        let nodes = self.subdomain.nodes_of(block).iter();
        let own = nodes.map(|&node| {
            let node = node as usize;
            arrays.displacement[node].to_vector() + bay.delay(node, |g| self.bay_velocity(bay, g))
        });
        Some(own.map(|u| Quad::from_vector(&u)).collect())
    }

    /// Velocity (m/s) of a group of a bay at the present time: the mean of those around it once both are known.
    pub(super) fn bay_velocity(&self, bay: &Bay, group: usize) -> Vec3 {
        let velocity = self.velocity_of(bay.leads[group] as usize);
        if self.is_kicked() {
            return (velocity + self.groups.motion.next[group]) * 0.5;
        }
        match bay.motion.before.get(group) {
            Some(before) => velocity * 1.5 - before * 0.5,
            None => velocity,
        }
    }
}
