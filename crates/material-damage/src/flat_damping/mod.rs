//! Damping that is constant over a band of frequencies, in series with any law.

mod spectrum;

use std::sync::Arc;

use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, HistoryVariable, Lane, LawEnergy, LawInput,
    ModelError, ParameterError, RemainingStiffness, Strain, Stress,
};

use crate::history::strain;
use spectrum::Decay;
pub use spectrum::{DampingBand, MOST_MECHANISMS, Mechanism, RelaxationSpectrum};

/// Constitutive law whose elastic strain can be separated from the inelastic strain, so that damping
/// can act in series with it.
pub trait ElasticInSeries: ConstitutiveLaw {
    /// The same law with all elastic moduli multiplied by a factor, its strengths and fracture energies unchanged.
    #[must_use]
    fn with_stiffness(&self, factor: f64) -> Self;
    /// The same law in which a history means the strength that it means in the same law with another stiffness; unchanged
    /// by default, for laws whose strength does not depend on the stiffness, or is itself in the history.
    #[must_use]
    fn with_strengths_of(self, _other: &Self) -> Self {
        self
    }
    /// Plastic strain in a history, which remains after unloading; `None` for a law without plastic
    /// strain.
    #[inline(always)]
    fn inelastic_strain<L: Lane>(&self, _history: &[L]) -> Option<[L; 6]> {
        None
    }
}

/// Reference frequency of a [`FlatDamping`], at which waves have the speeds of the law's medium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ReferenceFrequency {
    /// Geometric centre of the band.
    #[default]
    Centre,
    /// A frequency (Hz) above zero, such as that of the tests that gave the moduli.
    At(f64),
    /// Zero frequency: the moduli are static ones.
    Static,
}

#[cfg(feature = "keys")]
powerhouse_model::keys::words_or_number! {
    ReferenceFrequency { "centre" => Centre, "static" => Static, number => At }
    "\"centre\", \"static\" or a number above 0", |x| x > 0.0, { "type": "number", "exclusiveMinimum": 0 }
}

impl ReferenceFrequency {
    /// Phase velocity at the reference frequency, relative to that of static moduli (1).
    ///
    /// # Errors
    /// If the frequency is not above zero or is above 1 MHz.
    pub fn velocity(self, spectrum: &RelaxationSpectrum) -> Result<f64, ParameterError> {
        Ok(match self {
            Self::Static => 1.0,
            Self::Centre => spectrum.velocity(spectrum.centre()),
            Self::At(frequency) => {
                ParameterError::check("reference", frequency, f64::MIN_POSITIVE, 1.0e6)?;
                spectrum.velocity(frequency)
            }
        })
    }
}

/// Law with frequency-independent damping: relaxation mechanisms in series with plastic flow and damage.
///
/// The elastic strain `e` of the law (strain less plastic strain) acts on a spring and, in parallel
/// with it, on the mechanisms of a [`RelaxationSpectrum`] with moduli proportional to the elastic ones:
///
/// `s = C_0 (e + sum y_l (e - v_l))`, `dv_l/dt = w_l (e - v_l)`
///
/// and the law yields and cracks under the total `s`: the strength is never exceeded, unlike with
/// damping *added* to a law, by its viscous stress. The law itself is evaluated with the strain less
/// the viscous strain and with the moduli of a sudden strain, so that any law can be damped.
///
/// `C_0` is such that waves at the [`ReferenceFrequency`] have the speed of the law's medium.
/// [`medium`](ConstitutiveLaw::medium) is the unrelaxed one, which bounds the stable step: shorter
/// than undamped by `sqrt(M(inf) / |M(reference)|)`.
///
/// History: that of the law, and six variables per mechanism: the part of its dashpot's strain at the
/// end of the next step that is known at the end of this one, over its share in equilibrium.
///
/// # Statics
/// Engines call [`for_step`](ConstitutiveLaw::for_step) before a motion; without it the law is the
/// static one: springs of `C_0` carry the stress, and the dashpots follow the elastic strain at once. A
/// motion that starts from such a state starts from that stress, and it does not relax. `C_0` is softer
/// than the given law, unless the reference is [`Static`](ReferenceFrequency::Static). An
/// initial stress does not relax either. Damage acts on the total stress, as effective stress. What has cracked in the
/// static form is as damaged and as strong in the motion: strengths that depend on the stiffness by the fracture energy
/// ([`with_strengths_of`](ElasticInSeries::with_strengths_of)) are those of a sudden strain in both.
///
/// # Why so
/// *Each mechanism is integrated exactly* for a strain that is linear within the step: passive for
/// every step, with six history variables, because the known terms at the end of a step are combined
/// into one. *It is scaled to equal the elastic strain in equilibrium*, whatever the step, so that a
/// static stage does not depend on the steps that follow. *Every point has all mechanisms*: with one in
/// each element, of a weight larger by their number (Day & Bradley 2001), long waves are damped and
/// propagate alike (three at 5 %: 4.8 to 5.2 %, speeds within 0.2 %) for a third of the memory, but the
/// stresses of neighbours then differ, by 14 % of their mean as standard deviation around 2 Hz, and
/// these stresses are compared with the strength.
///
/// ```
/// use powerhouse_material_damage::*;
/// use powerhouse_model::{ConstitutiveLaw, LawInput, Strain};
/// let band = DampingBand { ratio: 0.05, lowest: 0.5, highest: 20.0, mechanisms: 2 };
/// let rock = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK)?);
/// let damped = FlatDamping::new(rock, RelaxationSpectrum::fit(band)?, ReferenceFrequency::Centre)?;
/// assert_eq!(damped.history().len(), 8 + 12);
/// let shortening = rock.medium().p_speed() / damped.medium().p_speed();
/// assert!(shortening > 0.9, "{shortening}");
/// # Ok::<(), MaterialError>(())
/// ```
#[derive(Clone, Debug)]
pub struct FlatDamping<M> {
    /// Law as given.
    reference: M,
    /// Law with the moduli of a sudden strain, whose strengths all histories mean.
    sudden: M,
    /// Law with the moduli of a step, which is evaluated.
    effective: M,
    /// Relaxation mechanisms; `None` for a law without damping.
    spectrum: Option<Arc<RelaxationSpectrum>>,
    /// Static moduli relative to those of the given law.
    relaxed: f64,
    medium: ElasticMedium,
    variables: Arc<[HistoryVariable]>,
    terms: Terms,
}

/// Coefficients of the mechanisms in a step.
#[derive(Clone, Copy, Debug)]
struct Terms {
    count: usize,
    /// Coefficients of the mechanisms' variables in the viscous strain.
    viscous: [f64; MOST_MECHANISMS],
    /// Decay factors of the mechanisms' variables in a step.
    kept: [f64; MOST_MECHANISMS],
    /// Coefficients of the elastic strain in the update: one less the decay factors.
    gained: [f64; MOST_MECHANISMS],
}

impl Terms {
    /// Coefficients in equilibrium: mechanisms that follow the elastic strain at once, without stress.
    fn in_equilibrium(count: usize) -> Self {
        Self {
            count,
            viscous: [0.0; MOST_MECHANISMS],
            kept: [0.0; MOST_MECHANISMS],
            gained: [1.0; MOST_MECHANISMS],
        }
    }
    /// Coefficients for steps of a length (s), and the ratio of the stiffness under a strain that grows
    /// within a step to that of the springs alone.
    fn in_step(mechanisms: &[Mechanism], step: f64) -> (Self, f64) {
        let mut terms = Self::in_equilibrium(mechanisms.len());
        let mut sudden = 1.0;
        for (l, mechanism) in mechanisms.iter().enumerate() {
            let decay = Decay::new(mechanism, step);
            terms.kept[l] = decay.kept;
            terms.gained[l] = 1.0 - decay.kept;
            terms.viscous[l] = mechanism.weight * (1.0 - decay.after);
            sudden += terms.viscous[l];
        }
        for share in &mut terms.viscous {
            *share /= sudden;
        }
        (terms, sudden)
    }
    /// Strain less its viscous part.
    #[inline(always)]
    fn effective<L: Lane>(&self, strain: &Strain<L>, before: &[L]) -> Strain<L> {
        let mut effective = *strain;
        for l in 0..self.count {
            let share = strain.0[0].constant(-self.viscous[l]);
            for i in 0..6 {
                effective.0[i] = before[6 * l + i].mul_add(share, effective.0[i]);
            }
        }
        effective
    }
}

impl<M: ElasticInSeries> FlatDamping<M> {
    /// Damped law of the given law, mechanisms and reference frequency.
    ///
    /// # Errors
    /// If the reference frequency is not positive.
    pub fn new(
        law: M,
        spectrum: RelaxationSpectrum,
        reference: ReferenceFrequency,
    ) -> Result<Self, ParameterError> {
        let velocity = reference.velocity(&spectrum)?;
        let relaxed = 1.0 / (velocity * velocity);
        let count = spectrum.mechanisms().len();
        let mut variables = law.history().to_vec();
        variables.extend_from_slice(&RELAXING[..6 * count]);
        let unrelaxed = law.with_stiffness(relaxed * spectrum.unrelaxed());
        Ok(Self {
            medium: unrelaxed.medium(),
            effective: law.with_stiffness(relaxed).with_strengths_of(&unrelaxed),
            sudden: unrelaxed,
            reference: law,
            spectrum: Some(Arc::new(spectrum)),
            relaxed,
            variables: variables.into(),
            terms: Terms::in_equilibrium(count),
        })
    }
    /// Undamped law of the same type: programs that choose at run time whether a law is damped compile
    /// it once.
    pub fn none(law: M) -> Self {
        Self {
            medium: law.medium(),
            sudden: law.clone(),
            effective: law.clone(),
            spectrum: None,
            relaxed: 1.0,
            variables: law.history().into(),
            terms: Terms::in_equilibrium(0),
            reference: law,
        }
    }
    /// Given law, without damping.
    pub fn law(&self) -> &M {
        &self.reference
    }
    /// Relaxation mechanisms; `None` if the law is not damped.
    pub fn spectrum(&self) -> Option<&RelaxationSpectrum> {
        self.spectrum.as_deref()
    }
    /// Phase velocity at a frequency (Hz), relative to that of the given law's medium (1).
    pub fn velocity(&self, frequency: f64) -> f64 {
        let of_spectrum = |spectrum: &RelaxationSpectrum| spectrum.velocity(frequency);
        self.relaxed.sqrt() * self.spectrum().map_or(1.0, of_spectrum)
    }
}

impl<M: ElasticInSeries> ConstitutiveLaw for FlatDamping<M> {
    fn name(&self) -> &str {
        self.reference.name()
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        &self.variables
    }
    fn uses_location(&self) -> bool {
        self.reference.uses_location()
    }
    fn is_in_lanes(&self) -> bool {
        self.reference.is_in_lanes()
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let own = new_history.len() - 6 * self.terms.count;
        let (of_law, relaxing) = new_history.split_at_mut(own);
        let (law_before, before) = input.history.split_at(own);
        // The only evaluation of the law: it is compiled once.
        let strain = self.terms.effective(&input.strain, before);
        let effective = input.with_history(law_before).with_strain(strain);
        let stress = self.effective.stress_change(&effective, of_law);
        let first = input.strain.0[0];
        let mut elastic = input.strain.0;
        if let Some(inelastic) = self.effective.inelastic_strain(of_law) {
            for i in 0..6 {
                elastic[i] = elastic[i] - inelastic[i];
            }
        }
        for l in 0..self.terms.count {
            let kept = first.constant(self.terms.kept[l]);
            let gained = first.constant(self.terms.gained[l]);
            for i in 0..6 {
                let index = 6 * l + i;
                relaxing[index] = before[index].mul_add(kept, elastic[i] * gained);
            }
        }
        stress
    }
    /// Energies of the law for the strain less its viscous part: the stored one is what a sudden
    /// unloading releases. The rest of the work is in the mechanisms.
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        let own = new_history.len() - 6 * self.terms.count;
        let (law_before, before) = input.history.split_at(own);
        let strain = self.terms.effective(&input.strain, before);
        let effective = input.with_history(law_before).with_strain(strain);
        self.effective.energy(&effective, &new_history[..own])
    }
    /// Remaining stiffness of the law for the strain less its viscous part.
    #[inline(always)]
    fn remaining_stiffness<L: Lane>(
        &self,
        input: &LawInput<L>,
        new_history: &[L],
        change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        let own = new_history.len() - 6 * self.terms.count;
        let (law_before, before) = input.history.split_at(own);
        let strain = self.terms.effective(&input.strain, before);
        let effective = input.with_history(law_before).with_strain(strain);
        (self.effective).remaining_stiffness(&effective, &new_history[..own], change)
    }
    /// Tangent of the law for the strain less its viscous part, which does not change within a step.
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        let own = input.history.len() - 6 * self.terms.count;
        let (law_before, before) = input.history.split_at(own);
        let strain = self.terms.effective(&input.strain, before);
        let effective = input.with_history(law_before).with_strain(strain);
        self.effective.tangent(&effective)
    }
    fn relaxes(&self) -> bool {
        self.spectrum.is_some()
    }
    fn only_stores(&self) -> bool {
        self.effective.is_linear()
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        match &self.spectrum {
            Some(_) => None,
            None => self.reference.elastic_domain(),
        }
    }
    /// Checks the size with the moduli of a static stage and with those of a sudden strain; all others
    /// are between them.
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        let Some(spectrum) = self.spectrum() else {
            return self.reference.accept_size(size);
        };
        for factor in [1.0, spectrum.unrelaxed()] {
            let law = self.reference.with_stiffness(self.relaxed * factor);
            law.accept_size(size)?;
        }
        Ok(())
    }
    fn for_step(&self, step: f64) -> Self {
        let mut law = self.clone();
        let Some(spectrum) = self.spectrum() else {
            return law;
        };
        let mechanisms = spectrum.mechanisms();
        let sudden;
        (law.terms, sudden) = if step > 0.0 {
            Terms::in_step(mechanisms, step)
        } else {
            (Terms::in_equilibrium(mechanisms.len()), 1.0)
        };
        let effective = self.reference.with_stiffness(self.relaxed * sudden);
        law.effective = effective.with_strengths_of(&self.sudden);
        law
    }
}

/// History variables of all mechanisms.
const RELAXING: [HistoryVariable; 6 * MOST_MECHANISMS] = [
    strain("relaxing_strain_1_xx"),
    strain("relaxing_strain_1_yy"),
    strain("relaxing_strain_1_zz"),
    strain("relaxing_strain_1_xy"),
    strain("relaxing_strain_1_yz"),
    strain("relaxing_strain_1_zx"),
    strain("relaxing_strain_2_xx"),
    strain("relaxing_strain_2_yy"),
    strain("relaxing_strain_2_zz"),
    strain("relaxing_strain_2_xy"),
    strain("relaxing_strain_2_yz"),
    strain("relaxing_strain_2_zx"),
    strain("relaxing_strain_3_xx"),
    strain("relaxing_strain_3_yy"),
    strain("relaxing_strain_3_zz"),
    strain("relaxing_strain_3_xy"),
    strain("relaxing_strain_3_yz"),
    strain("relaxing_strain_3_zx"),
    strain("relaxing_strain_4_xx"),
    strain("relaxing_strain_4_yy"),
    strain("relaxing_strain_4_zz"),
    strain("relaxing_strain_4_xy"),
    strain("relaxing_strain_4_yz"),
    strain("relaxing_strain_4_zx"),
];
