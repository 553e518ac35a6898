//! Pairs that share no node with another, with effective masses that are the same in all
//! directions: one pass.

use powerhouse_model::{
    ConstraintWork, ContactLaw, ContactState, JointPair, JointRecord, Mat3, PredictedMotion, Vec3,
};

use super::Side;
use super::account::{PairStep, book};

/// A pair with what depends on masses and step alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct IsolatedPair {
    /// Place among the joint's pairs.
    index: u32,
    /// Places among the joint's nodes: the one that is harder to move, the other.
    nodes: [u32; 2],
    /// Which side of the pair the first of them is: 1 for the first side, -1 for the second.
    sign: f64,
    /// Share of a change of relative velocity that the first of them takes.
    share: f64,
    /// Traction per relative velocity that it stops, `1 / (dt W A)` (Pa s/m).
    stiffness: f64,
    /// Its inverse (m/(Pa s)).
    compliance: f64,
}

/// The value of an inverse effective mass that is the same in all directions.
pub(super) fn isotropic(inverse_mass: &Mat3) -> Option<f64> {
    let value = inverse_mass[(0, 0)];
    let rest = (inverse_mass - Mat3::identity() * value).amax();
    // Rounding of a 3 x 3 inversion.
    (rest <= 1e-14 * value.abs()).then_some(value)
}

impl IsolatedPair {
    /// A pair of inverse effective masses (1/kg), not both zero.
    pub(super) fn new(
        (index, nodes): (u32, [u32; 2]),
        area: f64,
        inverse_mass: [f64; 2],
        step: f64,
    ) -> Self {
        let sum = inverse_mass[0] + inverse_mass[1];
        let first_is_heavy = inverse_mass[0] <= inverse_mass[1];
        let ([heavy, light], sign, own) = if first_is_heavy {
            (nodes, 1.0, inverse_mass[0])
        } else {
            ([nodes[1], nodes[0]], -1.0, inverse_mass[1])
        };
        let compliance = step * sum * area;
        Self {
            index,
            nodes: [heavy, light],
            sign,
            share: own / sum,
            stiffness: 1.0 / compliance,
            compliance,
        }
    }

    /// Place among the joint's pairs.
    pub(super) fn index(&self) -> usize {
        self.index as usize
    }
}

/// Corrects the motion of isolated pairs; returns what their forces did.
///
/// The stick trial is the traction that ends a step without overlap and without slip,
/// `T = T0 + (w + g / dt) / (dt W A)` with `W = 1/a_i + 1/a_j` (Wang, Chen & Xiao 2019, Eq. 20, for
/// velocities half a step apart and effective masses `a`). The law cuts it down.
pub(super) fn correct<L: ContactLaw>(
    law: &L,
    isolated: &[IsolatedPair],
    (pairs, sides): (&[JointPair], &[Side]),
    records: &mut [JointRecord],
    motion: &mut PredictedMotion,
) -> ConstraintWork {
    let mut work = ConstraintWork::default();
    let rate = 1.0 / motion.step;
    for entry in isolated {
        let pair = &pairs[entry.index()];
        let side = &sides[entry.index()];
        let record = &mut records[entry.index()];
        let [heavy, light] = entry.nodes.map(|node| node as usize);
        let sign = entry.sign;
        let relative = |values: &[Vec3]| (values[light] - values[heavy]) * sign;
        let predicted = relative(motion.velocity);
        let mut offset = pair.to_local(&relative(motion.displacement));
        offset.x += side.gap;
        let before = pair.to_local(&relative(motion.previous));

        // What would have to go for the pair to end the step closed and stuck.
        let hold = held_back(&offset, record) * rate;
        let excess = pair.to_local(&predicted) + hold;
        let trial = side.preload + excess * entry.stiffness;
        let (traction, state) = law.admissible(trial, &record.state);
        // The change of relative velocity, and what it leaves; along normal and tangents, too.
        let (change, after, along);
        if state.contact == ContactState::Stick && traction == trial {
            // The bits of both velocities are the same where there is nothing to hold back.
            let held = pair.to_global(&hold);
            (change, after, along) = (predicted + held, -held, -hold);
        } else {
            let local = (traction - side.preload) * entry.compliance;
            change = pair.to_global(&local);
            (after, along) = (predicted - change, excess - hold - local);
        }
        let velocity = motion.velocity[heavy] + change * (sign * entry.share);
        motion.velocity[heavy] = velocity;
        motion.velocity[light] = velocity + after * sign;
        let step = PairStep {
            time: motion.time,
            length: motion.step,
            area: pair.area,
            preload: side.preload,
            offset,
            before,
            after: along,
            traction,
            state,
        };
        book(record, &step, &mut work);
    }
    work
}

/// What of an offset (m) is to go: the gap, and for a pair that sticks what rounding has moved it
/// along its tangents.
#[inline(always)]
pub(super) fn held_back(offset: &Vec3, record: &JointRecord) -> Vec3 {
    match record.anchor {
        Some([first, second]) if record.state.contact == ContactState::Stick => {
            Vec3::new(offset.x, offset.y - first, offset.z - second)
        }
        _ => Vec3::new(offset.x, 0.0, 0.0),
    }
}
