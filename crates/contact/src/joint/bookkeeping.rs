//! Records and energies of a pair after a step.

use powerhouse_model::{
    Bond, BondEnergies, ConstraintWork, ContactLaw, ContactState, JointRecord, JointState, Vec3,
};

/// Share of its opening below which the slip of an open pair is rounding.
const ROUNDED_SLIP: f64 = 1e-9;

/// Step of a pair that was solved with others; vectors along its normal and tangents.
pub(super) struct PairStep {
    /// Time at the start of the step and length of the step (s).
    pub(super) time: f64,
    pub(super) length: f64,
    /// Area of the pair over which forces are tractions (m2).
    pub(super) area: f64,
    /// Traction that acts without the forces of the joint (Pa).
    pub(super) preload: Vec3,
    /// Displacement of the second side relative to the first at the start (m), gap included, from
    /// the origin of the pair.
    pub(super) offset: Vec3,
    /// Relative velocity before and after (m/s).
    pub(super) before: Vec3,
    pub(super) after: Vec3,
    /// Traction on the first side (Pa), preload included.
    pub(super) traction: Vec3,
    /// New state by the law.
    pub(super) state: JointState,
    /// New dilation by the law (m).
    pub(super) dilation: f64,
    /// Changes of the energies of a bond that fails gradually (J).
    pub(super) bond: Option<BondEnergies>,
}

/// Outcome of a step of a pair, with its work.
pub(super) struct Outcome {
    /// Time at the start of the step (s).
    pub(super) time: f64,
    /// Displacement of the second side relative to the first at the start (m), gap included, from
    /// the origin of the pair.
    pub(super) offset: Vec3,
    /// Traction on the first side (Pa), preload included.
    pub(super) traction: Vec3,
    /// New state by the law.
    pub(super) state: JointState,
    /// New dilation by the law (m); read of laws with history only.
    pub(super) dilation: f64,
    /// Changes of the energies of a bond that fails gradually (J).
    pub(super) bond: Option<BondEnergies>,
    /// Work that the body loses along the normal of the pair and along its tangents (J).
    pub(super) across: f64,
    pub(super) along: f64,
    /// Length of the tangential path (m) if the pair slides.
    pub(super) path: f64,
}

/// Changes of the energies of a pair's bond (J) by its history variables before and after a step; none where the bond
/// does not fail gradually.
#[inline(always)]
pub(super) fn bond_energy<L: ContactLaw>(
    law: &L,
    old: &[f64],
    new: &[f64],
    area: f64,
) -> Option<BondEnergies> {
    let (old, new) = (law.bond_energies(old)?, law.bond_energies(new)?);
    Some(BondEnergies::new(
        (new.stored - old.stored) * area,
        (new.dissipated - old.dissipated) * area,
        (new.friction - old.friction) * area,
    ))
}

/// Updates the record of a pair by a step and adds the work of the step.
///
/// Of a traction `T` on area `A` that meets the mean relative velocity `w` of a step the body loses
/// `A dt T . w`: the normal part by impact, the tangential part by friction, both by the bond in the step
/// in which it breaks. The joint's own forces are those of `T - T0`, so the work of the preload `T0`,
/// which belongs to stresses that the ledger does not have, is external. Of the work on a bond that fails gradually the part
/// that it neither stores nor dissipates, nor friction beside it, counts as impact: it is that of faces that close, and the
/// error of the steps.
pub(super) fn update_by_step<const HISTORY: bool>(
    record: &mut JointRecord,
    step: &PairStep,
    work: &mut ConstraintWork,
) {
    let path = (step.before + step.after) * (0.5 * step.length * step.area);
    let slip = step.after.y * step.after.y + step.after.z * step.after.z;
    let outcome = Outcome {
        time: step.time,
        offset: step.offset,
        traction: step.traction,
        state: step.state,
        dilation: step.dilation,
        bond: step.bond,
        across: step.traction.x * path.x,
        along: step.traction.y * path.y + step.traction.z * path.z,
        path: slip.sqrt() * step.length,
    };
    update::<HISTORY>(record, &outcome, work);
    work.external -= step.preload.dot(&path);
}

/// Updates the record of a pair by the outcome of a step, and adds its work but that of the preload.
///
/// A closed pair that dilates moves along its normal without impact: that work counts into friction,
/// which is then the net dissipation of slip and opening.
#[inline(always)]
pub(super) fn update<const HISTORY: bool>(
    record: &mut JointRecord,
    step: &Outcome,
    work: &mut ConstraintWork,
) {
    let old = record.state;
    let closed = |state: &JointState| state.contact != ContactState::Open;
    let dilates = HISTORY
        && (record.dilation != 0.0 || step.dilation != 0.0)
        && closed(&old)
        && closed(&step.state);
    // A bond that fails gradually splits the work itself, until the step in which it has failed.
    let softens = step.state.bond == Bond::Softening || old.bond == Bond::Softening;
    let fails = old.bond == Bond::Intact && step.state.bond == Bond::Broken;
    let gradual = step.bond.filter(|_| softens || fails);
    if let Some(bond) = gradual {
        // Work is that between the middles of steps, energies of the bond are those at its displacement.
        let on_bond = step.along - bond.friction
            + if closed(&step.state) {
                0.0
            } else {
                step.across
            };
        let late = if step.state.bond == Bond::Softening {
            0.5 * on_bond
        } else {
            0.0
        };
        let stored = bond.stored + late - record.late_work;
        record.late_work = late;
        let rest = step.across + step.along - stored - bond.dissipated - bond.friction;
        record.bond_energy += bond.dissipated;
        record.friction += bond.friction;
        record.impact += rest;
        work.stored += stored;
        work.bond += bond.dissipated;
        work.friction += bond.friction;
        work.impact += rest;
    } else if fails {
        record.bond_energy += step.across + step.along;
        work.bond += step.across + step.along;
    } else if dilates {
        record.friction += step.across + step.along;
        work.friction += step.across + step.along;
    } else {
        record.impact += step.across;
        record.friction += step.along;
        work.impact += step.across;
        work.friction += step.along;
    }
    record.coming_slip = 0.0;
    match step.state.contact {
        ContactState::Slide => {
            record.coming_slip = step.path;
            record.first_slip.get_or_insert(step.time);
        }
        ContactState::Open => {
            record.first_crack.get_or_insert(step.time);
            // The sides of a bond that softens slip past each other whether they touch or not.
            if softens {
                record.coming_slip = step.path;
                if old.slip + step.path > ROUNDED_SLIP * step.offset.x.abs() {
                    record.first_slip.get_or_insert(step.time);
                }
            }
        }
        ContactState::Stick => {
            if old.contact != ContactState::Stick || record.anchor.is_none() {
                record.anchor = Some([step.offset.y, step.offset.z]);
            }
        }
    }
    record.state = step.state.with_slip(old.slip + record.coming_slip);
    record.traction = step.traction;
    record.opening = step.offset.x;
    record.peak_opening = record.peak_opening.max(step.offset.x);
    if HISTORY {
        record.dilation = step.dilation;
    }
}
