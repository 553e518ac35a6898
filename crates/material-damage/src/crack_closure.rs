//! Stress that closed cracks carry, and its energy.

use powerhouse_model::{ElasticMedium, Lane, LawEnergy, LawInput, Stress, array, each};

use crate::PrincipalAxes;
use crate::energy::{difference, elastic_energy};
use crate::plastic_damage::{DAMAGE, DAMAGE_COMPRESSION, DAMAGE_TENSION, DAMAGE_TYPE};

/// Least damage that counts in the damage type.
const LEAST_NOTED: f64 = 1.0e-3;

/// Nominal stress of an effective stress by damage in tension and compression, with cracks that close.
///
/// `sigma = (1 - d_c) ((1 - d_t) s + w d_t s-)`, the factor of `s` not below the residual stiffness
///
/// The closed-crack stress `s-` is the effective stress less that of crack strains, `s - C e`, where `e` opens in any
/// directions but closes in none (its principal values are not negative), such that the elastic energy of `s-` is least:
/// the stress of a material without tensile strength. It equals `s` where no principal stress is tensile, and vanishes
/// normal to an open crack.
///
/// The stress thus is the derivative of an energy, `(1 - d_c) ((1 - d_t) U(s) + w d_t U(s-))` with the elastic energy
/// `U`, at constant plastic strain and damage: a body with cracks that open and close, in any order and under any
/// combination of stresses, gains no energy by them. Both terms are convex, and no tangent exceeds the elastic one.
///
/// Sources: Del Piero (1989), *Meccanica* 24, for the material without tensile strength; Carol & Willam (1996),
/// *Int. J. Solids Structures* 33(20-22), for the energy that a factor by signs of stresses generates.
#[derive(Clone, Copy)]
pub(crate) struct CrackClosure {
    poisson: f64,
    recovery: f64,
    residual: f64,
}

impl CrackClosure {
    /// Closure of cracks in a medium, with the stiffness recovery `w` and the residual stiffness.
    #[inline(always)]
    pub(crate) fn new(medium: &ElasticMedium, [recovery, residual]: [f64; 2]) -> Self {
        Self {
            poisson: medium.poisson,
            recovery,
            residual,
        }
    }

    /// Factors of the effective stress and of the closed-crack stress, of damage in tension and compression.
    #[inline(always)]
    fn factors<L: Lane>(&self, [torn, broken]: [L; 2]) -> [L; 2] {
        let number = |value: f64| torn.constant(value);
        let one = number(1.0);
        let uncrushed = one - broken;
        let intact = (uncrushed * (one - torn)).max(number(self.residual));
        let closed = number(self.recovery) * (uncrushed - intact).max(number(0.0));
        [intact, closed]
    }

    /// Principal values of the closed-crack stress, of those of the effective stress (Pa) in falling order.
    #[inline(always)]
    fn closed_stress<L: Lane>(&self, [first, second, third]: &[L; 3]) -> [L; 3] {
        let number = |value: f64| first.constant(value);
        let zero = number(0.0);
        // Lateral stress of a strain along one axis, and of a stress along two without strain along the third.
        let confined = number(self.poisson / (1.0 - self.poisson));
        let poisson = number(self.poisson);
        let opening = first.max(zero);
        let across = *second - confined * opening;
        let is_opened_twice = zero.less(across);
        let once = *third - confined * opening;
        let twice = (*third - poisson * (*first + *second)).min(zero);
        [
            first.min(zero),
            across.min(zero),
            twice.select(is_opened_twice, once),
        ]
    }

    /// Principal nominal stresses (Pa) of damage in tension and compression and of the principal effective stresses
    /// in falling order.
    #[inline(always)]
    pub(crate) fn nominal<L: Lane>(&self, damage: [L; 2], stress: &[L; 3]) -> [L; 3] {
        let [intact, closed] = self.factors(damage);
        let carried = self.closed_stress(stress);
        array(|i| intact * stress[i] + closed * carried[i])
    }

    /// Whether a lane has cracks whose closure counts.
    #[inline(always)]
    fn counts<L: Lane>(&self, torn: L) -> bool {
        let zero = torn.constant(0.0);
        self.recovery > 0.0 && torn.any(zero.less(torn))
    }

    /// Change of the nominal stress for one of the effective stress (Pa), by the damage in tension and compression of the
    /// history; writes `D` and the damage type to the history. `axes` are those of the effective stress after the
    /// change, if they are known.
    #[inline(always)]
    pub(crate) fn nominal_change<L: Lane>(
        &self,
        change: &Stress<L>,
        initial: &Stress<L>,
        axes: Option<PrincipalAxes<L>>,
        history: &mut [L],
    ) -> Stress<L> {
        let number = |value: f64| history[DAMAGE].constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let (torn, broken) = (history[DAMAGE_TENSION], history[DAMAGE_COMPRESSION]);
        let [intact, closed] = self.factors([torn, broken]);
        let is_torn = one.select(number(LEAST_NOTED).less(torn), zero);
        let is_broken = (one + one).select(number(LEAST_NOTED).less(broken), zero);
        history[DAMAGE_TYPE] = is_torn + is_broken;
        let lost = one - intact;
        history[DAMAGE] = lost;
        let mut nominal = Stress(array(|i| intact * change.0[i] - lost * initial.0[i]));
        if self.counts(torn) {
            let axes = axes.unwrap_or_else(|| PrincipalAxes::of(&(*initial + *change)));
            let is_cracked = zero.less(closed);
            let carried = self.closed_stress(&axes.values);
            let in_mesh = axes.tensor(&each(&carried, |s| closed * s));
            for i in 0..6 {
                nominal.0[i] = (nominal.0[i] + in_mesh[i]).select(is_cracked, nominal.0[i]);
            }
            let kept = closed.mul_add(self.share_of_energy(&axes.values, &carried), intact);
            history[DAMAGE] = (one - kept.min(one)).select(is_cracked, lost);
        }
        nominal
    }

    /// Elastic energy of the closed-crack stress over that of the effective stress, of their principal values; zero
    /// without stress.
    #[inline(always)]
    fn share_of_energy<L: Lane>(&self, effective: &[L; 3], carried: &[L; 3]) -> L {
        let number = |value: f64| effective[0].constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let [a, b, c] = effective.map(L::abs);
        let largest = a.max(b).max(c);
        let some = zero.less(largest);
        let inverse = one / largest.select(some, one);
        let energy = |stress: &[L; 3]| {
            let [a, b, c] = each(stress, |s| s * inverse);
            let mean = a + b + c;
            let squares = a.mul_add(a, b.mul_add(b, c * c));
            number(1.0 + self.poisson) * squares - number(self.poisson) * (mean * mean)
        };
        let (part, whole) = (energy(carried), energy(effective));
        let some = zero.less(whole);
        (part / whole.select(some, one)).select(some, zero)
    }

    /// [`LawEnergy`] of a step of plastic flow with damage, of the undamaged medium. The history begins with the plastic
    /// strain.
    #[inline(always)]
    pub(crate) fn energy<L: Lane>(
        &self,
        medium: &ElasticMedium,
        input: &LawInput<L>,
        new_history: &[L],
    ) -> LawEnergy<L> {
        let old = input.history;
        let zero = new_history[0].constant(0.0);
        let one = new_history[0].constant(1.0);
        let number = |value: f64| zero.constant(value);
        let elastic = difference(&input.strain.0, new_history);
        let change = Stress::elastic(number(medium.lambda()), number(medium.shear()), &elastic);
        let effective = input.initial + change;
        let flowed = difference(new_history, old);
        let damage = |history: &[L]| [history[DAMAGE_TENSION], history[DAMAGE_COMPRESSION]];
        let before = self.factors(damage(old));
        let after = self.factors(damage(new_history));

        let mut carried = Stress([zero; 6]);
        if self.counts(new_history[DAMAGE_TENSION]) {
            let axes = PrincipalAxes::of(&effective);
            carried = Stress(axes.tensor(&self.closed_stress(&axes.values)));
        }
        let of_carried = elastic_energy(medium, &carried);
        let gained = change.work(&elastic) * number(0.5) + input.initial.work(&elastic);
        let lost = (one - after[0]) * elastic_energy(medium, &input.initial);
        let stored = after[0] * gained + after[1] * of_carried - lost;
        let plastic = after[0] * effective.work(&flowed) + after[1] * carried.work(&flowed);
        let whole = elastic_energy(medium, &effective);
        let spent = (before[0] - after[0]) * whole + (before[1] - after[1]) * of_carried;
        LawEnergy::stored(stored - input.initial.work(&input.strain))
            .with_plastic(plastic.max(zero))
            .with_damage(spent.max(zero))
    }
}
