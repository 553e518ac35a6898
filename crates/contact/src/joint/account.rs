//! What a step has done to a pair.

use powerhouse_model::{Bond, ConstraintWork, ContactState, JointRecord, JointState, Vec3};

/// A pair's step: everything along its normal and tangents.
pub(super) struct PairStep {
    /// Time at its start and length (s).
    pub(super) time: f64,
    pub(super) length: f64,
    /// Area of the pair over which forces are tractions (m2).
    pub(super) area: f64,
    /// Traction that acts without the joint's forces (Pa).
    pub(super) preload: Vec3,
    /// Displacement of the second side relative to the first at the start (m), gap included, from
    /// the pair's origin.
    pub(super) offset: Vec3,
    /// Relative velocity before and after (m/s).
    pub(super) before: Vec3,
    pub(super) after: Vec3,
    /// Traction on the first side (Pa), preload included.
    pub(super) traction: Vec3,
    /// What the law made of the state.
    pub(super) state: JointState,
}

/// What a step has done, and its work.
pub(super) struct Outcome {
    /// Time at the step's start (s).
    pub(super) time: f64,
    /// Displacement of the second side relative to the first at the start (m), gap included, from
    /// the pair's origin.
    pub(super) offset: Vec3,
    /// Traction on the first side (Pa), preload included.
    pub(super) traction: Vec3,
    /// What the law made of the state.
    pub(super) state: JointState,
    /// Work that the body loses across the pair and along it (J).
    pub(super) across: f64,
    pub(super) along: f64,
    /// Length of the path along the tangents (m) if it slides.
    pub(super) path: f64,
}

/// Writes a step into the pair's record and adds its work.
///
/// Of a traction `T` on area `A` that meets the mean relative velocity `w` of a step the body loses
/// `A dt T . w`: the normal part where sides meet, the tangential part by friction, both by the bond
/// in the step in which it breaks. The joint's own forces are those of `T - T0`, so the work of the
/// preload `T0`, which belongs to stresses outside the ledger, comes from outside.
pub(super) fn book(record: &mut JointRecord, step: &PairStep, work: &mut ConstraintWork) {
    let path = (step.before + step.after) * (0.5 * step.length * step.area);
    let slip = step.after.y * step.after.y + step.after.z * step.after.z;
    let outcome = Outcome {
        time: step.time,
        offset: step.offset,
        traction: step.traction,
        state: step.state,
        across: step.traction.x * path.x,
        along: step.traction.y * path.y + step.traction.z * path.z,
        path: slip.sqrt() * step.length,
    };
    enter(record, &outcome, work);
    work.external -= step.preload.dot(&path);
}

/// Writes a step into the pair's record, and adds its work but that of the preload.
#[inline(always)]
pub(super) fn enter(record: &mut JointRecord, step: &Outcome, work: &mut ConstraintWork) {
    let old = record.state;
    if old.bond == Bond::Intact && step.state.bond == Bond::Broken {
        record.bond_energy += step.across + step.along;
        work.bond += step.across + step.along;
    } else {
        record.impact += step.across;
        record.friction += step.along;
        work.impact += step.across;
        work.friction += step.along;
    }
    let mut slip = old.slip;
    match step.state.contact {
        ContactState::Slide => {
            slip += step.path;
            record.first_slip.get_or_insert(step.time);
        }
        ContactState::Open => {
            record.first_crack.get_or_insert(step.time);
        }
        ContactState::Stick => {
            if old.contact != ContactState::Stick || record.anchor.is_none() {
                record.anchor = Some([step.offset.y, step.offset.z]);
            }
        }
    }
    record.state = JointState { slip, ..step.state };
    record.traction = step.traction;
    record.opening = step.offset.x;
    record.peak_opening = record.peak_opening.max(step.offset.x);
}
