//! Joints in a dynamic relaxation: its pseudo-motion damages no bond, and its way is no slip.

use powerhouse_model::{Bond, ContactLaw, ContactState, JointHistory, JointRecord, Vec3};

use super::Joint;
use super::history::{in_order_of, restored_history};

/// State of the pairs of a joint at the start of an increment of a dynamic relaxation.
#[derive(Clone, Debug)]
pub(super) struct Start {
    records: Vec<JointRecord>,
    /// History variables of the laws, as the joint has them.
    history: Vec<f64>,
    /// Share of the damage since then that the next step takes back.
    pub(super) share: f64,
}

impl<L: ContactLaw> Joint<L> {
    /// The state by the histories of the joints at the start, the present one for joints without.
    pub(super) fn start_from(&self, histories: &[JointHistory]) -> Start {
        let mut start = Start {
            records: self.records.clone(),
            history: self.history.clone(),
            share: 1.0,
        };
        for member in &self.members {
            let Some(history) = histories.iter().find(|history| history.name == member.name) else {
                continue;
            };
            let Some(found) = in_order_of(&self.pairs[member.pairs()], history) else {
                continue;
            };
            let Some(values) = restored_history(&member.law, history, &found) else {
                continue;
            };
            for (index, &earlier) in member.pairs().zip(&found) {
                start.records[index] = history.records[earlier];
            }
            start.history[member.history()].copy_from_slice(&values);
        }
        start
    }

    /// Before a step of a dynamic relaxation at a displacement (m): takes back a share of what bonds have lost since its start and
    /// peaks of openings, and counts slip no longer than the displacement from where a pair stuck then.
    pub(super) fn undo_pseudo_motion(&mut self, displacement: &[Vec3]) {
        let Some(start) = &self.start else {
            return;
        };
        for member in &self.members {
            for index in member.pairs() {
                let (record, former) = (&mut self.records[index], &start.records[index]);
                let slots = member.history_of(index);
                let history = &mut self.history[slots.clone()];
                if member.law.bond_energies(history).is_some() {
                    let old = (&former.state, &start.history[slots]);
                    (member.law).undo_damage(old, start.share, &mut record.state, history);
                    let lost = record.bond_energy - former.bond_energy;
                    record.bond_energy = former.bond_energy + (1.0 - start.share) * lost;
                }
                record.peak_opening = former.peak_opening;
                if former.state.contact == ContactState::Stick {
                    let [first, second] =
                        self.pair_nodes[index].map(|node| displacement[node as usize]);
                    let offset =
                        self.pairs[index].to_local(&(second - first)) - self.sides[index].origin;
                    let [along, across] = former.anchor.unwrap_or_default();
                    let moved = (offset.y - along).hypot(offset.z - across);
                    record.state.slip = record.state.slip.min(former.state.slip + moved);
                }
            }
        }
    }

    /// At the end of an increment: bonds that are back where they were intact at its start are intact.
    pub(super) fn close_bonds(&mut self) {
        let Some(start) = &self.start else {
            return;
        };
        for member in &self.members {
            for index in member.pairs() {
                let (record, former) = (&mut self.records[index], &start.records[index]);
                let slots = member.history_of(index);
                let (mut state, mut history) = (record.state, self.history[slots.clone()].to_vec());
                let old = (&former.state, &start.history[slots.clone()]);
                member.law.undo_damage(old, 1.0, &mut state, &mut history);
                if state.bond == Bond::Intact && record.state.bond != Bond::Intact {
                    record.state = state.with_slip(former.state.slip);
                    (record.first_slip, record.first_crack) =
                        (former.first_slip, former.first_crack);
                    record.anchor = former.anchor;
                    self.history[slots].copy_from_slice(&history);
                }
            }
        }
    }
}
