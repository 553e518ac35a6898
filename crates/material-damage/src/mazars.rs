//! Mazars' damage law in total strain.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, HistoryVariable, Lane, LawEnergy, LawInput,
    ModelError, ParameterError, RemainingStiffness, Stress, each,
};

use crate::crack_band::{self, CRACK_BAND_WIDTH};
use crate::dual::Dual;
use crate::energy::Step;
use crate::history::{self, number};
#[cfg(feature = "keys")]
use crate::softening::SOFTENING_KEYS;
use crate::softening::{
    STEEPEST, check_size, damage_of, damage_of_falling_stress, inverse_rate_in_total_strain,
};
use crate::surface::stiffened;
use crate::{ElasticInSeries, MaterialError, PrincipalAxes, SofteningOf, tangent};

/// Tensile softening of a [`Mazars`] law, with damage `d` in the equivalent strain `e`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(try_from = "MazarsTensionKeys", untagged))]
pub enum MazarsTension {
    /// Fracture energy with `A = 1`, and `B` from `G / h = E e0^2 / 2 + E (e0 / B + 1 / B^2)` for an
    /// element of width `h`. It holds for widths within a factor of five: below the least one the stress
    /// would rise after first damage, above the greatest the element snaps back.
    FractureEnergy {
        /// Fracture energy `G` per area of crack (N/m).
        #[cfg_attr(feature = "keys", serde(rename = "fracture_energy"))]
        energy: f64,
    },
    /// Fracture energy with an exponentially falling stress, `d = 1 - (e0 / e) exp(-B (e - e0))`, and
    /// `B` from `G / h = E e0^2 / 2 + E e0 / B`. It holds for all widths that do not snap back.
    #[cfg_attr(feature = "keys", serde(skip_serializing))]
    FallingStress {
        /// Fracture energy `G` per area of crack (N/m).
        energy: f64,
    },
    /// Given `A` and `B`; the dissipated energy then depends on the mesh.
    Rates {
        /// Share `A` (1), 0 to 1.
        share: f64,
        /// Rate `B` (1), at least `1 / e0`.
        rate: f64,
    },
}

/// Damage evolution in tension: either `fracture_energy` with optional `falling`, or `rate` with optional `share`.
#[cfg(feature = "keys")]
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MazarsTensionKeys {
    /// Fracture energy per area of crack (N/m), above 0.
    fracture_energy: Option<Positive>,
    /// Exponentially decreasing quantity: `damage` (the default) or `stress`.
    falling: Option<Falling>,
    /// Parameter B of the evolution (dimensionless), at least the inverse of the threshold.
    rate: Option<Positive>,
    /// Parameter A of the evolution (dimensionless), above 0 and at most 1, 1 by default.
    share: Option<Share>,
}

/// Quantity that decreases exponentially after first damage.
#[cfg(feature = "keys")]
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Falling {
    /// Damage term of Mazars; element sizes are permitted within a factor of five.
    Damage,
    /// Stress; all element sizes without snap-back are permitted.
    Stress,
}

#[cfg(feature = "keys")]
impl TryFrom<MazarsTensionKeys> for MazarsTension {
    type Error = &'static str;
    fn try_from(keys: MazarsTensionKeys) -> Result<Self, &'static str> {
        let rates = (keys.rate, keys.share);
        match (keys.fracture_energy.map(Positive::get), keys.falling, rates) {
            (Some(energy), Some(Falling::Stress), (None, None)) => {
                Ok(Self::FallingStress { energy })
            }
            (Some(energy), _, (None, None)) => Ok(Self::FractureEnergy { energy }),
            (None, None, (Some(rate), share)) => Ok(Self::Rates {
                share: share.map_or(1.0, Share::get),
                rate: rate.get(),
            }),
            _ => Err(SOFTENING_KEYS),
        }
    }
}

/// Parameters of a [`Mazars`] law, isotropic damage in total strain (Mazars 1986).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
pub struct MazarsParameters {
    /// Elastic medium.
    #[cfg_attr(feature = "keys", serde(rename = "+"), schemars(flatten))]
    pub medium: ElasticMedium,
    /// Damage threshold: equivalent strain at first damage `e0` (1), 1e-9 to 1.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub threshold: f64,
    /// Damage evolution in tension.
    pub tension: MazarsTension,
    /// Share `A` in compression (1), 0 to 2; above 1 damage is limited by the residual stiffness.
    #[cfg_attr(feature = "keys", serde(rename = "compression.share"))]
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub compression_share: f64,
    /// Rate `B` in compression (1), above 0.
    #[cfg_attr(feature = "keys", serde(rename = "compression.rate"))]
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub compression_rate: f64,
    /// Residual stiffness: share that damage never removes (1), 1e-6 to 1; as key 0.001 by default. An open crack bears this
    /// share of E times its opening over the width of the element.
    #[cfg_attr(feature = "keys", serde(with = "Share", default = "ratio::<1, 1000>"))]
    pub residual_stiffness: f64,
}

const EQUIVALENT: usize = 0;
const DAMAGE_TENSION: usize = 1;
const DAMAGE_COMPRESSION: usize = 2;
const DAMAGE: usize = 3;
const WIDTH: usize = 4;
const HISTORY: [HistoryVariable; 5] = {
    [
        number("equivalent_strain"),
        number("damage_tension"),
        number("damage_compression"),
        number("damage"),
        CRACK_BAND_WIDTH,
    ]
};

/// Elastic law with scalar damage in total strain, after Mazars.
///
/// `sigma = (1 - D) C e`, `D = a_t d_t + a_c d_c`
///
/// with the largest `d_t` and `d_c` so far of the [`Softening`](crate::Softening) equation in the equivalent
/// strain `sqrt(sum <e_i>^2)`, and the weights `a_t = sum e_ti <e_i> / sum <e_i>^2`,
/// `a_c = 1 - a_t`, where `e_t` is the elastic strain of the tensile principal stresses alone. The
/// strain `e` includes that of the initial stress, `C^-1 sigma0`.
///
/// History: the largest equivalent strain (of steps in which the strain as a whole was above the
/// threshold), `d_t`, `d_c`, `D`, and the width of the element along the greatest principal strain at
/// first damage, which stays that of the crack. There is no plastic strain:
/// unloading is towards the origin. An open crack therefore never becomes free of stress: with the opening `w` in an element of
/// width `h` it bears `r E w / h` for the residual stiffness `r`, which grows with the opening (7 % of the strength
/// at 0.6 mm in 0.1 m for `r` = 0.001). With the weights `D` may fall on paths between tension and
/// compression. A strain that is not finite gives a stress that is not finite.
///
/// Source: Mazars (1986), *Engineering Fracture Mechanics* 25(5); energy after the crack band of
/// Bazant & Oh (1983).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mazars {
    parameters: MazarsParameters,
    lambda: f64,
    shear: f64,
}

impl Mazars {
    /// Law of the given parameters.
    ///
    /// # Errors
    /// If a parameter is outside its range; [`MaterialError::Hardening`] for a rate below `1 / e0`.
    pub fn new(parameters: MazarsParameters) -> Result<Self, MaterialError> {
        let p = &parameters;
        p.medium.checked()?;
        ParameterError::check("threshold", p.threshold, 1.0e-9, 1.0)?;
        ParameterError::check("compression_share", p.compression_share, 0.0, 2.0)?;
        let least = f64::MIN_POSITIVE;
        ParameterError::check("compression_rate", p.compression_rate, least, 1.0e12)?;
        ParameterError::check("residual_stiffness", p.residual_stiffness, 1.0e-6, 1.0)?;
        match p.tension {
            MazarsTension::FractureEnergy { energy } | MazarsTension::FallingStress { energy } => {
                ParameterError::check("energy", energy, least, 1.0e12)?;
            }
            MazarsTension::Rates { share, rate } => {
                ParameterError::check("share", share, 0.0, 1.0)?;
                ParameterError::check("rate", rate, least, 1.0e12)?;
                let product = rate * p.threshold;
                if product < 1.0 - 1.0e-9 {
                    return Err(MaterialError::Hardening { product });
                }
            }
        }
        Ok(Self {
            lambda: p.medium.lambda(),
            shear: p.medium.shear(),
            parameters,
        })
    }

    /// Parameters of the law.
    pub fn parameters(&self) -> &MazarsParameters {
        &self.parameters
    }

    /// Least and greatest width of elements (m) for softening by fracture energy; `None` for given rates.
    pub fn permitted_sizes(&self) -> Option<[f64; 2]> {
        let at_peak = self.parameters.medium.young * self.parameters.threshold.powi(2);
        match self.parameters.tension {
            // 1 / B = e0 and 1 / B = 0.
            MazarsTension::FractureEnergy { energy } => {
                Some([energy / (2.5 * at_peak), energy / (0.5 * at_peak)])
            }
            MazarsTension::FallingStress { energy } => Some([0.0, energy / (0.5 * at_peak)]),
            MazarsTension::Rates { .. } => None,
        }
    }

    /// Checks that the width of an element normal to a crack (m) is neither too small nor too large.
    ///
    /// # Errors
    /// [`MaterialError::SnapBack`], with the largest permitted width, or
    /// [`MaterialError::Hardening`], with the product `B e0` of an element that is too small.
    pub fn check_size(&self, size: f64) -> Result<(), MaterialError> {
        let sizes = self.permitted_sizes();
        let largest = sizes.map(|[_, largest]| largest);
        check_size(size, &[(SofteningOf::Tension, largest)])?;
        match sizes {
            Some([least, _]) if size < least => Err(MaterialError::Hardening {
                product: self.parameters.threshold / self.inverse_rate(size),
            }),
            _ => Ok(()),
        }
    }

    /// Norms of the strains of a unit mean stress and of a unit `sqrt(J2)` (1/Pa): `sum e_i^2 = (p /
    /// K)^2 / 3 + J2 / 2 G^2`.
    #[inline(always)]
    fn strain_norms(&self) -> [f64; 2] {
        let medium = &self.parameters.medium;
        let volume = 1.0 / (3.0_f64.sqrt() * medium.bulk());
        [volume, 1.0 / (core::f64::consts::SQRT_2 * medium.shear())]
    }

    /// Norm of the strain of a stress, an upper bound of the equivalent strain without principal values.
    #[inline(always)]
    fn bound<L: Lane>(&self, stress: &Stress<L>) -> L {
        let (mean, shear) = stress.mean_and_shear();
        let [volume, shape] = self.strain_norms().map(|factor| mean.constant(factor));
        let (volume, shape) = (mean * volume, shear * shape);
        volume.mul_add(volume, shape * shape).sqrt()
    }

    /// Inverse rate `1 / B` in tension for an element of a width (m).
    #[inline(always)]
    fn inverse_rate<L: Lane>(&self, size: L) -> L {
        match self.parameters.tension {
            MazarsTension::FractureEnergy { energy } => {
                let length = energy / self.parameters.medium.young;
                inverse_rate_in_total_strain(size, length, self.parameters.threshold)
            }
            MazarsTension::FallingStress { energy } => {
                let at_peak = self.parameters.medium.young * self.parameters.threshold;
                let half = size.constant(0.5 * self.parameters.threshold);
                let inverse = size.constant(energy / at_peak) / size - half;
                inverse.max(size.constant(STEEPEST))
            }
            MazarsTension::Rates { rate, .. } => size.constant(1.0 / rate),
        }
    }
    /// Damage state of principal stresses (Pa) after the largest equivalent strain and the damage in tension and in
    /// compression `before`, in an element of a width (m).
    #[inline(always)]
    fn state<L: Lane>(
        &self,
        values: &[L; 3],
        [before, torn_before, broken_before]: [L; 3],
        size: L,
    ) -> DamageState<L> {
        let p = &self.parameters;
        let number = |value: f64| before.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        // Principal strains times E, of all principal stresses and of the tensile ones.
        let poisson = p.medium.poisson;
        let stretches = each(&strains_times_young(values, poisson), |e| e.max(zero));
        let pulled = strains_times_young(&each(values, |s| s.max(zero)), poisson);
        // Relative to the largest, so that squares are within the range of numbers.
        let largest = stretches[0].max(stretches[1]).max(stretches[2]);
        let some = zero.less(largest);
        let divisor = largest.select(some, one);
        let shares = each(&stretches, |e| e / divisor);
        let [a, b, c] = shares;
        let square = a.mul_add(a, b.mul_add(b, c * c));
        let [x, y, z] = each(&pulled, |e| e / divisor);
        let tensile = x.mul_add(a, y.mul_add(b, z * c));
        let weight = (tensile / square.select(some, one)).min(one).max(zero);
        let weight = weight.select(some, one);
        let equivalent = largest * square.sqrt() * number(1.0 / p.medium.young);

        let threshold = p.threshold;
        let most = 1.0 - p.residual_stiffness;
        let rate = one / self.inverse_rate(size);
        let torn = match p.tension {
            MazarsTension::FractureEnergy { .. } => {
                damage_of(equivalent, threshold, 1.0, rate, most)
            }
            MazarsTension::FallingStress { .. } => {
                damage_of_falling_stress(equivalent, threshold, rate, most)
            }
            MazarsTension::Rates { share, .. } => {
                damage_of(equivalent, threshold, share, rate, most)
            }
        };
        let torn = torn.max(torn_before);
        let rate = number(p.compression_rate);
        let broken = damage_of(equivalent, threshold, p.compression_share, rate, most);
        let broken = broken.max(broken_before);
        let damage = weight * torn + (one - weight) * broken;
        DamageState {
            equivalent: equivalent.max(before),
            torn,
            broken,
            damage,
        }
    }
}

/// Largest equivalent strain, and the damage that belongs to it.
struct DamageState<L> {
    equivalent: L,
    torn: L,
    broken: L,
    damage: L,
}

/// Principal strains times Young's modulus, of principal stresses (Pa).
#[inline(always)]
fn strains_times_young<L: Lane>(stresses: &[L; 3], poisson: f64) -> [L; 3] {
    let number = |value: f64| stresses[0].constant(value);
    let (own, common) = (number(1.0 + poisson), number(poisson));
    let sum = common * (stresses[0] + stresses[1] + stresses[2]);
    each(stresses, |s| own.mul_add(s, -sum))
}

impl ElasticInSeries for Mazars {
    /// The threshold is a strain: it falls as the moduli rise, so that the strength is unchanged.
    fn with_stiffness(&self, factor: f64) -> Self {
        let mut law = *self;
        let p = &mut law.parameters;
        p.medium = stiffened(&self.parameters.medium, factor);
        p.threshold /= factor;
        p.compression_rate *= factor;
        if let MazarsTension::Rates { rate, .. } = &mut p.tension {
            *rate *= factor;
        }
        law.lambda *= factor;
        law.shear *= factor;
        law
    }
}

impl ConstitutiveLaw for Mazars {
    fn name(&self) -> &str {
        "mazars"
    }
    fn medium(&self) -> ElasticMedium {
        self.parameters.medium
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &HISTORY
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let p = &self.parameters;
        let old = input.history;
        let first = input.strain.0[0];
        let number = |value: f64| first.constant(value);
        let one = number(1.0);
        let change = Stress::elastic(number(self.lambda), number(self.shear), &input.strain);
        let total = input.initial + change;
        history::copy::<L, { HISTORY.len() }>(old, new_history);
        let sound = number(p.threshold);
        let damaged = sound.less(self.bound(&total).max(old[EQUIVALENT]));
        if !first.any(damaged) {
            return change;
        }
        let axes = PrincipalAxes::of(&total);
        let width = crack_band::width(old[WIDTH], &input.extents, &axes.directions[0]);
        let before = [EQUIVALENT, DAMAGE_TENSION, DAMAGE_COMPRESSION].map(|index| old[index]);
        let state = self.state(&axes.values, before, width);
        let damage = state.damage;
        for (variable, value) in [
            (EQUIVALENT, state.equivalent),
            (DAMAGE_TENSION, state.torn),
            (DAMAGE_COMPRESSION, state.broken),
            (DAMAGE, damage),
            (WIDTH, crack_band::updated(old[WIDTH], width, state.torn)),
        ] {
            new_history[variable] = value.select(damaged, old[variable]);
        }
        let left = one - damage;
        let mut nominal = change;
        for i in 0..6 {
            let weakened = left * change.0[i] - damage * input.initial.0[i];
            nominal.0[i] = weakened.select(damaged, change.0[i]);
        }
        nominal
    }
    /// Polygon within the circle that bounds elastic strains: its corners are on the axes of volumetric
    /// and deviatoric strain and halfway between.
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        let [volume, shape] = self.strain_norms();
        let half = core::f64::consts::SQRT_2 - 1.0;
        let sides = [(1.0, half), (half, 1.0)].into_iter();
        let sides = sides.flat_map(|(a, b)| [(a * volume, b * shape), (-a * volume, b * shape)]);
        let threshold = self.parameters.threshold;
        Some(
            sides.fold(ElasticDomain::EVERYTHING, |domain, (mean, shear)| {
                domain.within(mean, shear, threshold)
            }),
        )
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        let step = Step {
            medium: &self.parameters.medium,
            input,
            elastic: input.strain,
            flowed: None,
            damage: [input.history[DAMAGE], new_history[DAMAGE]],
        };
        Some(step.energy())
    }
    #[inline(always)]
    fn remaining_stiffness<L: Lane>(
        &self,
        _input: &LawInput<L>,
        new_history: &[L],
        _change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        let one = new_history[DAMAGE].constant(1.0);
        let [torn, broken] = [DAMAGE_TENSION, DAMAGE_COMPRESSION].map(|index| new_history[index]);
        RemainingStiffness::whole(one)
            .with_undamaged(one - new_history[DAMAGE])
            .with_hourglass((one - torn) * (one - broken))
    }
    /// Consistent tangent with a constant width of the crack; at a kink that of one side.
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        let medium = &self.parameters.medium;
        let before = input.history[EQUIVALENT];
        let total = input.initial + Stress::elastic(self.lambda, self.shear, &input.strain);
        let normal = PrincipalAxes::of(&total).directions[0];
        let width = crack_band::width(input.history[WIDTH], &input.extents, &normal);
        let respond = |trial: &[Dual; 3]| {
            let stress = Stress([
                trial[0].value,
                trial[1].value,
                trial[2].value,
                0.0,
                0.0,
                0.0,
            ]);
            if self.bound(&stress).max(before) <= self.parameters.threshold {
                return *trial;
            }
            let size = Dual::fixed(width);
            let before = [EQUIVALENT, DAMAGE_TENSION, DAMAGE_COMPRESSION];
            let before = before.map(|index| Dual::fixed(input.history[index]));
            let state = self.state(trial, before, size);
            trial.map(|s| (Dual::fixed(1.0) - state.damage) * s)
        };
        Some(tangent::of_isotropic(medium, input, &input.strain, respond))
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        Ok(self.check_size(size)?)
    }
}
