//! Energies at integration points, for the energy ledger.

use powerhouse_model::{ElasticMedium, Lane, LawEnergy, LawInput, Strain, Stress, array};

/// Elastic energy density of a stress, `s : C^-1 : s / 2` (J/m3).
#[inline(always)]
pub(crate) fn elastic_energy<L: Lane>(medium: &ElasticMedium, stress: &Stress<L>) -> L {
    let (mean, shear) = stress.mean_and_shear();
    let volume = mean * mean * mean.constant(0.5 / medium.bulk());
    let shape = shear * shear * mean.constant(0.5 / medium.shear());
    volume + shape
}

/// Step of a material with elastic strain, plastic flow and scalar damage.
pub(crate) struct Step<'a, L: Lane> {
    /// Undamaged medium.
    pub(crate) medium: &'a ElasticMedium,
    /// Input of the law in this step.
    pub(crate) input: &'a LawInput<'a, L>,
    /// Elastic strain at the end of the step, without that of the initial stress.
    pub(crate) elastic: Strain<L>,
    /// Increment of plastic strain; `None` for laws without flow.
    pub(crate) flowed: Option<Strain<L>>,
    /// Damage before and after the step.
    pub(crate) damage: [L; 2],
}

impl<L: Lane> Step<'_, L> {
    /// [`LawEnergy`] of the step by its definition, in a form in which the energy of the initial stress
    /// does not cancel where there is no damage.
    #[inline(always)]
    pub(crate) fn energy(&self) -> LawEnergy<L> {
        let Self {
            medium,
            input,
            elastic,
            flowed,
            damage: [before, after],
        } = self;
        let number = |value: f64| after.constant(value);
        let zero = number(0.0);
        let (lambda, shear) = (number(medium.lambda()), number(medium.shear()));
        let change = Stress::elastic(lambda, shear, elastic);
        let effective = input.initial + change;
        let left = number(1.0) - *after;
        let gained = change.work(elastic) * number(0.5) + input.initial.work(elastic);
        let lost = *after * elastic_energy(medium, &input.initial);
        let plastic = flowed.map_or(zero, |flowed| left * effective.work(&flowed));
        let grown = elastic_energy(medium, &effective) * (*after - *before);
        LawEnergy::stored(left * gained - lost - input.initial.work(&input.strain))
            .with_plastic(plastic.max(zero))
            .with_damage(grown.max(zero))
            .with_recovered((-grown).max(zero))
    }
}

/// [`LawEnergy`] of a step of plastic flow without damage. The history begins with the plastic strain.
#[inline(always)]
pub(crate) fn of_flow<L: Lane>(
    medium: &ElasticMedium,
    input: &LawInput<L>,
    new_history: &[L],
) -> LawEnergy<L> {
    let step = Step {
        medium,
        input,
        elastic: difference(&input.strain.0, new_history),
        flowed: Some(difference(new_history, input.history)),
        damage: [input.strain.0[0].constant(0.0); 2],
    };
    step.energy()
}

/// Difference of the strains at the start of two histories.
#[inline(always)]
pub(crate) fn difference<L: Lane>(after: &[L], before: &[L]) -> Strain<L> {
    Strain(array(|i| after[i] - before[i]))
}
