//! Damping that is the same at all frequencies of a band, in series with any law.

mod spectrum;

use std::sync::Arc;

use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, HistoryVariable, Lane, LawEnergy, LawInput,
    ModelError, ParameterError, RemainingStiffness, Strain, Stress,
};

use crate::history::strain;
use spectrum::Decay;
pub use spectrum::{DampingBand, MOST_MECHANISMS, Mechanism, RelaxationSpectrum};

/// A law whose elastic part can be told from the rest, so that damping can stand in series with
/// it.
pub trait ElasticInSeries: ConstitutiveLaw {
    /// The same law with all elastic moduli times a factor, its strengths unchanged.
    #[must_use]
    fn with_stiffness(&self, factor: f64) -> Self;
    /// The part of the strain that unloading would leave, from the history of a point; none for
    /// a law without plastic strain.
    #[inline(always)]
    fn inelastic_strain<L: Lane>(&self, _history: &[L]) -> Option<[L; 6]> {
        None
    }
}

/// Where the medium of a [`FlatDamping`] has the speeds that its law states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ReferenceFrequency {
    /// At the geometric centre of the band.
    #[default]
    Centre,
    /// At a frequency (Hz) above zero, such as that of the tests that gave the moduli.
    At(f64),
    /// At rest: the moduli are static ones.
    Static,
}

impl ReferenceFrequency {
    /// The speed of waves there, relative to that of static moduli.
    ///
    /// # Errors
    /// A frequency that is not above zero or above 1 MHz.
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

/// Any law, damped by relaxation mechanisms in series with its plastic flow and damage.
///
/// The elastic strain `e` of the law (strain less plastic strain) strains a spring and, beside
/// it, the mechanisms of a [`RelaxationSpectrum`] with moduli proportional to the elastic ones:
///
/// `s = C_0 (e + sum y_l (e - v_l))`, `dv_l/dt = w_l (e - v_l)`
///
/// and it is the total `s` that yields and cracks: a strength is never overshot, which damping
/// *added* to a law does by its viscous stress. The law itself is asked with the strain less the
/// viscous part and with the moduli of a sudden strain, so that any law can be damped.
///
/// `C_0` is such that waves at the [`ReferenceFrequency`] have the speed of the law's medium.
/// [`medium`](ConstitutiveLaw::medium) is the unrelaxed one, which bounds the stable step: shorter
/// than undamped by `sqrt(M(inf) / |M(reference)|)`.
///
/// History: that of the law, and six numbers of each mechanism: the strain of its dashpot at the
/// end of the next step, as far as it is known, over the share of a strain at rest that is.
///
/// # At rest
/// An engine asks [`for_step`](ConstitutiveLaw::for_step); without it the law is the static one:
/// springs of `C_0` hold the stress, and the dashpots follow the elastic strain at once. A motion
/// that starts from such a state starts from that stress, and it does not relax. `C_0` is softer
/// than the law as it was given, unless the reference is [`Static`](ReferenceFrequency::Static). An
/// initial stress relaxes as little. Damage acts on the sum, in effective stress.
///
/// # Why so
/// *Each mechanism is advanced exactly* for a strain that is linear within the step: passive for
/// every step, and it takes six numbers, because what is known at the end of a step is folded
/// into one. *That one is scaled to be the elastic strain itself at rest*, whatever the step: a static
/// stage needs to know nothing of the steps that follow. *Every point has all mechanisms*: with one in
/// each element, of a weight larger by their number (Day & Bradley 2001), long waves are damped and
/// travel alike (three at 5 %: 4.8 to 5.2 %, speeds within 0.2 %) for a third of the memory, but the
/// stresses of neighbours then differ, by 14 % of their mean as standard deviation around 2 Hz, and it is
/// against these that strength is held.
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
    /// The law as it was given.
    reference: M,
    /// The law that is asked: with other moduli in a step.
    asked: M,
    /// None for a law that is not damped.
    spectrum: Option<Arc<RelaxationSpectrum>>,
    /// Static moduli relative to those of the law as it was given.
    relaxed: f64,
    medium: ElasticMedium,
    variables: Arc<[HistoryVariable]>,
    terms: Terms,
}

/// Factors of the mechanisms in a step.
#[derive(Clone, Copy, Debug)]
struct Terms {
    count: usize,
    /// Of what a mechanism keeps, in the viscous strain.
    viscous: [f64; MOST_MECHANISMS],
    /// Of what a mechanism keeps, in the next step.
    kept: [f64; MOST_MECHANISMS],
    /// Of the elastic strain, in the next step: what is not kept.
    gained: [f64; MOST_MECHANISMS],
}

impl Terms {
    /// Mechanisms that follow the elastic strain at once and take none of the stress.
    fn at_rest(count: usize) -> Self {
        Self {
            count,
            viscous: [0.0; MOST_MECHANISMS],
            kept: [0.0; MOST_MECHANISMS],
            gained: [1.0; MOST_MECHANISMS],
        }
    }
    /// Mechanisms in steps of a length (s), and how much stiffer than its springs alone the whole is
    /// under a strain that grows within a step.
    fn in_step(mechanisms: &[Mechanism], step: f64) -> (Self, f64) {
        let mut terms = Self::at_rest(mechanisms.len());
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
    /// The strain less its viscous part.
    #[inline(always)]
    fn asked<L: Lane>(&self, strain: &Strain<L>, before: &[L]) -> Strain<L> {
        let mut asked = *strain;
        for l in 0..self.count {
            let share = strain.0[0].constant(-self.viscous[l]);
            for i in 0..6 {
                asked.0[i] = before[6 * l + i].mul_add(share, asked.0[i]);
            }
        }
        asked
    }
}

impl<M: ElasticInSeries> FlatDamping<M> {
    /// The law, damped.
    ///
    /// # Errors
    /// A reference frequency that is not positive.
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
            asked: law.with_stiffness(relaxed),
            reference: law,
            spectrum: Some(Arc::new(spectrum)),
            relaxed,
            variables: variables.into(),
            terms: Terms::at_rest(count),
        })
    }
    /// The law as it is, of the same type: programs that choose at run time whether a law is damped
    /// compile it once.
    pub fn none(law: M) -> Self {
        Self {
            medium: law.medium(),
            asked: law.clone(),
            spectrum: None,
            relaxed: 1.0,
            variables: law.history().into(),
            terms: Terms::at_rest(0),
            reference: law,
        }
    }
    /// The law without damping.
    pub fn law(&self) -> &M {
        &self.reference
    }
    /// The mechanisms; none if the law is not damped.
    pub fn spectrum(&self) -> Option<&RelaxationSpectrum> {
        self.spectrum.as_deref()
    }
    /// The speed of waves at a frequency (Hz), relative to that of the law's own medium.
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
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let own = new_history.len() - 6 * self.terms.count;
        let (of_law, relaxing) = new_history.split_at_mut(own);
        let (law_before, before) = input.history.split_at(own);
        // One place that asks the law: it is compiled once.
        let strain = self.terms.asked(&input.strain, before);
        let asked = input.with_history(law_before).with_strain(strain);
        let stress = self.asked.stress_change(&asked, of_law);
        let first = input.strain.0[0];
        let mut elastic = input.strain.0;
        if let Some(inelastic) = self.asked.inelastic_strain(of_law) {
            for i in 0..6 {
                elastic[i] = elastic[i] - inelastic[i];
            }
        }
        for l in 0..self.terms.count {
            let kept = first.constant(self.terms.kept[l]);
            let gained = first.constant(self.terms.gained[l]);
            for i in 0..6 {
                let place = 6 * l + i;
                relaxing[place] = before[place].mul_add(kept, elastic[i] * gained);
            }
        }
        stress
    }
    /// As the law tells of the strain less its viscous part: held is what a sudden unloading
    /// gives back. The rest of the work is with the mechanisms.
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        let own = new_history.len() - 6 * self.terms.count;
        let (law_before, before) = input.history.split_at(own);
        let strain = self.terms.asked(&input.strain, before);
        let asked = input.with_history(law_before).with_strain(strain);
        self.asked.energy(&asked, &new_history[..own])
    }
    /// As the law tells.
    #[inline(always)]
    fn remaining_stiffness<L: Lane>(
        &self,
        input: &LawInput<L>,
        new_history: &[L],
        change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        let own = new_history.len() - 6 * self.terms.count;
        let (law_before, before) = input.history.split_at(own);
        let strain = self.terms.asked(&input.strain, before);
        let asked = input.with_history(law_before).with_strain(strain);
        (self.asked).remaining_stiffness(&asked, &new_history[..own], change)
    }
    /// That of the law for the strain less its viscous part, which a step does not change.
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        let own = input.history.len() - 6 * self.terms.count;
        let (law_before, before) = input.history.split_at(own);
        let strain = self.terms.asked(&input.strain, before);
        let asked = input.with_history(law_before).with_strain(strain);
        self.asked.tangent(&asked)
    }
    fn relaxes(&self) -> bool {
        self.spectrum.is_some()
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        match &self.spectrum {
            Some(_) => None,
            None => self.reference.elastic_domain(),
        }
    }
    /// As the law does with the moduli of a static stage and with those of a sudden strain: all others
    /// lie between.
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
            (Terms::at_rest(mechanisms.len()), 1.0)
        };
        law.asked = self.reference.with_stiffness(self.relaxed * sudden);
        law
    }
}

/// The variables of all mechanisms.
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
