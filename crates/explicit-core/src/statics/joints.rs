//! Joints and ties in static solutions: pairs that stick are tied, as long as their law admits the tractions.

use std::collections::HashSet;

use powerhouse_model::{
    ContactState, DisjointSets, JointHistory, JointRecord, Mat3, PredictedMotion, StaticError,
    StepTime, Vec3,
};

use crate::Model;
use crate::groups::NodeGroup;

/// Length of step (s) in which joint laws are evaluated for tractions in static equilibrium; forces do not
/// depend on it.
const SOME_STEP: f64 = 1.0e-4;

/// Attempt to find tractions that the laws admit: any division of the forces that they admit is in equilibrium.
#[derive(Clone, Copy, Debug)]
enum Attempt {
    /// Nearest to those of the stress beside the joint.
    AsStressed,
    /// The same, but the least ones at the nodes of pairs that do not bear these.
    WithoutThose,
    /// The least ones of all pairs.
    Least,
}

/// Node pairs of joints that count as connected, in addition to ties.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ConnectedPairs {
    /// Pairs that stick.
    Sticking,
    /// Pairs that stick or slide.
    Closed,
}

impl Model {
    /// Engine nodes of the connected pairs of all constraints.
    fn connected_pairs(&self, which: ConnectedPairs) -> Vec<[u32; 2]> {
        let together = |state: ContactState| match which {
            ConnectedPairs::Sticking => state == ContactState::Stick,
            ConnectedPairs::Closed => state != ContactState::Open,
        };
        let mut pairs = Vec::new();
        for bound in &self.constraints {
            pairs.extend(bound.constraint.ties());
            for joint in bound.constraint.joints() {
                let known = joint.pairs.iter().zip(joint.records);
                let known = known.filter(|(_, record)| together(record.state.contact));
                pairs.extend(known.map(|(pair, _)| pair.nodes));
            }
        }
        let engine = |pair: [u32; 2]| pair.map(|node| self.engine(node) as u32);
        pairs.into_iter().map(engine).collect()
    }

    /// Refuses constraints without ties and joints, and sliding pairs in methods that treat sticking pairs as tied.
    pub(super) fn check_joints(&self, which: ConnectedPairs) -> Result<(), StaticError> {
        for bound in &self.constraints {
            let joints = bound.constraint.joints();
            if joints.is_empty() && bound.constraint.ties().is_empty() {
                return Err(StaticError::Constraint {
                    name: bound.constraint.name().into(),
                });
            }
            for joint in joints {
                let states = joint.records.iter().map(|record| record.state.contact);
                let sliding = states.filter(|state| *state == ContactState::Slide).count();
                if sliding > 0 && which == ConnectedPairs::Sticking {
                    return Err(StaticError::JointMoves {
                        joint: joint.name.into(),
                        pairs: sliding,
                        of: joint.pairs.len(),
                    });
                }
            }
        }
        Ok(())
    }

    /// Calls `join` with the mesh nodes of every connected pair.
    pub(super) fn each_connected_pair(
        &self,
        which: ConnectedPairs,
        mut join: impl FnMut(u32, u32),
    ) {
        for pair in self.connected_pairs(which) {
            let [a, b] = pair.map(|node| self.subdomain.numbering.mesh_of[node as usize]);
            join(a, b);
        }
    }

    /// The groups of the model, with groups connected by sticking pairs merged.
    pub(super) fn merged_groups(&self) -> Result<Vec<NodeGroup>, StaticError> {
        let groups = &self.groups.groups;
        let mut sets = DisjointSets::new(groups.len());
        for [a, b] in self.connected_pairs(ConnectedPairs::Sticking) {
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
                if bound.constraint.restore(history) {
                    break;
                }
            }
        }
        for bound in &mut self.constraints {
            bound.constraint.keep_tractions();
        }
    }

    /// Sets the references that an attempt does without to zero.
    fn release_references(
        &self,
        attempt: Attempt,
        before: &[JointHistory],
        references: &mut [JointHistory],
    ) {
        let mut nodes = HashSet::new();
        for (joint, before) in self.joints().zip(before) {
            let records = joint.records.iter().zip(&before.records);
            for ((now, before), pair) in records.zip(joint.pairs) {
                let sticks = |record: &JointRecord| record.state.contact == ContactState::Stick;
                if sticks(before) && !sticks(now) {
                    nodes.extend(pair.nodes);
                }
            }
        }
        for joint in references {
            for (record, pair) in joint.records.iter_mut().zip(&joint.nodes) {
                let released = match attempt {
                    Attempt::AsStressed => false,
                    Attempt::WithoutThose => pair.iter().any(|node| nodes.contains(node)),
                    Attempt::Least => true,
                };
                if released && record.reference.is_some() {
                    record.reference = Some([0.0; 3]);
                }
            }
        }
    }

    /// Lets joints take their present tractions for references, to which those that later equilibrium leaves open are nearest.
    pub(super) fn keep_tractions(&mut self) {
        let mut histories = self.joint_histories();
        for record in histories.iter_mut().flat_map(|joint| &mut joint.records) {
            record.reference = None;
        }
        self.restore_joints(&histories);
    }

    /// Makes sliding pairs stick in static equilibrium at a displacement (m, engine numbering), and discards the impact
    /// losses of the relaxation, whose masses are fictitious.
    pub(super) fn stick_joints(&mut self, before: &[JointHistory], u: &[Vec3]) {
        let mut histories = Vec::new();
        for (joint, before) in self.joints().zip(before) {
            let mut history = JointHistory::from(&joint);
            let records = history.records.iter_mut().zip(&before.records);
            for ((record, before), pair) in records.zip(joint.pairs) {
                record.impact = before.impact;
                if record.state.contact == ContactState::Slide {
                    record.state.contact = ContactState::Stick;
                    let [first, second] = pair.nodes.map(|node| u[self.engine(node)]);
                    let offset = pair.to_local(&(second - first)) - record.origin();
                    record.anchor = Some([offset.y, offset.z]);
                }
            }
            histories.push(history);
        }
        self.restore_joints(&histories);
    }

    /// Computes the tractions of joints in static equilibrium, and refuses joints whose law does not admit them.
    pub(super) fn load_joints(&mut self) -> Result<(), StaticError> {
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
        let connected = self.connected_pairs(ConnectedPairs::Sticking).len();
        let before = self.joint_histories();
        let mut references = before.clone();
        let mut holds = false;
        for attempt in [Attempt::AsStressed, Attempt::WithoutThose, Attempt::Least] {
            self.release_references(attempt, &before, &mut references);
            self.restore_joints(&references);
            self.prepare_joints(SOME_STEP, &inverse);
            let mut velocity = velocity.clone();
            let motion = (&displacement[..], &still[..]);
            self.correct_joints(SOME_STEP, motion, &mut velocity, &inverse)?;
            holds = self.connected_pairs(ConnectedPairs::Sticking).len() == connected;
            if self.on_all_ranks(holds) {
                return Ok(());
            }
        }
        self.agreed(self.check_joints(ConnectedPairs::Sticking))?;
        if holds {
            return self.agreed(Ok(()));
        }
        let mut moved = (String::new(), 0, 0);
        for joint in self.joints() {
            let states = joint.records.iter().map(|record| record.state.contact);
            let open = states.filter(|state| *state == ContactState::Open).count();
            if open > moved.1 {
                moved = (joint.name.into(), open, joint.pairs.len());
            }
        }
        let (joint, pairs, of) = moved;
        self.agreed(Err(StaticError::JointMoves { joint, pairs, of }))
    }
}
