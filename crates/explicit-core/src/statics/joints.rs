//! Joints and ties in statics: what holds together is one, as long as its law admits it.

use powerhouse_model::{ContactState, JointHistory, Mat3, PredictedMotion, StepTime, Vec3};

use super::{Parts, StaticError};
use crate::Model;
use crate::groups::Group;
use crate::model::least_mass;

/// The length of step (s) in which joints are asked for their tractions at rest; forces do not
/// depend on it.
const SOME_STEP: f64 = 1.0e-4;

/// Which pairs of joints count as held together, beside ties.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Held {
    /// Those that stick.
    Sticking,
    /// All that are not open.
    Closed,
}

impl Model {
    /// Engine nodes of the pairs that constraints hold together.
    fn held_pairs(&self, held: Held) -> Vec<[u32; 2]> {
        let together = |state: ContactState| match held {
            Held::Sticking => state == ContactState::Stick,
            Held::Closed => state != ContactState::Open,
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

    /// Refuses constraints that know neither ties nor joints, and joints with pairs that slide unless
    /// they may.
    pub(super) fn check_joints(&self, held: Held) -> Result<(), StaticError> {
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
                if sliding > 0 && held == Held::Sticking {
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

    /// Calls `join` with the mesh nodes of every pair that is held together.
    pub(super) fn each_held_pair(&self, held: Held, mut join: impl FnMut(u32, u32)) {
        for pair in self.held_pairs(held) {
            let [a, b] = pair.map(|node| self.numbering.mesh_of[node as usize]);
            join(a, b);
        }
    }

    /// The groups of the model, those that held pairs connect made one.
    pub(super) fn joined_groups(&self) -> Result<Vec<Group>, StaticError> {
        let groups = &self.groups.groups;
        let mut parts = Parts::new(groups.len());
        for [a, b] in self.held_pairs(Held::Sticking) {
            // Nodes of constraints always have groups.
            if let (Some(a), Some(b)) = (self.group_of[a as usize], self.group_of[b as usize]) {
                parts.join(a, b);
            }
        }
        let mut joined: Vec<Option<Group>> = vec![None; groups.len()];
        for (place, group) in groups.iter().enumerate() {
            let root = parts.root(place as u32) as usize;
            let Some(whole) = &mut joined[root] else {
                joined[root] = Some(group.clone());
                continue;
            };
            whole.members.extend_from_slice(&group.members);
            if whole.mass <= 0.0 {
                // A node that has lost its elements does not lead: forces on it are dropped.
                let gone = whole.members.len() - group.members.len();
                whole.members.rotate_left(gone);
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
        Ok(joined.into_iter().flatten().collect())
    }

    /// The lead of a node's group.
    fn lead(&self, node: u32) -> usize {
        self.members(&node)[0] as usize
    }

    /// Tells the constraints the length of the steps (s) to come, and the inverse effective masses of
    /// leads (1/kg, engine numbering).
    pub(super) fn prepare_joints(&mut self, step: f64, inverse: &[Mat3]) {
        let mut constraints = core::mem::take(&mut self.constraints);
        for bound in &mut constraints {
            let leads = bound.nodes().iter().map(|&node| self.lead(node));
            let inverse: Vec<Mat3> = leads.map(|lead| inverse[lead]).collect();
            bound.constraint.prepare(step, &inverse);
        }
        self.constraints = constraints;
        // The matrices of the joints are those of another step now.
        self.prepared = None;
    }

    /// Lets the constraints correct the velocities of leads (m/s, engine numbering) in a step, from a
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
        corrected
    }

    /// Contact states and history variables of the joints.
    pub(super) fn joint_histories(&self) -> Vec<JointHistory> {
        let joints = self.joints();
        joints.map(|joint| JointHistory::from(&joint)).collect()
    }

    /// Puts the joints into an earlier state.
    pub(super) fn restore_joints(&mut self, histories: &[JointHistory]) {
        for history in histories {
            for bound in &mut self.constraints {
                if bound.constraint.restore(history) {
                    break;
                }
            }
        }
    }

    /// Lets what slid stick where it has come to rest at a displacement (m, engine numbering), and
    /// forgets the impacts of the way there, which are those of masses that are none.
    pub(super) fn rest_joints(&mut self, before: &[JointHistory], u: &[Vec3]) {
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

    /// Lets the joints take the forces that hold them at rest, and refuses those whose law does not.
    pub(super) fn load_joints(&mut self) -> Result<(), StaticError> {
        if self.constraints.is_empty() {
            return Ok(());
        }
        self.forces_at_rest(0.0)?;
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
        let (groups, least) = (&self.groups.groups, least_mass(&self.mass));
        let free = |mass: f64| Mat3::identity() / mass;
        let inverse = |node: usize| match self.group_of[node].map(|g| &groups[g as usize]) {
            Some(group) => {
                (group.ghost(least)).unwrap_or_else(|| group.condition.project(&free(group.mass)).0)
            }
            None if self.mass[node] > 0.0 => free(self.mass[node]),
            None => Mat3::zeros(),
        };
        let inverse: Vec<Mat3> = (0..self.mass.len()).map(inverse).collect();
        let mut velocity: Vec<Vec3> = (inverse.iter().zip(&forces))
            .map(|(inverse, force)| inverse * force * SOME_STEP)
            .collect();
        let displacement = self.displacements();
        let still = vec![Vec3::zeros(); displacement.len()];
        let held = self.held_pairs(Held::Sticking).len();
        self.prepare_joints(SOME_STEP, &inverse);
        self.correct_joints(SOME_STEP, (&displacement, &still), &mut velocity, &inverse)?;
        if self.held_pairs(Held::Sticking).len() == held {
            return Ok(());
        }
        self.check_joints(Held::Sticking)?;
        let mut moved = (String::new(), 0, 0);
        for joint in self.joints() {
            let states = joint.records.iter().map(|record| record.state.contact);
            let open = states.filter(|state| *state == ContactState::Open).count();
            if open > moved.1 {
                moved = (joint.name.into(), open, joint.pairs.len());
            }
        }
        let (joint, pairs, of) = moved;
        Err(StaticError::JointMoves { joint, pairs, of })
    }
}
