//! Initial conditions of the pairs of a joint: preload, gaps, and zones without a bond.

use powerhouse_model::{Bond, ContactLaw, JointInput, JointPair, ModelError, Vec3};

use super::{APART, Joint, Members};
use crate::ContactError;

impl<L: ContactLaw> Joint<L> {
    /// Sets the traction `sigma n` on the first side (Pa) in the static state from which displacements
    /// count, for each pair. The trial traction of the law is the sum of it and of that by motion.
    ///
    /// # Errors
    /// [`ContactError::Preload`] for one that the law does not admit, or across a gap.
    pub fn with_preload(
        mut self,
        traction: impl Fn(&JointPair) -> Vec3,
    ) -> Result<Self, ModelError> {
        let members = Members(&self.members);
        for (index, (pair, side)) in self.pairs.iter().zip(&mut self.sides).enumerate() {
            let preload = pair.to_local(&traction(pair));
            let (record, member) = (&mut self.records[index], members.of(index));
            let committed = &self.history[member.history_of(index)];
            let input = JointInput::new(preload, &record.state)
                .with_history(committed)
                .with_dilation(record.dilation)
                .with_site(pair.position, pair.projected_area);
            let mut new_history = committed.to_vec();
            let admitted = (member.law.admissible(&input, &mut new_history)).traction;
            let across_gap = side.gap > 0.0 && preload != Vec3::zeros();
            // A NaN is refused here, too.
            if admitted != preload || across_gap {
                let [first, second] = pair.nodes;
                return Err(ContactError::Preload {
                    first,
                    second,
                    normal: preload.x,
                    shear: preload.y.hypot(preload.z),
                }
                .into());
            }
            side.preload = preload;
            record.traction = preload;
        }
        self.prepared = None;
        Ok(self)
    }

    /// Sets the distance of the sides (m) in the state from which displacements count, for each pair. A
    /// pair with a gap has no bond.
    ///
    /// # Errors
    /// [`ContactError::Gap`] for one that is negative or not finite, of a law that
    /// [bears tension](ContactLaw::bears_tension) across it, or across which there is a preload.
    pub fn with_gaps(mut self, gap: impl Fn(&JointPair) -> f64) -> Result<Self, ModelError> {
        let members = Members(&self.members);
        for (index, (pair, side)) in self.pairs.iter().zip(&mut self.sides).enumerate() {
            let gap = gap(pair);
            let held = members.of(index).law.bears_tension() || side.preload != Vec3::zeros();
            if !(gap.is_finite() && gap >= 0.0) || (gap > 0.0 && held) {
                let [first, second] = pair.nodes;
                return Err(ContactError::Gap { first, second, gap }.into());
            }
            side.gap = gap;
            if gap > 0.0 {
                self.records[index].state = APART;
            }
        }
        self.prepared = None;
        Ok(self)
    }

    /// Removes the bond of the pairs for which `unbonded` is true, as where a joint was cracked before.
    ///
    /// # Errors
    /// [`ContactError::NoBond`] for one without a bond, or whose law
    /// [bears tension](ContactLaw::bears_tension) without.
    pub fn without_bond(
        mut self,
        unbonded: impl Fn(&JointPair) -> bool,
    ) -> Result<Self, ModelError> {
        let members = Members(&self.members);
        for (index, pair) in self
            .pairs
            .iter()
            .enumerate()
            .filter(|(_, pair)| unbonded(pair))
        {
            let state = &mut self.records[index].state;
            if state.bond != Bond::Intact || members.of(index).law.bears_tension() {
                let [first, second] = pair.nodes;
                return Err(ContactError::NoBond { first, second }.into());
            }
            state.bond = Bond::Never;
        }
        Ok(self)
    }
}
