//! Stress response with its derivatives.

use powerhouse_model::{Lane, LawInput, Stress, each};

use super::flow::Trial;
use super::{COMPRESSION, DAMAGE_COMPRESSION, DAMAGE_TENSION, LeeFenves, TENSION};
use crate::PrincipalAxes;
use crate::dual::Dual;
use crate::energy::difference;
use crate::tangent::implicit;

impl LeeFenves {
    /// Principal nominal stresses as a function of the principal trial stresses (Pa).
    pub(super) fn principal_response(
        &self,
        input: &LawInput<f64>,
        principal: &[Dual; 3],
    ) -> [Dual; 3] {
        let p = &self.parameters;
        let old = input.history;
        let before = [old[TENSION], old[COMPRESSION]];
        let elastic = difference(&input.strain.0, old);
        let stress = input.initial + Stress::elastic(self.lambda, self.shear, &elastic);
        let axes = PrincipalAxes::of(&stress);
        let rates = self.rates(self.widths(input, &axes.directions));
        let known = Trial::of_principal(&principal.map(|s| s.value), before, rates);
        let trial = Trial::of_principal(principal, before.map(Dual::fixed), rates.map(Dual::fixed));
        let mut damage = [DAMAGE_TENSION, DAMAGE_COMPRESSION].map(|v| Dual::fixed(old[v]));
        let mut stress = *principal;
        let strengths = self.strengths(before, rates).inverse;
        let invariants = [known.mean, known.shear];
        let excess = self.excess(invariants, principal[0].value, strengths);
        if excess > 0.0 {
            let fixed = known.fixed();
            let flow = implicit(
                self.flow(&known, excess, strengths),
                |flow| self.yield_after(&fixed, flow),
                |flow| self.yield_after(&trial, flow),
            );
            let flowed = self.after(&trial, flow);
            stress = flowed.stress;
            let most = 1.0 - p.residual_stiffness;
            let [opened, crushed] = flowed.strains;
            let torn = self.tension.damage(opened, trial.rates[0], most);
            let broken = self.compression.damage(crushed, trial.rates[1], most);
            damage = [torn.max(damage[0]), broken.max(damage[1])];
        }
        self.closure().nominal(damage, &stress)
    }
}

impl<L: Lane> Trial<L> {
    /// Trial state of principal stresses (Pa) in falling order, with `e_t` and `e_c` before the step and
    /// the rates `b_t` and `b_c`.
    fn of_principal(values: &[L; 3], old: [L; 2], rates: [L; 2]) -> Self {
        let number = |value: f64| values[0].constant(value);
        let mean = (values[0] + values[1] + values[2]) * number(1.0 / 3.0);
        let [x, y, z] = each(values, |s| s - mean);
        let shear = ((x * x + y * y + z * z) * number(0.5)).sqrt();
        Self::new([mean, shear], values, old, rates)
    }
}

impl Trial<f64> {
    /// The same trial as constants, without derivatives.
    fn fixed(&self) -> Trial<Dual> {
        Trial {
            mean: Dual::fixed(self.mean),
            shear: Dual::fixed(self.shear),
            inverse_shear: Dual::fixed(self.inverse_shear),
            deviators: self.deviators.map(Dual::fixed),
            old: self.old.map(Dual::fixed),
            rates: self.rates.map(Dual::fixed),
        }
    }
}
