//! Return of a trial stress to a surface that softens during the return.

use powerhouse_model::{Lane, Scalar, each};

use super::{LeeFenves, ROOT_3};
use crate::plastic_damage::share_of_tension;
use crate::root::{Differentiable, zero_by_slope};
use crate::surface::far_lanes;

/// Trial state of the effective stress.
pub(super) struct Trial<L> {
    pub(super) mean: L,
    /// Trial `sqrt(J2)` (Pa).
    pub(super) shear: L,
    /// Inverse of `sqrt(J2)`, or one if it is zero.
    pub(super) inverse_shear: L,
    /// Principal deviatoric stresses in falling order (Pa).
    pub(super) deviators: [L; 3],
    /// Equivalent plastic strains `e_t` and `e_c` before the step.
    pub(super) old: [L; 2],
    /// Softening rates `b_t` and `b_c`.
    pub(super) rates: [L; 2],
}

impl<L: Lane> Trial<L> {
    /// Trial state of a mean stress, `sqrt(J2)` and principal stresses (Pa) in falling order, with `e_t`
    /// and `e_c` before the step and the rates `b_t` and `b_c`.
    #[inline(always)]
    pub(super) fn new([mean, shear]: [L; 2], values: &[L; 3], old: [L; 2], rates: [L; 2]) -> Self {
        let (zero, one) = (mean.constant(0.0), mean.constant(1.0));
        Self {
            mean,
            shear,
            inverse_shear: one / shear.select(zero.less(shear), one),
            deviators: each(values, |s| s - mean),
            old,
            rates,
        }
    }
}

/// State after an amount of flow.
pub(super) struct Flowed<L> {
    /// Principal stresses after the flow (Pa).
    pub(super) stress: [L; 3],
    /// Equivalent plastic strains `e_t` and `e_c`.
    pub(super) strains: [L; 2],
    /// Mean stress and `sqrt(J2)` (Pa).
    pub(super) invariants: [L; 2],
    /// Share of the trial's deviator that the flow removed.
    pub(super) released: L,
    /// Share of tension `r`.
    pub(super) tension: L,
    /// Increments of plastic strain `<dp1>` and `<-dp3>`.
    opened: L,
    crushed: L,
}

impl<L: Lane> Flowed<L> {
    /// Lanes of which the trial is [far](far_lanes) from this state.
    #[inline(always)]
    pub(super) fn far_from(&self, trial: &Trial<L>) -> Option<L::Mask> {
        let [mean, shear] = self.invariants;
        far_lanes(mean.abs() + shear, trial.mean.abs() + trial.shear)
    }
}

/// Yield function as a function of the amount of flow.
struct YieldOfFlow<'a, L> {
    law: &'a LeeFenves,
    trial: &'a Trial<L>,
}

impl<L: Lane> Differentiable<L> for YieldOfFlow<'_, L> {
    #[inline(always)]
    fn at(&self, flow: L) -> [L; 2] {
        self.law.yield_and_slope(self.trial, flow)
    }
}

impl LeeFenves {
    /// State of a trial after an amount of flow, measured as the decrease of `sqrt(J2)` (Pa); flow
    /// beyond the apex of the cone changes the mean stress alone.
    #[inline(always)]
    pub(super) fn after<L: Lane>(&self, trial: &Trial<L>, flow: L) -> Flowed<L> {
        let number = |value: f64| flow.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let released = (flow * trial.inverse_shear).min(one);
        let lowered = number(self.dilatancy) * flow;
        let mean = trial.mean - lowered;
        let left = one - released;
        let stress = each(&trial.deviators, |s| s.mul_add(left, mean));
        let tension = share_of_tension(&stress);
        let [volume, shape] = self.compliances(flow);
        let (volume, shape) = (lowered * volume, released * shape);
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
            opened,
            crushed,
        }
    }

    /// Strain along an axis per unit decrease of mean stress and of the deviator (1/Pa).
    #[inline(always)]
    fn compliances<L: Lane>(&self, flow: L) -> [L; 2] {
        let bulk = self.parameters.medium.bulk();
        [
            flow.constant(1.0 / (3.0 * bulk)),
            flow.constant(0.5 / self.shear),
        ]
    }

    /// Yield function of a trial after an amount of flow.
    #[inline(always)]
    pub(super) fn yield_after<L: Lane>(&self, trial: &Trial<L>, flow: L) -> L {
        let [excess, _] = self.yield_and_slope(trial, flow);
        excess
    }

    /// Yield function after an amount of flow, and its derivative with respect to the flow.
    #[inline(always)]
    fn yield_and_slope<L: Lane>(&self, trial: &Trial<L>, flow: L) -> [L; 2] {
        let flowed = self.after(trial, flow);
        let strengths = self.strengths(flowed.strains, trial.rates);
        let excess = self.excess(flowed.invariants, flowed.stress[0], strengths.inverse);

        let number = |value: f64| flow.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        // Beyond the apex no deviator remains.
        let sheared = flow.less(trial.shear);
        let lost = trial.inverse_shear.select(sheared, zero);
        let dilatancy = number(self.dilatancy);
        let falls = each(&trial.deviators, |s| s.mul_add(lost, dilatancy));

        // Derivative of the share of tension, from those of the tensile stresses and of all magnitudes.
        let (mut pulled_fall, mut size) = (zero, zero);
        for (stress, fall) in flowed.stress.iter().zip(&falls) {
            pulled_fall = pulled_fall + fall.select(zero.less(*stress), zero);
            size = size + stress.abs();
        }
        let size_fall = pulled_fall + pulled_fall - number(3.0 * self.dilatancy);
        let turning =
            (flowed.tension * size_fall - pulled_fall) / size.select(zero.less(size), one);

        let [volume, shape] = self.compliances(flow);
        let (volume, shape) = (dilatancy * volume, lost * shape);
        let opens = shape.mul_add(trial.deviators[0], volume);
        let opens = opens.select(zero.less(flowed.opened), zero);
        let crushes = -shape.mul_add(trial.deviators[2], volume);
        let crushes = crushes.select(zero.less(flowed.crushed), zero);
        let opening = turning.mul_add(flowed.opened, flowed.tension * opens);
        let crushing = (one - flowed.tension) * crushes - turning * flowed.crushed;

        let [tensile, compressive] = strengths.inverse;
        let tensile_rise = strengths.crushing[0].mul_add(crushing, strengths.opening * opening);
        let compressive_rise = strengths.crushing[1] * crushing;
        let greatest = flowed.stress[0];
        let is_pulled = zero.less(greatest);
        let shear_fall = one.select(sheared, zero);
        let invariants = number(3.0 * self.biaxial).mul_add(dilatancy, number(ROOT_3) * shear_fall);
        let by_greatest = number(-1.0 - self.biaxial).select(is_pulled, number(self.confined));
        let over_fall = by_greatest.mul_add(falls[0], invariants);
        let over = self.over_strength(flowed.invariants, greatest);
        let pressed = over * compressive_rise - over_fall * compressive;
        let pulled = (greatest * tensile_rise - falls[0] * tensile).select(is_pulled, zero);
        [excess, number(1.0 - self.biaxial).mul_add(pulled, pressed)]
    }

    /// Factor that scales a stress back to the surface, off which it is by the rounding of a distant
    /// trial; at most one.
    #[inline(always)]
    pub(super) fn shrinking<L: Lane>(&self, trial: &Trial<L>, flowed: &Flowed<L>) -> L {
        let strengths = self.strengths(flowed.strains, trial.rates).inverse;
        let excess = self.excess(flowed.invariants, flowed.stress[0], strengths);
        // All terms of the yield function but the last grow with the stress.
        let at_yield = excess.constant(1.0 - self.biaxial);
        at_yield / (at_yield + excess.max(excess.constant(0.0)))
    }

    /// Amount of flow (Pa) that returns a trial to the surface, with its yield function `excess` and the
    /// inverse `strengths` before the step.
    #[inline(always)]
    pub(super) fn flow<L: Lane>(&self, trial: &Trial<L>, excess: L, strengths: [L; 2]) -> L {
        let number = |value: f64| excess.constant(value);
        let zero = number(0.0);
        // End of the bracket, admissible for certain: no deviator, and no tension.
        let end = trial.shear.max(trial.mean * number(1.0 / self.dilatancy));

        // The first guess takes strengths and signs of stresses as constant.
        let [tensile, compressive] = strengths;
        let turned = trial.deviators[0] * trial.inverse_shear;
        let greatest = turned + number(self.dilatancy);
        let is_pulled = zero.less(trial.deviators[0] + trial.mean);
        let pulled =
            number(1.0 - self.biaxial) * tensile - number(1.0 + self.biaxial) * compressive;
        let pressed = number(self.confined) * compressive;
        let common = number(3.0 * self.biaxial * self.dilatancy + ROOT_3) * compressive;
        let slope = greatest.mul_add(pulled.select(is_pulled, pressed), common);
        let near = (excess / slope).min(end);
        let size = trial.mean.abs() + trial.shear;
        let tension = (trial.mean + trial.deviators[0]).max(zero);
        let terms = number(4.0) * size * compressive + tension * tensile + number(1.0);
        // One more evaluation would cost a quarter of the return without a significant gain.
        let roundings = if L::Scalar::EPSILON > 1.0e-10 {
            4.0
        } else {
            16.0
        };
        let tolerance = number(roundings * L::Scalar::EPSILON) * terms;
        let yield_after = YieldOfFlow { law: self, trial };
        zero_by_slope(near, [zero, excess], end, tolerance, &yield_after)
    }
}
