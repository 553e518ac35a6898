//! Plasticity whose strength falls with the flow.

use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, HistoryVariable, Lane, LawEnergy, LawInput,
    ModelError, ParameterError, RemainingStiffness, Scalar, Stress, array, each,
};

use crate::crack_band::{self, CRUSHING_BAND_WIDTH};
use crate::dual::Dual;
use crate::energy;
use crate::exponential::decay;
use crate::history::{self, PLASTIC_STRAINS, number};
use crate::remaining;
use crate::root::{Function, zero_between};
use crate::softening::check_size;
use crate::surface::{FlowInAxes, PrincipalReturn, YieldSurface, beyond, strains_of_loss};
use crate::{ElasticInSeries, MaterialError, PrincipalAxes, SofteningOf, tangent};

/// How fast strength falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StrengthFall {
    /// A shear band that takes the same energy whatever its width `h`: with the uniaxial compressive
    /// strength `f_c` and the residual share `q`
    ///
    /// `b = h (1 - q) f_c / G`
    FractureEnergy {
        /// Energy per area of band (N/m), beyond what the residual strength takes, of a band that
        /// crushes along its axis, `G`.
        energy: f64,
    },
    /// `b` as it stands, above 0; the energy then depends on the mesh.
    Rate(f64),
}

/// What a [`SofteningPlasticity`] law is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SofteningPlasticityParameters<S> {
    /// The yield surface before any flow.
    pub surface: S,
    /// How fast its strength falls.
    pub fall: StrengthFall,
    /// The share `q` of strength that stays, 0.001 to 1.
    pub residual_strength: f64,
}

const EQUIVALENT: usize = 6;
const SHORTENING: usize = 7;
const LOST: usize = 8;
const YIELD_STATE: usize = 9;
const WIDTH: usize = 10;
const HISTORY: [HistoryVariable; 11] = {
    let [xx, yy, zz, xy, yz, zx] = PLASTIC_STRAINS;
    [
        xx,
        yy,
        zz,
        xy,
        yz,
        zx,
        number("equivalent_plastic_strain"),
        number("plastic_shortening"),
        number("strength_lost"),
        history::YIELD_STATE,
        CRUSHING_BAND_WIDTH,
    ]
};

/// Elasticity within a yield surface that shrinks as it flows: Mohr-Coulomb whose cohesion softens.
///
/// All strengths of the surface, of [`MohrCoulomb`](crate::MohrCoulomb) the cohesion and the cut-off,
/// are those of its parameters times
///
/// `s = 1 - (1 - q)(1 - exp(-b k))`
///
/// with the plastic shortening `k`, the sum of the negative principal increments of plastic strain:
/// the multiplier of shear flow on a face of Mohr and Coulomb. Friction and dilation stay. Opening
/// alone softens nothing: for cracks there is [`PlasticDamage`](crate::PlasticDamage).
///
/// # History
/// Plastic strain (six components, engineering shears), the equivalent plastic strain `sum
/// sqrt(2/3 de_p : de_p)`, `k`, the strength lost `1 - s`, the
/// [`YieldState`](crate::YieldState) of the last step, and the width of the element along the least
/// principal stress when it first lost strength, which the band keeps.
///
/// # Return
/// A surface and its flow that are scaled by `s` return a trial to `s` times where the whole surface
/// returns the trial over `s`. So `k` is the only unknown; it is solved within a bracket for `k = k_0
/// + dk(s(k))`, and the end of a step is consistent with its strength, whatever the step.
///
/// # Valid range
/// By energy, elements narrower than [`largest_size`](Self::largest_size): make sure of it by
/// [`check_size`](Self::check_size); wider ones soften as steeply as can be followed and take more
/// energy. The energy is exact for a band that crushes along its axis; that of a band of shear under
/// pressure is larger, as its stress is. A strain that is not finite gives a stress that is not
/// finite.
///
/// # Why so
/// *No elastic energy stands in the regularisation*, unlike in [`PlasticDamage`](crate::PlasticDamage): a law that keeps
/// its stiffness gives back all that is elastic, so `G / h` is the plastic work beyond the residual strength.
///
/// Source: crack band after Bazant & Oh (1983), *Materials and Structures* 16; strain softening of
/// cohesion as in Vermeer & de Borst (1984), *HERON* 29(3), ch. 7.
///
/// ```
/// use powerhouse_material_damage::*;
/// use powerhouse_model::{ConstitutiveLaw, LawInput, Strain};
///
/// let rock = SofteningPlasticity::new(SofteningPlasticityParameters {
///     surface: MohrCoulomb::new(presets::PAPER_ROCK)?,
///     fall: StrengthFall::FractureEnergy { energy: 2.0e3 },
///     residual_strength: 0.2,
/// })?;
/// rock.check_size(0.5)?;
/// let strain = Strain([2.5e-3, 2.5e-3, -5.0e-3, 0.0, 0.0, 0.0]);
/// let (old, mut new) = ([0.0; 11], [0.0; 11]);
/// rock.stress_change(&LawInput::new(strain, &old).with_size(0.5), &mut new);
/// assert!(new[8] > 0.5, "half of the strength is lost: {}", new[8]);
/// # Ok::<(), MaterialError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SofteningPlasticity<S> {
    parameters: SofteningPlasticityParameters<S>,
    rate: Rate,
    lambda: f64,
    shear: f64,
}

/// Where `b` comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rate {
    Fixed(f64),
    /// `1 / b = length / h`, at least `steepest`.
    Band {
        length: f64,
        steepest: f64,
    },
}

impl<S: YieldSurface> SofteningPlasticity<S> {
    /// The law of the parameters.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(parameters: SofteningPlasticityParameters<S>) -> Result<Self, MaterialError> {
        let SofteningPlasticityParameters {
            surface,
            fall,
            residual_strength,
        } = &parameters;
        ParameterError::check("residual_strength", *residual_strength, 1.0e-3, 1.0)?;
        let medium = surface.medium();
        let rate = match *fall {
            StrengthFall::FractureEnergy { energy } => {
                ParameterError::check("energy", energy, f64::MIN_POSITIVE, 1.0e12)?;
                let strength = surface.uniaxial_compression();
                ParameterError::check("strength", strength, f64::MIN_POSITIVE, f64::MAX)?;
                let lost = (1.0 - residual_strength) * strength;
                Rate::Band {
                    length: energy / lost,
                    steepest: lost / medium.young,
                }
            }
            StrengthFall::Rate(rate) => {
                ParameterError::check("rate", rate, f64::MIN_POSITIVE, 1.0e12)?;
                Rate::Fixed(rate)
            }
        };
        Ok(Self {
            rate,
            lambda: medium.lambda(),
            shear: medium.shear(),
            parameters,
        })
    }

    /// What the law was made of.
    pub fn parameters(&self) -> &SofteningPlasticityParameters<S> {
        &self.parameters
    }

    /// The largest width of an element that crushes along its axis without snapping back (m); none
    /// if softening is not by energy.
    pub fn largest_size(&self) -> Option<f64> {
        match self.rate {
            Rate::Band { length, steepest } => Some(length / steepest),
            Rate::Fixed(_) => None,
        }
    }

    /// Refuses an element whose width normal to a band (m) is too large.
    ///
    /// # Errors
    /// [`MaterialError::SnapBack`] names the largest permitted width.
    pub fn check_size(&self, size: f64) -> Result<(), MaterialError> {
        check_size(size, &[(SofteningOf::Shear, self.largest_size())])
    }

    /// `b` in an element of a width (m).
    #[inline(always)]
    fn rate<L: Lane>(&self, size: L) -> L {
        let number = |value: f64| size.constant(value);
        match self.rate {
            Rate::Fixed(rate) => number(rate),
            Rate::Band { length, steepest } => {
                let inverse = number(length) / size;
                number(1.0) / inverse.max(number(steepest))
            }
        }
    }

    /// `1 - s`.
    #[inline(always)]
    fn lost<L: Lane>(&self, shortening: L, rate: L) -> L {
        let number = |value: f64| shortening.constant(value);
        number(1.0 - self.parameters.residual_strength) * (number(1.0) - decay(rate * shortening))
    }

    /// The return of principal trial stresses (Pa) to the surface with a share of its strength.
    #[inline(always)]
    fn returned<L: Lane>(&self, trial: &[L; 3], strength: L) -> PrincipalReturn<L> {
        let scaled = each(trial, |s| s / strength);
        let returned = self.parameters.surface.return_principal(&scaled);
        PrincipalReturn {
            stress: each(&returned.stress, |s| s * strength),
            loss: each(&returned.loss, |s| s * strength),
            state: returned.state,
        }
    }
}

/// What the shortening of a step lacks to be that of the flow which it permits: `k_0 + dk(s(k)) - k`.
struct Lacking<'a, S, L> {
    law: &'a SofteningPlasticity<S>,
    trial: [L; 3],
    old: L,
    rate: L,
}

impl<S: YieldSurface, L: Lane> Lacking<'_, S, L> {
    /// The flow with a share of the strength.
    #[inline(always)]
    fn flowed(&self, strength: L) -> L {
        let returned = self.law.returned(&self.trial, strength);
        let medium = self.law.parameters.surface.medium();
        let [a, b, c] = strains_of_loss(&medium, &returned.loss);
        let zero = strength.constant(0.0);
        -(a.min(zero) + b.min(zero) + c.min(zero))
    }
}

impl<S: YieldSurface, L: Lane> Function<L> for Lacking<'_, S, L> {
    #[inline(always)]
    fn at(&self, shortening: L) -> L {
        let one = shortening.constant(1.0);
        let strength = one - self.law.lost(shortening, self.rate);
        (self.old - shortening) + self.flowed(strength)
    }
}

impl<S: YieldSurface> SofteningPlasticity<S> {
    /// The shortening at the end of a step from principal trial stresses (Pa) outside the surface.
    #[inline(always)]
    fn shortening<L: Lane>(&self, lacking: &Lacking<'_, S, L>) -> L {
        let number = |value: f64| lacking.old.constant(value);
        let zero = number(0.0);
        let first = lacking.old;
        let at_first = lacking.at(first).max(zero);
        // No flow is larger than that to the residual strength.
        let last = first + lacking.flowed(number(self.parameters.residual_strength));
        let at_last = lacking.at(last).min(zero);
        let tolerance = number(4.0 * L::Scalar::EPSILON) * (first + at_first);
        zero_between([first, at_first], [last, at_last], tolerance, lacking)
    }
}

impl<S: YieldSurface> ConstitutiveLaw for SofteningPlasticity<S> {
    fn name(&self) -> &str {
        self.parameters.surface.name()
    }
    #[inline]
    fn medium(&self) -> ElasticMedium {
        self.parameters.surface.medium()
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &HISTORY
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let old = input.history;
        let first = input.strain.0[0];
        let number = |value: f64| first.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let elastic = energy::difference(&input.strain.0, old);
        let change = Stress::elastic(number(self.lambda), number(self.shear), &elastic);
        let trial = input.initial + change;
        history::keep::<L, { HISTORY.len() }>(old, new_history);
        new_history[YIELD_STATE] = zero;

        let strength = one - old[LOST];
        // A whole surface needs no scaling, which would change no bit.
        let mut scaled = trial;
        if first.any(zero.less(old[LOST])) {
            for component in &mut scaled.0 {
                *component = *component / strength;
            }
        }
        let Some((mut axes, yielded)) = beyond(&self.parameters.surface, &scaled) else {
            return change;
        };
        let mut waiting = axes.values;
        for (value, waiting) in axes.values.iter_mut().zip(&mut waiting) {
            *value = *value * strength;
            // What did not yield must not keep others waiting.
            *waiting = value.select(yielded, zero);
        }
        let width = crack_band::width(old[WIDTH], &input.extents, &axes.directions[2]);
        let lacking = Lacking {
            law: self,
            trial: waiting,
            old: old[SHORTENING],
            rate: self.rate(width),
        };
        let shortening = self.shortening(&lacking);
        let lost = self.lost(shortening, lacking.rate);
        let returned = self.returned(&axes.values, one - lost);
        let flow = FlowInAxes::new(&self.medium(), (axes, yielded), returned).flow;
        for i in 0..6 {
            new_history[i] = old[i] + flow.plastic[i];
        }
        new_history[EQUIVALENT] = old[EQUIVALENT] + flow.equivalent();
        new_history[SHORTENING] = shortening.select(yielded, old[SHORTENING]);
        new_history[LOST] = lost.max(old[LOST]).select(yielded, old[LOST]);
        new_history[YIELD_STATE] = flow.state;
        let width = crack_band::kept(old[WIDTH], width, lost);
        new_history[WIDTH] = width.select(yielded, old[WIDTH]);
        flow.stress_change(&change, &input.initial)
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        self.parameters.surface.elastic_domain()
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        Some(energy::of_flow(&self.medium(), input, new_history, None))
    }
    #[inline(always)]
    fn remaining_stiffness<L: Lane>(
        &self,
        input: &LawInput<L>,
        new_history: &[L],
        _change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        remaining::of_flow(input, new_history, None)
    }
    /// The consistent one, with the width of the band as it is; at a kink that of one side.
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        let old = input.history;
        let elastic = energy::difference(&input.strain.0, old);
        let strength = 1.0 - old[LOST];
        let trial = input.initial + Stress::elastic(self.lambda, self.shear, &elastic);
        let least = PrincipalAxes::of(&trial).directions[2];
        let rate = self.rate(crack_band::width(old[WIDTH], &input.extents, &least));
        let respond = |trial: &[Dual; 3]| {
            let values = trial.map(|s| s.value);
            let scaled = values.map(|s| s / strength);
            if self.parameters.surface.excess(&scaled) <= 0.0 {
                return *trial;
            }
            let lacking = Lacking {
                law: self,
                trial: values,
                old: old[SHORTENING],
                rate,
            };
            let shortening = self.shortening(&lacking);
            let lacking = |trial: [Dual; 3]| Lacking {
                law: self,
                trial,
                old: Dual::fixed(old[SHORTENING]),
                rate: Dual::fixed(rate),
            };
            let shortening = tangent::implicit(
                shortening,
                |shortening| lacking(values.map(Dual::fixed)).at(shortening),
                |shortening| lacking(*trial).at(shortening),
            );
            let lost = self.lost(shortening, Dual::fixed(rate));
            self.returned(trial, Dual::fixed(1.0) - lost).stress
        };
        let medium = self.medium();
        Some(tangent::of_isotropic(&medium, input, &elastic, respond))
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        Ok(self.check_size(size)?)
    }
}

impl<S: YieldSurface> ElasticInSeries for SofteningPlasticity<S> {
    fn with_stiffness(&self, factor: f64) -> Self {
        let mut law = self.clone();
        law.parameters.surface = self.parameters.surface.with_stiffness(factor);
        if let Rate::Band { steepest, .. } = &mut law.rate {
            *steepest /= factor;
        }
        law.lambda *= factor;
        law.shear *= factor;
        law
    }
    #[inline(always)]
    fn inelastic_strain<L: Lane>(&self, history: &[L]) -> Option<[L; 6]> {
        Some(array(|i| history[i]))
    }
}
