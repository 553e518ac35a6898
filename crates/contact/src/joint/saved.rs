//! State of the joints of a constraint between two steps.

use std::collections::{HashMap, VecDeque};

use powerhouse_model::{JointRecord, StateError, decode, encode};
use serde::{Deserialize, Serialize};

use super::solve::Effort;
use super::{Joint, Members};

/// Saved state of the joints of a constraint.
#[derive(Debug, Serialize, Deserialize)]
struct SavedJoint {
    /// Names of the joints, and the nodes of all their pairs.
    names: Vec<String>,
    nodes: Vec<[u32; 2]>,
    /// Number of pairs of each joint, and of history variables of its law.
    members: Vec<(usize, usize)>,
    records: Vec<JointRecord>,
    history: Vec<f64>,
    effort: Effort,
}

impl<L> Joint<L> {
    fn names(&self) -> Vec<String> {
        self.members
            .iter()
            .map(|member| member.name.clone())
            .collect()
    }

    /// State between two steps.
    pub(super) fn encoded(&self) -> Result<Vec<u8>, StateError> {
        encode(&SavedJoint {
            names: self.names(),
            nodes: self.pairs.iter().map(|pair| pair.nodes).collect(),
            members: (self.members.iter())
                .map(|member| (member.pairs().len(), member.variables))
                .collect(),
            records: self.records.clone(),
            history: self.history.clone(),
            effort: self.effort,
        })
    }

    /// Restores the state of those pairs that the saved joints have too, which are equal to these but for their pairs.
    pub(super) fn put_parts(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let saved: SavedJoint = decode(bytes)?;
        StateError::expect_same("the list of joints", &saved.names, &self.names())?;
        let found: Vec<usize> = saved.members.iter().map(|&(_, count)| count).collect();
        let here: Vec<usize> = self.members.iter().map(|own| own.variables).collect();
        StateError::expect_same("the numbers of history variables", found, here)?;
        // Pairs of the same nodes, of the patches at an edge, are in the order of the joint on both sides.
        let mut own: HashMap<[u32; 2], VecDeque<usize>> = HashMap::new();
        for (pair, geometry) in self.pairs.iter().enumerate() {
            own.entry(geometry.nodes).or_default().push_back(pair);
        }
        let of_pairs = (saved.members.iter()).flat_map(|&(pairs, count)| vec![count; pairs]);
        let mut history = saved.history.as_slice();
        for ((nodes, record), count) in saved.nodes.iter().zip(&saved.records).zip(of_pairs) {
            let values = history.split_off(..count).ok_or(StateError::Unexpected)?;
            let Some(pair) = own.get_mut(nodes).and_then(VecDeque::pop_front) else {
                continue;
            };
            let member = Members(&self.members).of(pair);
            self.sides[pair].origin = member.origin(record);
            self.records[pair] = *record;
            let at = member.history_of(pair);
            self.history[at].copy_from_slice(values);
        }
        self.effort.sweeps = self.effort.sweeps.max(saved.effort.sweeps);
        self.effort.residual = self.effort.residual.max(saved.effort.residual);
        // What is prepared holds the origins of pairs.
        self.prepared = None;
        Ok(())
    }

    /// Restores the state of equal joints.
    pub(super) fn put_saved(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let saved: SavedJoint = decode(bytes)?;
        StateError::expect_same("the list of joints", saved.names, self.names())?;
        let same_pairs = (self.pairs.iter().map(|pair| pair.nodes)).eq(saved.nodes);
        StateError::expect_same("whether its pairs are the same", same_pairs, true)?;
        StateError::expect_same("the number of pairs", saved.records.len(), self.pairs.len())?;
        let (found, expected) = (saved.history.len(), self.history.len());
        StateError::expect_same("the number of history variables", found, expected)?;
        for member in &self.members {
            for pair in member.pairs() {
                self.sides[pair].origin = member.origin(&saved.records[pair]);
            }
        }
        (self.records, self.history) = (saved.records, saved.history);
        self.effort = saved.effort;
        // What is prepared holds the origins of pairs.
        self.prepared = None;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use powerhouse_model::{
        Constraint, JointConstraint, JointPair, Mat3, PredictedMotion, SavedState, StepTime, Vec3,
    };

    use super::*;
    use crate::BondedCoulomb;

    fn joint(name: &str) -> Joint<BondedCoulomb> {
        let pairs = [[0, 1], [0, 2]].map(|nodes| JointPair::new(nodes, Vec3::z(), 1.0));
        let law = BondedCoulomb::unbonded(0.6, 0.5).unwrap();
        Joint::new(name, pairs.to_vec(), law).unwrap()
    }

    /// Moves the nodes of a joint by a step, and returns the bits of their velocities after it.
    fn step(joint: &mut Joint<BondedCoulomb>, number: u64) -> Vec<u64> {
        let step = 1e-3;
        let moved = Vec3::new(2e-3 * number as f64, 0.0, -1e-5);
        let displacement = [Vec3::zeros(), moved, moved * 0.5];
        let before = [Vec3::zeros(), Vec3::x(), Vec3::x()];
        let mut after = [
            Vec3::zeros(),
            Vec3::new(1.0, 0.2, -0.4),
            Vec3::new(0.9, 0.0, -0.1),
        ];
        let mass = [0.5, 0.3, 0.2].map(|inverse| Mat3::identity() * inverse);
        let when = StepTime {
            number,
            time: number as f64 * step,
            step,
        };
        let motion = PredictedMotion::new(when, &displacement, &before, &mut after, &mass);
        joint.correct(motion).unwrap();
        after
            .iter()
            .flat_map(|v| [v.x, v.y, v.z])
            .map(f64::to_bits)
            .collect()
    }

    /// A joint that is saved and restored into a new one goes on with the same bits and the same effort; the state of
    /// another joint is refused.
    #[test]
    fn a_restored_joint_goes_on_with_the_same_bits() {
        let mut whole = joint("a");
        for number in 0..3 {
            step(&mut whole, number);
        }
        let saved = whole.save_state().unwrap();
        let mut restored = joint("a");
        restored.restore_state(&saved).unwrap();
        for number in 3..6 {
            assert_eq!(step(&mut restored, number), step(&mut whole, number));
        }
        assert_eq!(restored.records(), whole.records());
        assert!(whole.records()[0].friction > 0.0, "nothing slid");
        let [a, b] = [&restored, &whole].map(|joint| joint.joints()[0].most_sweeps);
        assert!(a == b && b > 0, "{a} {b}");
        let refused = joint("b").restore_state(&saved);
        assert!(
            matches!(refused, Err(StateError::Foreign { .. })),
            "{refused:?}"
        );
    }
}
