//! The operations of a step of a bay.

use std::borrow::Cow;

use powerhouse_model::{ForceTerms, MassDampingRule, Mat3, Quad, RunError, Vec3};

use super::{Bay, Best, Solution};
use crate::Model;
use crate::groups::Groups;
use crate::node_group::NodeGroup;
use crate::nodes::Nodes;

impl Bay {
    /// Share of the mass of a group (kg) that it has as inertia, which is left of it.
    pub(crate) fn share_left(&self, group: usize, left: f64) -> f64 {
        left / (left + self.taken[group])
    }

    /// Engine number of a node of the mesh of a group.
    pub(crate) fn lead(&self, group: u32) -> u32 {
        self.leads[group as usize]
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

    /// Begins the solution of a step from the predicted velocities, which have all forces but those that laws lack of linear ones.
    fn turn(&mut self, groups: &mut Groups, (rule, step): (MassDampingRule, f64)) -> bool {
        let (coefficients, motion) = (&groups.coefficients, &groups.motion);
        let response = |g: usize, impulse: &Vec3| coefficients[g].inverse * impulse;
        if self.inertia.0 != Some((rule, step)) {
            let of = |group: &NodeGroup| {
                let units = [Vec3::x(), Vec3::y(), Vec3::z()];
                let still = Vec3::zeros();
                Mat3::from_columns(&units.map(|unit| group.impulse((rule, step), &still, &unit)))
            };
            self.inertia = (Some((rule, step)), groups.groups.iter().map(of).collect());
        }
        if self.motion.step != step {
            (self.motion.step, self.motion.settled) = (step, Default::default());
        }
        let mut guess = next_after(&self.motion.settled);
        if guess.is_empty() {
            // Laws lack as much as they did, such as the whole stress of a body under load.
            guess = self.of_laws(&self.motion.lacking[0], groups, step);
        }
        let solution = &mut self.solution;
        solution.given.clear();
        let both = motion.previous.iter().zip(&motion.next);
        (solution.given).extend(both.map(|(before, after)| before + after));
        let lacking = &self.motion.lacking[0];
        for (g, (given, [force, moment])) in solution.given.iter_mut().zip(lacking).enumerate() {
            *given += response(g, &(force * (0.5 * step) - moment * self.slowness));
        }
        let constrained = groups.constrained();
        let laws = if self.is_linear {
            0
        } else {
            solution.given.len()
        };
        solution.free = vec![Vec3::zeros(); constrained];
        solution.mixing.clear();
        solution.best = Best::default();
        solution.guess = guess;
        (solution.guess).resize(laws + constrained, Vec3::zeros());
        solution.sum = solution.wanted();
        let turned = next_after(&self.motion.turned);
        for (g, (sum, turned)) in solution.sum.iter_mut().zip(&turned).enumerate() {
            *sum -= response(g, turned) * (0.5 * step);
        }
        self.motion.before.clone_from(&motion.previous);
        self.motion.turned.swap(0, 1);
        self.solve(groups, step)
    }

    /// Predicted velocities of the groups with what is guessed of laws, if constraints change them by what is guessed of that.
    pub(super) fn solve(&mut self, groups: &mut Groups, step: f64) -> bool {
        let (coefficients, motion) = (&groups.coefficients, &mut groups.motion);
        let (wanted, inertia) = (self.solution.wanted(), &self.inertia.1);
        let of_group = |g: usize| [&coefficients[g].inverse, &inertia[g]];
        let Solution {
            sum, guess, free, ..
        } = &mut self.solution;
        let Some((_, turned)) = self.skew.solve((&wanted, sum), step, of_group) else {
            return false;
        };
        self.motion.turned[0] = turned;
        for ((next, before), sum) in motion.next.iter_mut().zip(&motion.previous).zip(&*sum) {
            *next = sum - before;
        }
        let changed = &guess[guess.len() - free.len()..];
        for ((free, next), changed) in free.iter_mut().zip(&mut motion.next).zip(changed) {
            *next -= changed;
            *free = *next;
        }
        true
    }
}

impl Solution {
    /// Sums of velocities as they would be without the skew matrix.
    fn wanted(&self) -> Vec<Vec3> {
        let (of_laws, changed) = self.guess.split_at(self.guess.len() - self.free.len());
        let mut wanted = self.given.clone();
        for part in [of_laws, changed] {
            for (wanted, part) in wanted.iter_mut().zip(part) {
                *wanted += part;
            }
        }
        wanted
    }
}

/// The values of a step that go on as those of the last two did, of which the later one comes first.
fn next_after([last, earlier]: &[Vec<Vec3>; 2]) -> Vec<Vec3> {
    if earlier.len() != last.len() {
        return last.clone();
    }
    let both = last.iter().zip(earlier);
    both.map(|(last, earlier)| last * 2.0 - earlier).collect()
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

    /// Forces of a bay at the present time: all of linear ones, and of others those of the stiffness of their elements.
    pub(crate) fn bay_forces(&mut self, terms: ForceTerms, step: f64) -> Result<(), RunError> {
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        let Some(bay) = &mut self.bay else {
            return Ok(());
        };
        bay.terms = terms;
        let when = self.present_step(step);
        match &self.bay {
            Some(bay) if !bay.is_linear => self.stiffness_forces(when),
            _ => self.evaluate(terms, when),
        }
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
