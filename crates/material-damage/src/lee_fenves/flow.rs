//! The amount of flow that brings a trial back to a surface which softens meanwhile.

use powerhouse_model::{Lane, Scalar, each};

use super::{LeeFenves, ROOT_3};
use crate::plastic_damage::share_of_tension;
use crate::root::{Function, zero_between};
use crate::surface::far_lanes;

/// A trial of the effective stress.
pub(super) struct Trial<L> {
    pub(super) mean: L,
    /// `sqrt(J2)` (Pa).
    pub(super) shear: L,
    /// Principal deviators in falling order (Pa).
    pub(super) deviators: [L; 3],
    /// `e_t` and `e_c` before the step.
    pub(super) old: [L; 2],
    /// `b_t` and `b_c`.
    pub(super) rates: [L; 2],
}

/// The state after an amount of flow.
pub(super) struct Flowed<L> {
    /// Principal stresses (Pa).
    pub(super) stress: [L; 3],
    /// `e_t` and `e_c`.
    pub(super) strains: [L; 2],
    /// Mean stress, `sqrt(J2)` (Pa).
    pub(super) invariants: [L; 2],
    /// Share of the deviator that flow took.
    pub(super) released: L,
    /// The share of tension `r`.
    pub(super) tension: L,
}

impl<L: Lane> Flowed<L> {
    /// The lanes of which the trial is [far](far_lanes) from this state.
    #[inline(always)]
    pub(super) fn far_from(&self, trial: &Trial<L>) -> Option<L::Mask> {
        let [mean, shear] = self.invariants;
        far_lanes(mean.abs() + shear, trial.mean.abs() + trial.shear)
    }
}

/// By how much a trial lies outside after an amount of flow.
pub(super) struct Outside<'a, L> {
    pub(super) law: &'a LeeFenves,
    pub(super) trial: &'a Trial<L>,
}

impl<L: Lane> Function<L> for Outside<'_, L> {
    #[inline(always)]
    fn at(&self, flow: L) -> L {
        let flowed = self.law.after(self.trial, flow);
        let strengths = self.law.strengths(flowed.strains, self.trial.rates);
        self.law
            .excess(flowed.invariants, flowed.stress[0], strengths)
    }
}

impl LeeFenves {
    /// What an amount of flow, the fall of `sqrt(J2)` (Pa), makes of a trial; flow beyond the apex
    /// of the cone changes the mean stress alone.
    #[inline(always)]
    pub(super) fn after<L: Lane>(&self, trial: &Trial<L>, flow: L) -> Flowed<L> {
        let number = |value: f64| flow.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let divisor = trial.shear.select(zero.less(trial.shear), one);
        let released = (flow / divisor).min(one);
        let lowered = number(self.swelling) * flow;
        let mean = trial.mean - lowered;
        let left = one - released;
        let stress = each(&trial.deviators, |s| s.mul_add(left, mean));
        let tension = share_of_tension(&stress);
        let medium = &self.parameters.medium;
        let volume = lowered * number(1.0 / (3.0 * medium.bulk()));
        let shape = released * number(0.5 / self.shear);
        let opened = shape.mul_add(trial.deviators[0], volume).max(zero);
        let crushed = (-shape.mul_add(trial.deviators[2], volume)).max(zero);
        Flowed {
            stress,
            strains: [
                tension.mul_add(opened, trial.old[0]),
                (one - tension).mul_add(crushed, trial.old[1]),
            ],
            invariants: [mean, trial.shear * left],
            released,
            tension,
        }
    }

    /// The factor that takes a stress back to the surface, beside which it lies by the rounding of
    /// a trial from far; at most one.
    #[inline(always)]
    pub(super) fn shrinking<L: Lane>(&self, trial: &Trial<L>, flowed: &Flowed<L>) -> L {
        let strengths = self.strengths(flowed.strains, trial.rates);
        let excess = self.excess(flowed.invariants, flowed.stress[0], strengths);
        // Without its last term the yield function grows with the stress.
        let at_yield = excess.constant(1.0 - self.biaxial);
        at_yield / (at_yield + excess.max(excess.constant(0.0)))
    }

    /// The amount of flow that brings a trial, outside by `excess` with the `strengths` before the
    /// step, back to the surface (Pa).
    #[inline(always)]
    pub(super) fn flow<L: Lane>(&self, trial: &Trial<L>, excess: L, strengths: [L; 2]) -> L {
        let number = |value: f64| excess.constant(value);
        let zero = number(0.0);
        let outside = Outside { law: self, trial };
        // Sound at last: no deviator, and no tension.
        let end = trial.shear.max(trial.mean * number(1.0 / self.swelling));

        // The first guess takes strengths and signs of stresses for fixed.
        let [tensile, compressive] = strengths;
        let divisor = trial.shear.select(zero.less(trial.shear), number(1.0));
        let turned = trial.deviators[0] / divisor;
        let greatest = turned + number(self.swelling);
        let is_pulled = zero.less(trial.deviators[0] + trial.mean);
        let pulled =
            number(1.0 - self.biaxial) / tensile - number(1.0 + self.biaxial) / compressive;
        let pressed = number(self.confined) / compressive;
        let common = number(3.0 * self.biaxial * self.swelling + ROOT_3) / compressive;
        let slope = greatest.mul_add(pulled.select(is_pulled, pressed), common);
        let near = (excess / slope).min(end);
        let at_near = outside.at(near);
        // Where it falls short, beyond the secant by a tenth.
        let secant = near * excess / (excess - at_near).max(excess * number(0.05));
        let far = (number(1.1) * secant).min(end).max(near);
        let is_short = zero.less(at_near);
        let far = far.select(is_short, near);
        let at_far = if zero.any(is_short) {
            outside.at(far).select(is_short, at_near)
        } else {
            at_near
        };
        // And where that falls short too, all the way.
        let is_shorter = zero.less(at_far);
        let [first, at_first] = [
            near.select(is_short, zero),
            at_near.select(is_short, excess),
        ];
        let [first, at_first] = [
            far.select(is_shorter, first),
            at_far.select(is_shorter, at_first),
        ];
        let last = end.select(is_shorter, far);
        let at_last = if zero.any(is_shorter) {
            outside.at(end).select(is_shorter, at_far)
        } else {
            at_far
        };
        let size = trial.mean.abs() + trial.shear;
        let tension = (trial.mean + trial.deviators[0]).max(zero);
        let terms = number(4.0) * size / compressive + tension / tensile + number(1.0);
        let tolerance = number(2.0 * L::Scalar::EPSILON) * terms;
        zero_between([first, at_first], [last, at_last], tolerance, &outside)
    }
}
