//! Plasticity with softening of the strength.

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
use crate::surface::{FlowInAxes, PrincipalReturn, YieldSurface, strains_of_loss, trial_outside};
use crate::{ElasticInSeries, MaterialError, PrincipalAxes, SofteningOf, tangent};

/// Rate at which the strength of a [`SofteningPlasticity`] law falls with the plastic shortening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StrengthFall {
    /// Shear band that dissipates the same energy whatever its width `h`: with the uniaxial compressive
    /// strength `f_c` and the residual strength ratio `q`
    ///
    /// `b = h (1 - q) f_c / G`
    FractureEnergy {
        /// Fracture energy `G` per area of band (N/m), in excess of the work of the residual strength, of a
        /// band that crushes along its axis.
        energy: f64,
    },
    /// Given rate `b` (1), above 0; the dissipated energy then depends on the mesh.
    Rate(f64),
}

/// Parameters of a [`SofteningPlasticity`] law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SofteningPlasticityParameters<S> {
    /// Yield surface before softening.
    pub surface: S,
    /// Rate at which its strength falls.
    pub fall: StrengthFall,
    /// Residual strength ratio `q` (1), 0.001 to 1: share of all strengths of the surface (cohesion and cut-off of
    /// Mohr-Coulomb) that is left after complete softening; 1 for no softening.
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

/// Elastic-plastic law whose yield surface shrinks with plastic flow: Mohr-Coulomb with softening cohesion.
///
/// All strengths of the surface, of [`MohrCoulomb`](crate::MohrCoulomb) the cohesion and the cut-off,
/// are those of its parameters times
///
/// `s = 1 - (1 - q)(1 - exp(-b k))`
///
/// with the plastic shortening `k`, the sum of the negative principal increments of plastic strain:
/// the multiplier of shear flow on a face of Mohr-Coulomb. Friction and dilation are constant. Tensile
/// opening alone does not soften: for cracks there is [`PlasticDamage`](crate::PlasticDamage).
///
/// # History
/// Plastic strain (six components, engineering shears), the equivalent plastic strain `sum
/// sqrt(2/3 de_p : de_p)`, `k`, the strength lost `1 - s`, the
/// [`YieldState`](crate::YieldState) of the last step, and the width of the band: that of the element
/// along the least principal stress when it first lost strength.
///
/// # Return
/// A surface and its flow that are scaled by `s` return a trial to `s` times the point to which the
/// unscaled surface returns the trial over `s`. So `k` is the only unknown; it is solved within a bracket
/// for `k = k_0 + dk(s(k))`, and the end of a step is consistent with its strength, whatever the step.
///
/// # Valid range
/// With a fracture energy, elements up to [`largest_size`](Self::largest_size), which
/// [`check_size`](Self::check_size) verifies; wider ones soften as steeply as can be followed and
/// dissipate more energy. The energy is exact for a band that crushes along its axis; that of a shear
/// band under pressure is larger, as its stress is. A strain that is not finite gives a stress that is
/// not finite.
///
/// # Why so
/// *No elastic energy is in the regularisation*, unlike in [`PlasticDamage`](crate::PlasticDamage): a law with constant
/// stiffness releases all elastic energy, so `G / h` is the plastic work in excess of the residual strength.
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

/// Softening rate `b`, given or by fracture energy.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rate {
    Fixed(f64),
    /// Rate by fracture energy, `1 / b = length / h`, at least `steepest`.
    Band {
        length: f64,
        steepest: f64,
    },
}

impl<S: YieldSurface> SofteningPlasticity<S> {
    /// Law of the given parameters.
    ///
    /// # Errors
    /// If a parameter is outside its range.
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

    /// Parameters of the law.
    pub fn parameters(&self) -> &SofteningPlasticityParameters<S> {
        &self.parameters
    }

    /// Largest width of an element that crushes along its axis without snap-back (m); `None` if
    /// softening is not by fracture energy.
    pub fn largest_size(&self) -> Option<f64> {
        match self.rate {
            Rate::Band { length, steepest } => Some(length / steepest),
            Rate::Fixed(_) => None,
        }
    }

    /// Checks that an element of a width normal to a band (m) does not snap back.
    ///
    /// # Errors
    /// [`MaterialError::SnapBack`], with the largest permitted width.
    pub fn check_size(&self, size: f64) -> Result<(), MaterialError> {
        check_size(size, &[(SofteningOf::Shear, self.largest_size())])
    }

    /// Softening rate `b` in an element of a width (m).
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

    /// Strength lost, `1 - s`.
    #[inline(always)]
    fn lost<L: Lane>(&self, shortening: L, rate: L) -> L {
        let number = |value: f64| shortening.constant(value);
        number(1.0 - self.parameters.residual_strength) * (number(1.0) - decay(rate * shortening))
    }

    /// Return of principal trial stresses (Pa) to the surface with a share of its strength.
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

/// Equation for the plastic shortening `k` at the end of a step, `k_0 + dk(s(k)) - k = 0`.
struct ShorteningEquation<'a, S, L> {
    law: &'a SofteningPlasticity<S>,
    trial: [L; 3],
    old: L,
    rate: L,
}

impl<S: YieldSurface, L: Lane> ShorteningEquation<'_, S, L> {
    /// Increment of shortening of a return to the surface with a share of its strength.
    #[inline(always)]
    fn flowed(&self, strength: L) -> L {
        let returned = self.law.returned(&self.trial, strength);
        let medium = self.law.parameters.surface.medium();
        let [a, b, c] = strains_of_loss(&medium, &returned.loss);
        let zero = strength.constant(0.0);
        -(a.min(zero) + b.min(zero) + c.min(zero))
    }
}

impl<S: YieldSurface, L: Lane> Function<L> for ShorteningEquation<'_, S, L> {
    #[inline(always)]
    fn at(&self, shortening: L) -> L {
        let one = shortening.constant(1.0);
        let strength = one - self.law.lost(shortening, self.rate);
        (self.old - shortening) + self.flowed(strength)
    }
}

impl<S: YieldSurface> SofteningPlasticity<S> {
    /// Shortening at the end of a step from principal trial stresses (Pa) outside the surface.
    #[inline(always)]
    fn shortening<L: Lane>(&self, equation: &ShorteningEquation<'_, S, L>) -> L {
        let number = |value: f64| equation.old.constant(value);
        let zero = number(0.0);
        let first = equation.old;
        let at_first = equation.at(first).max(zero);
        // Upper bound: the flow to the residual strength.
        let last = first + equation.flowed(number(self.parameters.residual_strength));
        let at_last = equation.at(last).min(zero);
        let tolerance = number(4.0 * L::Scalar::EPSILON) * (first + at_first);
        zero_between([first, at_first], [last, at_last], tolerance, equation)
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
        history::copy::<L, { HISTORY.len() }>(old, new_history);
        new_history[YIELD_STATE] = zero;

        let strength = one - old[LOST];
        // Without lost strength scaling would change no bit.
        let mut scaled = trial;
        if first.any(zero.less(old[LOST])) {
            for component in &mut scaled.0 {
                *component = *component / strength;
            }
        }
        let Some((mut axes, yielded)) = trial_outside(&self.parameters.surface, &scaled) else {
            return change;
        };
        let mut waiting = axes.values;
        for (value, waiting) in axes.values.iter_mut().zip(&mut waiting) {
            *value = *value * strength;
            // Lanes that did not yield must not prolong the iteration of others.
            *waiting = value.select(yielded, zero);
        }
        let width = crack_band::width(old[WIDTH], &input.extents, &axes.directions[2]);
        let equation = ShorteningEquation {
            law: self,
            trial: waiting,
            old: old[SHORTENING],
            rate: self.rate(width),
        };
        let shortening = self.shortening(&equation);
        let lost = self.lost(shortening, equation.rate);
        let returned = self.returned(&axes.values, one - lost);
        let flow = FlowInAxes::new(&self.medium(), (axes, yielded), returned).flow;
        for i in 0..6 {
            new_history[i] = old[i] + flow.plastic[i];
        }
        new_history[EQUIVALENT] = old[EQUIVALENT] + flow.equivalent();
        new_history[SHORTENING] = shortening.select(yielded, old[SHORTENING]);
        new_history[LOST] = lost.max(old[LOST]).select(yielded, old[LOST]);
        new_history[YIELD_STATE] = flow.state;
        let width = crack_band::updated(old[WIDTH], width, lost);
        new_history[WIDTH] = width.select(yielded, old[WIDTH]);
        flow.stress_change(&change, &input.initial)
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        self.parameters.surface.elastic_domain()
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        Some(energy::of_flow(&self.medium(), input, new_history))
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
    /// Consistent tangent with a constant width of the band; at a kink that of one side.
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
            let equation = ShorteningEquation {
                law: self,
                trial: values,
                old: old[SHORTENING],
                rate,
            };
            let shortening = self.shortening(&equation);
            let equation = |trial: [Dual; 3]| ShorteningEquation {
                law: self,
                trial,
                old: Dual::fixed(old[SHORTENING]),
                rate: Dual::fixed(rate),
            };
            let shortening = tangent::implicit(
                shortening,
                |shortening| equation(values.map(Dual::fixed)).at(shortening),
                |shortening| equation(*trial).at(shortening),
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
