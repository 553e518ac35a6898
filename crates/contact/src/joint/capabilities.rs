//! What a joint has in addition to its correction of motions: views and states of its pairs, parts, couplings, saved states.

use std::collections::HashSet;

use powerhouse_model::{
    ConstraintParts, ContactLaw, ContactState, CoupledConstraint, DividedConstraint, DividedWork,
    JointConstraint, JointHistory, JointRecord, JointView, NodeCoupling, Renewal,
    RestrictedConstraint, SavedState, StateError, Vec3,
};

use super::Joint;
use super::history::{in_order_of, restored_history};
use super::solve::Effort;
use crate::connected::connected_pairs;

impl<L: ContactLaw> JointConstraint for Joint<L> {
    fn add_joint_forces(&self, out: &mut [Vec3]) {
        let pairs = self.pairs.iter().zip(&self.records).zip(&self.sides);
        for (((pair, record), side), nodes) in pairs.zip(&self.pair_nodes) {
            let force = pair.to_global(&(record.traction - side.preload)) * pair.projected_area;
            out[nodes[0] as usize] += force;
            out[nodes[1] as usize] -= force;
        }
    }

    fn keep_tractions(&mut self) {
        for (record, side) in self.records.iter_mut().zip(&self.sides) {
            if record.reference.is_none() && record.state.contact != ContactState::Open {
                record.reference = Some((record.traction - side.preload).into());
                // How pairs can be solved depends on it.
                self.prepared = None;
            }
        }
    }

    fn joints(&self) -> Vec<JointView<'_>> {
        let Effort { sweeps, residual } = self.effort;
        let views = self.members.iter().map(|member| {
            let (pairs, records) = (&self.pairs[member.pairs()], &self.records[member.pairs()]);
            JointView::new(&member.name, member.law.name(), pairs, records)
                .with_smooth(member.law.is_smooth())
                .with_history(member.law.history(), &self.history[member.history()])
                .with_effort(sweeps, residual)
        });
        views.collect()
    }

    fn restore(&mut self, history: &JointHistory) -> bool {
        let Some(member) = self.members.iter().find(|m| m.name == history.name) else {
            return false;
        };
        let Some(found) = in_order_of(&self.pairs[member.pairs()], history) else {
            return false;
        };
        let Some(values) = restored_history(&member.law, history, &found) else {
            return false;
        };
        for (index, &earlier) in member.pairs().zip(&found) {
            let record = history.records[earlier];
            let (side, origin) = (&mut self.sides[index], member.origin(&record));
            // What is prepared holds the origins of pairs, and how their references let them be solved.
            if side.origin != origin || self.records[index].reference != record.reference {
                side.origin = origin;
                self.prepared = None;
            }
            self.records[index] = record;
        }
        self.history[member.history()].copy_from_slice(&values);
        true
    }

    fn begin_relaxation(&mut self, start: &[JointHistory]) {
        self.start = Some(self.start_from(start));
    }

    fn take_back(&mut self, share: f64) {
        if let Some(start) = &mut self.start {
            start.share = share;
        }
    }

    fn end_relaxation(&mut self) {
        self.close_bonds();
        self.start = None;
    }

    fn renew(&mut self, joint: &str, renewal: Renewal, displacement: &[Vec3]) -> bool {
        let Some(member) = self.members.iter().find(|member| member.name == joint) else {
            return false;
        };
        for index in member.pairs() {
            let [first, second] = self.pair_nodes[index].map(|node| displacement[node as usize]);
            let mut closed_at = self.pairs[index].to_local(&(second - first));
            let (side, record) = (&mut self.sides[index], &mut self.records[index]);
            if renewal == Renewal::Grouted {
                closed_at.x += side.gap;
                *record = JointRecord::new(member.law.initial()).with_traction(side.preload);
                member
                    .law
                    .initial_history(&mut self.history[member.history_of(index)]);
            } else if record.dilation != 0.0 {
                // Asperities that ride on each other go on doing so.
                closed_at.x -= record.dilation;
            }
            record.closed_at = Some(closed_at.into());
            side.origin = member.origin(record);
        }
        self.prepared = None;
        true
    }

    fn keep_state(&mut self) {
        let (records, history, effort) = &mut self.kept;
        records.clone_from(&self.records);
        history.clone_from(&self.history);
        *effort = self.effort;
    }

    fn return_to_kept(&mut self) {
        let (records, history, effort) = &self.kept;
        self.records.clone_from(records);
        self.history.clone_from(history);
        self.effort = *effort;
    }
}

impl<L: ContactLaw> DividedConstraint for Joint<L> {
    fn parts(&self) -> ConstraintParts {
        let coupled = self.couplings.iter().map(|coupling| coupling.nodes);
        let coupled: Vec<[u32; 2]> = coupled
            .map(|nodes| nodes.map(|node| self.nodes[node as usize]))
            .collect();
        let pairs = self.pairs.iter().map(|pair| &pair.nodes);
        ConstraintParts::merged(pairs.chain(&coupled).map(|nodes| &nodes[..]))
    }

    fn divided_work(&self) -> Option<DividedWork<'_>> {
        Some(DividedWork {
            nodes: &self.first_nodes,
            work: &self.work,
        })
    }
}

impl<L: ContactLaw> RestrictedConstraint for Joint<L> {
    fn keep_parts(&mut self, kept: &[bool]) {
        let parts = self.parts();
        let nodes: HashSet<u32> = (parts.iter().zip(kept))
            .filter(|(_, kept)| **kept)
            .flat_map(|(nodes, _)| nodes.iter().copied())
            .collect();
        self.retain(|pair| nodes.contains(&pair.nodes[0]));
    }

    fn restore_parts(&mut self, saved: &[u8]) -> Result<(), StateError> {
        self.put_parts(saved)
    }
}

impl<L: ContactLaw> CoupledConstraint for Joint<L> {
    fn couple(&mut self, couplings: &[NodeCoupling]) {
        let nodes = |all: &[NodeCoupling]| -> Vec<[u32; 2]> {
            all.iter().map(|coupling| coupling.nodes).collect()
        };
        let is_connected = nodes(couplings) == nodes(&self.couplings);
        self.couplings = couplings.to_vec();
        if !is_connected {
            let pairs: Vec<[u32; 2]> = self.pairs.iter().map(|pair| pair.nodes).collect();
            self.connected = connected_pairs(&pairs, &self.parts());
        }
        self.prepared = None;
    }
}

impl<L: ContactLaw> SavedState for Joint<L> {
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        self.encoded()
    }

    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        self.put_saved(saved)
    }
}
