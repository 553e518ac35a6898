//! Joints and ties in static solutions: closed pairs are tied, as long as their law admits the tractions.

use std::collections::HashSet;

use powerhouse_model::{
    ContactState, DisjointSets, JointConstraint, JointHistory, JointPair, JointView, Mat3,
    PredictedMotion, StaticError, StepTime, Vec3,
};

use crate::Model;
use crate::node_group::NodeGroup;

/// Length of step (s) in which joint laws are evaluated for tractions in static equilibrium; forces do not
/// depend on it.
const SOME_STEP: f64 = 1.0e-4;

/// Share of the greatest force that is left at a pair below which a pair has moved by rounding.
const MOVED: f64 = 1.0e-6;

/// Treatment of closed pairs whose law has no shear strength.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Smooth {
    /// As one node.
    Tied,
    /// Connected along their normals alone.
    Sliding,
}

impl Model {
    /// Engine nodes of the pairs that static solutions take for one node: ties, closed pairs, and pairs one side of which has no
    /// elements and follows the other; smooth pairs among them unless their sides are to slide on each other.
    fn connected_pairs(&self, smooth: Smooth) -> Vec<[u32; 2]> {
        let engine = |pair: [u32; 2]| pair.map(|node| self.engine(node) as u32);
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for bound in &self.constraints {
            pairs.extend(bound.constraint.ties().into_iter().map(engine));
            for joint in bound.joints() {
                let known = joint.pairs.iter().zip(joint.records);
                let is_tied = !joint.smooth || smooth == Smooth::Tied;
                let connected = known.filter(|(pair, record)| {
                    let closed = record.state.contact != ContactState::Open;
                    closed && is_tied || self.lacks_a_side(pair)
                });
                pairs.extend(connected.map(|(pair, _)| engine(pair.nodes)));
            }
        }
        pairs
    }

    /// Engine nodes and normals of the closed pairs whose sides slide on each other without friction.
    pub(super) fn smooth_pairs(&self) -> Vec<([u32; 2], Vec3)> {
        let mut smooth = Vec::new();
        for joint in self.joints().filter(|joint| joint.smooth) {
            for (pair, record) in joint.pairs.iter().zip(joint.records) {
                if record.state.contact != ContactState::Open && !self.lacks_a_side(pair) {
                    let nodes = pair.nodes.map(|node| self.engine(node) as u32);
                    smooth.push((nodes, pair.normal));
                }
            }
        }
        smooth
    }

    /// Whether a pair has a node without elements, of a side that is not there yet or no longer.
    fn lacks_a_side(&self, pair: &JointPair) -> bool {
        let mut nodes = pair.nodes.iter().map(|&node| self.engine(node));
        nodes.any(|node| self.is_orphan(node))
    }

    /// Whether an engine node and those that move with it have no elements.
    fn is_orphan(&self, node: usize) -> bool {
        let group = self.group_of[node].map(|group| &self.groups.groups[group as usize]);
        group.is_some_and(|group| group.mass <= 0.0)
    }

    /// Refuses constraints without ties and joints.
    pub(super) fn check_constraints(&self) -> Result<(), StaticError> {
        for bound in &self.constraints {
            if bound.joints().is_empty() && bound.constraint.ties().is_empty() {
                return Err(StaticError::Constraint {
                    name: bound.constraint.name().into(),
                });
            }
        }
        Ok(())
    }

    /// Calls `join` with the mesh nodes of every connected pair.
    pub(super) fn each_connected_pair(&self, mut join: impl FnMut(u32, u32)) {
        for pair in self.connected_pairs(Smooth::Tied) {
            let [a, b] = pair.map(|node| self.subdomain.numbering.mesh_of[node as usize]);
            join(a, b);
        }
    }

    /// The groups of the model, with groups connected by pairs merged.
    pub(super) fn merged_groups(&self, smooth: Smooth) -> Result<Vec<NodeGroup>, StaticError> {
        let groups = &self.groups.groups;
        let mut sets = DisjointSets::new(groups.len());
        for [a, b] in self.connected_pairs(smooth) {
            // Nodes of constraints always have groups.
            if let (Some(a), Some(b)) = (self.group_of[a as usize], self.group_of[b as usize]) {
                sets.join(a, b);
            }
        }
        let mut merged: Vec<Option<NodeGroup>> = vec![None; groups.len()];
        for (index, group) in groups.iter().enumerate() {
            let root = sets.root(index as u32) as usize;
            let Some(whole) = &mut merged[root] else {
                merged[root] = Some(group.clone());
                continue;
            };
            whole.members.extend_from_slice(&group.members);
            if whole.mass <= 0.0 {
                // An orphan node cannot lead: forces on it are dropped.
                let orphans = whole.members.len() - group.members.len();
                whole.members.rotate_left(orphans);
            }
            whole.mass += group.mass;
            whole.spring += group.spring;
            for &(direction, motion) in &group.condition.prescribed {
                if !whole.condition.prescribe(direction, motion) {
                    return Err(StaticError::TiedMotions {
                        node: self.node_tag(group.members[0] as usize),
                    });
                }
            }
            for &direction in group.condition.directions() {
                whole.condition.hold(direction);
            }
        }
        Ok(merged.into_iter().flatten().collect())
    }

    /// The lead node of a node's group.
    fn lead(&self, node: u32) -> usize {
        self.members(&node)[0] as usize
    }

    /// Passes the length of the coming steps (s) to the constraints, with the inverse effective masses of
    /// lead nodes (1/kg, engine numbering).
    pub(super) fn prepare_joints(&mut self, step: f64, inverse: &[Mat3]) {
        let mut constraints = core::mem::take(&mut self.constraints);
        for bound in &mut constraints {
            let leads = bound.nodes().iter().map(|&node| self.lead(node));
            let inverse: Vec<Mat3> = leads.map(|lead| inverse[lead]).collect();
            // Static solutions do not know fibres.
            if let Some(coupled) = bound.constraint.coupled() {
                coupled.couple(&[]);
            }
            bound.constraint.prepare(step, &inverse);
        }
        self.constraints = constraints;
        // The constraints are now prepared for another length of step.
        self.prepared = None;
    }

    /// Corrects the velocities of lead nodes (m/s, engine numbering) by the constraints in a step, from a
    /// displacement and the velocities before.
    pub(super) fn correct_joints(
        &mut self,
        step: f64,
        (displacement, before): (&[Vec3], &[Vec3]),
        velocity: &mut [Vec3],
        inverse: &[Mat3],
    ) -> Result<(), StaticError> {
        let when = StepTime {
            number: self.number,
            time: self.time,
            step,
        };
        let mut constraints = core::mem::take(&mut self.constraints);
        let corrected = constraints.iter_mut().try_for_each(|bound| {
            let nodes = bound.nodes().iter();
            let here: Vec<Vec3> = nodes.map(|&node| displacement[node as usize]).collect();
            let leads: Vec<usize> = bound.nodes().iter().map(|&n| self.lead(n)).collect();
            let of_leads =
                |values: &[Vec3]| -> Vec<Vec3> { leads.iter().map(|&lead| values[lead]).collect() };
            let (before, mut own) = (of_leads(before), of_leads(velocity));
            let inverse: Vec<Mat3> = leads.iter().map(|&lead| inverse[lead]).collect();
            let motion = PredictedMotion::new(when, &here, &before, &mut own, &inverse);
            if let Err(error) = bound.constraint.correct(motion) {
                return Err(StaticError::Joint {
                    name: bound.constraint.name().into(),
                    reason: error.to_string(),
                });
            }
            for (lead, own) in leads.into_iter().zip(own) {
                velocity[lead] = own;
            }
            Ok(())
        });
        self.constraints = constraints;
        self.agreed(corrected)
    }

    /// Contact states and history variables of the joints.
    pub(super) fn joint_histories(&self) -> Vec<JointHistory> {
        let joints = self.joints();
        joints.map(|joint| JointHistory::from(&joint)).collect()
    }

    /// Restores the joints to an earlier state, with their tractions for references where they have none.
    pub(super) fn restore_joints(&mut self, histories: &[JointHistory]) {
        for history in histories {
            for bound in &mut self.constraints {
                let jointed = bound.constraint.jointed_mut();
                if jointed.is_some_and(|jointed| jointed.restore(history)) {
                    break;
                }
            }
        }
        self.each_jointed(|jointed| jointed.keep_tractions());
    }

    /// Sets references to zero at pairs that have moved and at pairs beside released ones, whose nodes are added to `released`;
    /// returns whether there were more to release.
    fn release_references(
        &self,
        moved: &[Vec<usize>],
        references: &mut [JointHistory],
        released: &mut HashSet<u32>,
    ) -> bool {
        let count = released.len();
        for (joint, moved) in references.iter().zip(moved) {
            released.extend(moved.iter().flat_map(|&pair| joint.nodes[pair]));
        }
        let near = released.clone();
        for joint in references {
            for (record, pair) in joint.records.iter_mut().zip(&joint.nodes) {
                if record.reference.is_some() && pair.iter().any(|node| near.contains(node)) {
                    record.reference = Some([0.0; 3]);
                    released.extend(pair);
                }
            }
        }
        released.len() > count
    }

    /// The pairs of each joint, by their numbers in it, that are in another contact or bond than before, or slide.
    fn moved_pairs(&self, before: &[JointHistory]) -> Vec<Vec<usize>> {
        let of_joint = |(joint, before): (JointView, &JointHistory)| {
            let records = joint.records.iter().zip(&before.records).enumerate();
            let moved = records.filter(|(_, (now, before))| {
                let (now, before) = (&now.state, &before.state);
                let same = now.contact == before.contact && now.bond == before.bond;
                now.contact == ContactState::Slide || !same
            });
            moved.map(|(pair, _)| pair).collect()
        };
        self.joints().zip(before).map(of_joint).collect()
    }

    /// Gives pairs that have moved by rounding alone the state that they had, with their present tractions.
    fn undo_moves(&mut self, before: &[JointHistory], moved: &[Vec<usize>]) {
        let mut histories = self.joint_histories();
        for ((joint, before), moved) in histories.iter_mut().zip(before).zip(moved) {
            for &pair in moved {
                let traction = joint.records[pair].traction;
                joint.records[pair] = before.records[pair].with_traction(traction);
            }
        }
        self.restore_joints(&histories);
    }

    /// Lets joints take their present tractions for references, to which those that later equilibrium leaves open are nearest.
    pub(super) fn keep_tractions(&mut self) {
        let mut histories = self.joint_histories();
        for record in histories.iter_mut().flat_map(|joint| &mut joint.records) {
            record.reference = None;
        }
        self.restore_joints(&histories);
    }

    /// Lets joints count what their bonds lose, and their slip, from states at the start of an increment of a relaxation.
    pub(super) fn begin_relaxation(&mut self, start: &[JointHistory]) {
        self.each_jointed(|jointed| jointed.begin_relaxation(start));
    }

    /// Sets the share of the damage since the start of the increment that joints take back in the next step.
    pub(super) fn take_back(&mut self, share: f64) {
        self.each_jointed(|jointed| jointed.take_back(share));
    }

    /// Ends an increment of a relaxation.
    pub(super) fn end_relaxation(&mut self) {
        self.each_jointed(|jointed| jointed.end_relaxation());
    }

    /// Calls a function with the constraints that have joints.
    fn each_jointed(&mut self, mut change: impl FnMut(&mut dyn JointConstraint)) {
        for bound in &mut self.constraints {
            if let Some(jointed) = bound.constraint.jointed_mut() {
                change(jointed);
            }
        }
    }

    /// Makes sliding pairs stick in static equilibrium at a displacement (m, engine numbering), and discards the impact
    /// losses and the last step of the relaxation, whose masses are fictitious. Nodes without elements follow their partners from a displacement at
    /// the start, with the state that their pairs had.
    pub(super) fn stick_joints(
        &mut self,
        before: &[JointHistory],
        (start, u): (&[Vec3], &mut [Vec3]),
    ) {
        let mut histories = Vec::new();
        for (joint, before) in self.joints().zip(before) {
            let mut history = JointHistory::from(&joint);
            let records = history.records.iter_mut().zip(&before.records);
            for ((record, before), pair) in records.zip(joint.pairs) {
                let [first, second] = pair.nodes.map(|node| self.engine(node));
                if self.lacks_a_side(pair) {
                    let (orphan, other) = if self.is_orphan(first) {
                        (first, second)
                    } else {
                        (second, first)
                    };
                    let moved = u[other] - start[other];
                    for member in self.members(&(orphan as u32)) {
                        u[*member as usize] = start[*member as usize] + moved;
                    }
                    *record = before.with_traction(Vec3::zeros());
                    continue;
                }
                record.impact = before.impact;
                (record.coming_slip, record.late_work) = (0.0, 0.0);
                if record.state.contact == ContactState::Slide {
                    record.state.contact = ContactState::Stick;
                    let offset = pair.to_local(&(u[second] - u[first])) - record.origin();
                    record.anchor = Some([offset.y, offset.z]);
                }
            }
            histories.push(history);
        }
        self.restore_joints(&histories);
    }

    /// Computes the tractions of joints in static equilibrium, and refuses joints whose law does not admit them: those without
    /// which the forces (N) that are left are more than negligible.
    ///
    /// Any division of the forces that the laws admit is in equilibrium. That nearest to the stress beside the joint comes first;
    /// around pairs that do not bear it the least one is taken instead.
    pub(super) fn load_joints(&mut self, negligible: f64) -> Result<(), StaticError> {
        if self.on_all_ranks(self.constraints.is_empty()) {
            return Ok(());
        }
        self.compute_static_forces(0.0)?;
        self.set_reference_tractions()?;
        let mut forces = self.forces_of_initial_stress();
        forces.iter_mut().for_each(|force| *force = -*force);
        self.loads.add_all(self.time, &mut forces);
        let internal = self.internal_forces();
        for (force, internal) in forces.iter_mut().zip(&internal) {
            *force -= internal;
        }
        for (group, origin) in self.groups.groups.iter().zip(&self.groups.origin) {
            let lead = group.members[0] as usize;
            forces[lead] -= group.spring * (self.displacement_of(lead) - origin);
        }
        self.gather_members(&mut forces);
        let (groups, least) = (&self.groups.groups, self.ranks.least_mass);
        let free = |mass: f64| Mat3::identity() / mass;
        let inverse = |node: usize| match self.group_of[node].map(|g| &groups[g as usize]) {
            Some(group) => (group.orphan_inverse(least))
                .unwrap_or_else(|| group.condition.project(&free(group.mass)).0),
            None if self.mass[node] > 0.0 => free(self.mass[node]),
            None => Mat3::zeros(),
        };
        let inverse: Vec<Mat3> = (0..self.mass.len()).map(inverse).collect();
        let velocity: Vec<Vec3> = (inverse.iter().zip(&forces))
            .map(|(inverse, force)| inverse * force * SOME_STEP)
            .collect();
        let displacement = self.displacements();
        let still = vec![Vec3::zeros(); displacement.len()];
        let mass = |node: usize| match self.group_of[node].map(|g| &groups[g as usize]) {
            Some(group) => group.mass.max(0.0),
            None => self.mass[node],
        };
        let masses: Vec<f64> = (0..self.mass.len()).map(mass).collect();
        let before = self.joint_histories();
        let (mut references, mut released) = (before.clone(), HashSet::new());
        loop {
            self.restore_joints(&references);
            self.prepare_joints(SOME_STEP, &inverse);
            let mut left = velocity.clone();
            let motion = (&displacement[..], &still[..]);
            self.correct_joints(SOME_STEP, motion, &mut left, &inverse)?;
            let moved = self.moved_pairs(&before);
            let count: usize = moved.iter().map(Vec::len).sum();
            let forces: Vec<Vec3> = left.iter().zip(&masses).map(|(v, m)| v * *m).collect();
            if self.node_sums().norm(&forces) / SOME_STEP <= negligible {
                self.undo_moves(&before, &moved);
                return Ok(());
            }
            let goes_on = self.release_references(&moved, &mut references, &mut released);
            if self.on_all_ranks(count == 0) {
                return Ok(());
            }
            if self.on_all_ranks(!goes_on) {
                return self.agreed(self.refuse_moved(&moved, &forces));
            }
        }
    }

    /// Refuses the joint of which most pairs have moved, by the forces (N, engine numbering) that are left at their nodes.
    fn refuse_moved(&self, moved: &[Vec<usize>], left: &[Vec3]) -> Result<(), StaticError> {
        let at = |joint: &JointView, pair: usize| {
            let nodes = joint.pairs[pair].nodes.map(|node| self.engine(node) as u32);
            nodes
                .map(|node| left[self.lead(node)].norm())
                .into_iter()
                .fold(0.0, f64::max)
        };
        let all = self.joints().zip(moved);
        let forces = all.flat_map(|(joint, moved)| moved.iter().map(move |&pair| at(&joint, pair)));
        let least = MOVED * forces.fold(0.0, f64::max);
        let counted = self.joints().zip(moved).map(|(joint, moved)| {
            let pairs = moved
                .iter()
                .filter(|&&pair| at(&joint, pair) > least)
                .count();
            (joint, pairs)
        });
        match counted.max_by_key(|(_, pairs)| *pairs) {
            Some((joint, pairs)) if pairs > 0 => Err(StaticError::JointMoves {
                joint: joint.name.into(),
                pairs,
                of: joint.pairs.len(),
            }),
            _ => Ok(()),
        }
    }
}
