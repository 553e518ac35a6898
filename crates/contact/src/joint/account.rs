//! What a step has done to a pair.

use powerhouse_model::{Bond, ConstraintWork, ContactState, JointRecord, JointState, Vec3};

/// A pair's step: everything along its normal and tangents.
pub(super) struct PairStep {
    /// Time at its start and length (s).
    pub(super) time: f64,
    pub(super) length: f64,
    /// Area of the pair (m2).
    pub(super) area: f64,
    /// Traction that acts without the joint's forces (Pa).
    pub(super) preload: Vec3,
    /// Displacement of the second side relative to the first at the start (m), gap included.
    pub(super) offset: Vec3,
    /// Relative velocity before and after (m/s).
    pub(super) before: Vec3,
    pub(super) after: Vec3,
    /// Traction on the first side (Pa), preload included.
    pub(super) traction: Vec3,
    /// What the law made of the state.
    pub(super) state: JointState,
}

/// Writes a step into the pair's record and adds its work.
///
/// Of a traction `T` on area `A` that meets the mean relative velocity `w` of a step the body loses
/// `A dt T . w`: the normal part where sides meet, the tangential part by friction, both by the bond
/// in the step in which it breaks. The joint's own forces are those of `T - T0`, so the work of the
/// preload `T0`, which belongs to stresses outside the ledger, comes from outside.
#[inline(always)]
pub(super) fn book(record: &mut JointRecord, step: &PairStep, work: &mut ConstraintWork) {
    let old = record.state;
    let slides = step.state.contact == ContactState::Slide;
    let opens = step.state.contact == ContactState::Open;
    let path = (step.before + step.after) * (0.5 * step.length * step.area);
    let across = step.traction.x * path.x;
    let along = step.traction.y * path.y + step.traction.z * path.z;
    if old.bond == Bond::Intact && step.state.bond == Bond::Broken {
        record.bond_energy += across + along;
        work.bond += across + along;
    } else {
        record.impact += across;
        record.friction += along;
        work.impact += across;
        work.friction += along;
    }
    work.external -= step.preload.dot(&path);

    let mut slip = old.slip;
    if slides {
        let velocity = step.after;
        slip += (velocity.y * velocity.y + velocity.z * velocity.z).sqrt() * step.length;
        record.first_slip.get_or_insert(step.time);
    } else if opens {
        record.first_crack.get_or_insert(step.time);
    } else if old.contact != ContactState::Stick || record.anchor.is_none() {
        record.anchor = Some([step.offset.y, step.offset.z]);
    }
    record.state = JointState { slip, ..step.state };
    record.traction = step.traction;
    record.opening = step.offset.x;
    record.peak_opening = record.peak_opening.max(step.offset.x);
}
