//! Joints and ties in statics: what holds together is one, as long as its law admits it.

use powerhouse_model::{ContactState, Mat3, PredictedMotion, Vec3};

use super::{Parts, StaticError};
use crate::Model;
use crate::groups::Group;

/// The length of step (s) in which joints are asked for their tractions at rest; forces do not
/// depend on it.
const SOME_STEP: f64 = 1.0e-4;

impl Model {
    /// Engine nodes of the pairs that constraints hold together: ties, and pairs of joints that stick.
    fn held_pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        for bound in &self.constraints {
            pairs.extend(bound.constraint.ties());
            for joint in bound.constraint.joints() {
                let together = joint.pairs.iter().zip(joint.records);
                let together = together.filter(|(_, r)| r.state.contact == ContactState::Stick);
                pairs.extend(together.map(|(pair, _)| pair.nodes));
            }
        }
        let engine = |pair: [u32; 2]| pair.map(|node| self.engine(node) as u32);
        pairs.into_iter().map(engine).collect()
    }

    /// Refuses constraints that know neither ties nor joints, and joints with pairs that slide.
    pub(super) fn check_joints(&self) -> Result<(), StaticError> {
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
                if sliding > 0 {
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
    pub(super) fn each_held_pair(&self, mut join: impl FnMut(u32, u32)) {
        for pair in self.held_pairs() {
            let [a, b] = pair.map(|node| self.numbering.mesh_of[node as usize]);
            join(a, b);
        }
    }

    /// The groups of the model, those that held pairs connect made one.
    pub(super) fn joined_groups(&self) -> Result<Vec<Group>, StaticError> {
        let groups = &self.groups.groups;
        let mut parts = Parts::new(groups.len());
        for [a, b] in self.held_pairs() {
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
        let displacement = self.displacements();
        let groups = &self.groups.groups;
        let held = self.held_pairs().len();
        for bound in &mut self.constraints {
            let nodes = bound.nodes();
            let of = |node: &u32| {
                let group = self.group_of[*node as usize].map(|g| &groups[g as usize]);
                let lead = group.map_or(*node, |group| group.members[0]) as usize;
                let mass = group.map_or(self.mass[*node as usize], |group| group.mass);
                let inverse = match mass > 0.0 {
                    true => Mat3::identity() / mass,
                    false => Mat3::zeros(),
                };
                let inverse = match group {
                    Some(group) => group.condition.project(&inverse).0,
                    None => inverse,
                };
                (inverse, inverse * forces[lead] * SOME_STEP)
            };
            let (inverse, mut velocity): (Vec<Mat3>, Vec<Vec3>) = nodes.iter().map(of).unzip();
            let here: Vec<Vec3> = nodes.iter().map(|&n| displacement[n as usize]).collect();
            let still = vec![Vec3::zeros(); here.len()];
            bound.constraint.prepare(SOME_STEP, &inverse);
            let when = (self.number, self.time, SOME_STEP);
            let motion = PredictedMotion::new(when, &here, &still, &mut velocity, &inverse);
            if let Err(error) = bound.constraint.correct(motion) {
                return Err(StaticError::Joint {
                    name: bound.constraint.name().into(),
                    reason: error.to_string(),
                });
            }
        }
        // The matrices of the joints are those of another step now.
        self.prepared = None;
        if self.held_pairs().len() == held {
            return Ok(());
        }
        self.check_joints()?;
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
