//! Concrete damaged plasticity after Lubliner, Lee and Fenves.

mod flow;
mod linearised;

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, HistoryVariable, Lane, LawEnergy, LawInput,
    ModelError, ParameterError, RemainingStiffness, Stress, array,
};

use crate::crack_band;
use crate::crack_closure::CrackClosure;
use crate::dual::Dual;
use crate::energy::difference;
use crate::history;
use crate::plastic_damage::{
    COMPRESSION, CRACK_WIDTH, CRUSHING_WIDTH, DAMAGE_COMPRESSION, DAMAGE_INDICES, DAMAGE_TENSION,
    HISTORY, TENSION, YIELD_STATE,
};
use crate::remaining;
use crate::softening::check_size;
use crate::surface::{YieldState, pick, stiffened};
use crate::uniaxial::UniaxialCurve;
use crate::{ElasticInSeries, MaterialError, PrincipalAxes, SofteningOf, tangent};
use flow::Trial;

const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// Parameters of a [`LeeFenves`] law: yield surface of Lubliner et al. (1989) with hardening and softening, and damage
/// in tension and compression (Lee & Fenves 1998).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
pub struct LeeFenvesParameters {
    /// Elastic medium.
    #[cfg_attr(feature = "keys", serde(rename = "+"), schemars(flatten))]
    pub medium: ElasticMedium,
    /// Uniaxial tensile strength `f_t` (Pa), above 0.
    #[cfg_attr(feature = "keys", serde(rename = "tensile_strength"))]
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub tension_strength: f64,
    /// Uniaxial compressive strength `f_c` (Pa), at least `f_t`.
    #[cfg_attr(feature = "keys", serde(rename = "compressive_strength"))]
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub compression_strength: f64,
    /// Uniaxial compressive stress at first flow `f_0` (Pa), `f_c / 10` (at least `f_t`) to `f_c`; as key `f_c` by default.
    #[cfg_attr(feature = "keys", serde(rename = "compressive_limit"))]
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    #[cfg_attr(feature = "keys", schemars(extend("x-like" = "compressive_strength")))]
    pub compression_limit: f64,
    /// Ratio of equal biaxial to uniaxial compressive strength `b` (1), 1 to 1.5; concrete, and as key by default: 1.16.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    #[cfg_attr(feature = "keys", serde(default = "ratio::<116, 100>"))]
    pub biaxial_ratio: f64,
    /// Ratio `K_c` of the surface's radius on the tensile meridian to that on the compressive one (1),
    /// 0.55 to 1; concrete, and as key by default: 2/3.
    #[cfg_attr(feature = "keys", serde(with = "Positive", default = "ratio::<2, 3>"))]
    pub meridian_ratio: f64,
    /// Dilation angle psi in the plane of mean and equivalent stress (degrees), from 1 to the greatest at which flow
    /// generates no energy, `atan(sqrt(3) min(s, sqrt(3) / 2))` with `s = (3 A + g) / (sqrt(3) + 2 g / sqrt(3))`, where
    /// `A` and `g` follow from `biaxial_ratio` and `meridian_ratio` as in the yield function; greater angles are
    /// rejected. Concrete, and as key by default: 36, with the ratios of concrete above at most 48.3.
    #[cfg_attr(feature = "keys", serde(with = "Positive", default = "ratio::<36, 1>"))]
    pub dilation: f64,
    /// Fracture energy in tension, per area of crack (N/m), above 0, independent of the element size.
    #[cfg_attr(feature = "keys", serde(rename = "tension.fracture_energy"))]
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub tension_energy: f64,
    /// Fracture energy in compression, per area of crushing band (N/m), above 0, independent of the element size.
    #[cfg_attr(feature = "keys", serde(rename = "compression.fracture_energy"))]
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub compression_energy: f64,
    /// Share `r_t` of damage in tensile softening (1), from 0 (all strain is plastic) to 1 (the effective
    /// strength is constant); as key 1 by default.
    #[cfg_attr(feature = "keys", serde(rename = "tension.damage"))]
    #[cfg_attr(
        feature = "keys",
        serde(with = "NonNegative", default = "ratio::<1, 1>")
    )]
    pub tension_damage: f64,
    /// Share `r_c` of damage in compressive softening (1), 0 to 1; as key 0.5 by default.
    #[cfg_attr(feature = "keys", serde(rename = "compression.damage"))]
    #[cfg_attr(
        feature = "keys",
        serde(with = "NonNegative", default = "ratio::<1, 2>")
    )]
    pub compression_damage: f64,
    /// Stiffness recovery `w`: share of tensile damage that is without effect when cracks close (1), 0 to 1; as key 1 by
    /// default.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    #[cfg_attr(feature = "keys", serde(default = "ratio::<1, 1>"))]
    pub stiffness_recovery: f64,
    /// Residual stiffness: share that damage never removes (1), 1e-6 to 1; as key 0.001 by default.
    #[cfg_attr(feature = "keys", serde(with = "Share", default = "ratio::<1, 1000>"))]
    pub residual_stiffness: f64,
}

/// Concrete damaged plasticity: softening plasticity of the effective stress with damage in tension
/// and compression.
///
/// `sigma = (1 - d_c) ((1 - d_t) s + w d_t s-)`, `s = sigma0 + C (epsilon - epsilon_p)`, with the stiffness recovery `w`, the
/// closed-crack stress `s-` as in [`PlasticDamage`](crate::PlasticDamage), and with `I1`, `J2` and the greatest
/// principal value `s1` of `s`:
///
/// - yield: `(A I1 + sqrt(3 J2) + B <s1> - g <-s1>) / (1 - A) <= c`, `A = (b - 1) / (2b - 1)` of the
///   biaxial ratio `b`, `B = (1 - A) c / t - (1 + A)`, `g = 3 (1 - K_c) / (2 K_c - 1)`;
/// - flow: along `sqrt(3 J2) + tan(psi) I1 / 3`;
/// - effective strengths `t` and `c` and damage `d_t` and `d_c` by the uniaxial curves
///
///   `(1 - d_t) t = f_t exp(-b_t e_t)`, `1 - d_t = exp(-r_t b_t e_t)`
///
///   `(1 - d_c) c = f_0 ((1 + a) exp(-b_c e_c) - a exp(-2 b_c e_c))`, `1 - d_c = exp(-r_c b_c e_c)`
///
///   where `a >= 1` makes the peak `f_c`, and `b_t`, `b_c` are such that a band of the element's
///   width dissipates the fracture energy, elastic energy included;
/// - `de_t = r <dp1>`, `de_c = (1 - r) <-dp3>` of the greatest and least increment of plastic strain
///   and the share of tension `r = sum <s_i> / sum |s_i|`;
/// - `D = 1 - (1 - d_c)(1 - k d_t)`, `k = 1 - w U(s-) / U(s)` with the elastic energy `U`.
///
/// # History
/// As [`PlasticDamage`](crate::PlasticDamage): plastic strain (six components, engineering shears),
/// `e_t`, `e_c`, `d_t`, `d_c`, `D`, damage type, [`YieldState`] (shear: on the cone of the flow,
/// tension: at its apex), and the widths of the bands of cracks and of crushing: those of the element
/// along the greatest and the least principal stress when `e_t` and `e_c` first grew.
///
/// # Return
/// The deviator keeps its direction, so the returned stress, the increments of plastic strain, `r`
/// and both strengths are functions of one unknown, the amount of flow; the yield condition is
/// solved for it to rounding within a bracket. The end of a step is consistent with its strengths,
/// whatever the step.
///
/// # Valid range
/// Elements up to [`largest_size`](Self::largest_size), which [`check_size`](Self::check_size)
/// verifies; wider ones soften as steeply as can be followed and dissipate more energy. Where
/// `f_0 < f_c`, the hardening before the peak is part of the regularised curve, and an
/// element of a wide bar that unloads from it has dissipated its share: with `f_0 = f_c` crushing
/// is objective. The effective strength never falls below a thousandth. A strain that is not finite
/// gives a stress that is not finite.
///
/// # Why so
/// *Crushed concrete has lost its tensile strength too*: `t` is at most `c f_t / f_0`. Otherwise
/// `B` would become negative, and the surface would open towards tension.
///
/// Source: Lubliner, Oliver, Oller & Onate (1989), *Int. J. Solids Structures* 25(3); Lee & Fenves
/// (1998), *J. Eng. Mech.* 124(8).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeeFenves {
    parameters: LeeFenvesParameters,
    tension: UniaxialCurve,
    compression: UniaxialCurve,
    /// Coefficient `A` of the yield function.
    biaxial: f64,
    /// Coefficient `g` of the yield function.
    confined: f64,
    /// Decrease of the mean stress per decrease of `sqrt(J2)` in plastic flow.
    dilatancy: f64,
    lambda: f64,
    shear: f64,
}

impl LeeFenves {
    /// Law of the given parameters.
    ///
    /// # Errors
    /// If a parameter is outside its range.
    pub fn new(parameters: LeeFenvesParameters) -> Result<Self, MaterialError> {
        let p = &parameters;
        let medium = p.medium.checked()?;
        let least = f64::MIN_POSITIVE;
        for (name, value, from, to) in [
            ("tension_strength", p.tension_strength, least, 1.0e12),
            (
                "compression_strength",
                p.compression_strength,
                p.tension_strength,
                1.0e12,
            ),
            (
                "compression_limit",
                p.compression_limit,
                (0.1 * p.compression_strength).max(p.tension_strength),
                p.compression_strength,
            ),
            ("biaxial_ratio", p.biaxial_ratio, 1.0, 1.5),
            ("meridian_ratio", p.meridian_ratio, 0.55, 1.0),
            ("tension_damage", p.tension_damage, 0.0, 1.0),
            ("compression_damage", p.compression_damage, 0.0, 1.0),
            ("stiffness_recovery", p.stiffness_recovery, 0.0, 1.0),
            ("residual_stiffness", p.residual_stiffness, 1.0e-6, 1.0),
        ] {
            ParameterError::check(name, value, from, to)?;
        }
        let biaxial = (p.biaxial_ratio - 1.0) / (2.0 * p.biaxial_ratio - 1.0);
        let confined = 3.0 * (1.0 - p.meridian_ratio) / (2.0 * p.meridian_ratio - 1.0);
        // Flow gives s : dp = (dl / G) (sqrt(J2) + tan(psi) p / sqrt 3), not negative on the surface
        // down to any pressure, least on the tensile meridian.
        let steepness = (3.0 * biaxial + confined) / (ROOT_3 + 2.0 * confined / ROOT_3);
        let greatest = (ROOT_3 * steepness.min(0.5 * ROOT_3)).atan().to_degrees();
        ParameterError::check("dilation", p.dilation, 1.0, greatest)?;
        let ratio = p.compression_strength / p.compression_limit;
        let hardening = 2.0 * ratio - 1.0 + 2.0 * (ratio * (ratio - 1.0)).sqrt();
        let flow = p.dilation.to_radians().tan() / (3.0 * ROOT_3);
        let young = medium.young;
        Ok(Self {
            tension: UniaxialCurve::new(
                p.tension_strength,
                0.0,
                p.tension_damage,
                p.tension_energy,
                young,
            )?,
            compression: UniaxialCurve::new(
                p.compression_limit,
                hardening,
                p.compression_damage,
                p.compression_energy,
                young,
            )?,
            biaxial,
            confined,
            dilatancy: 3.0 * medium.bulk() / medium.shear() * flow,
            lambda: medium.lambda(),
            shear: medium.shear(),
            parameters,
        })
    }

    /// Parameters of the law.
    pub fn parameters(&self) -> &LeeFenvesParameters {
        &self.parameters
    }

    /// Strain (1, positive) at the uniaxial compressive strength in an element of a width (m). Where `f_0 < f_c` the rise belongs to the
    /// crushing energy, and the strain increases as the width decreases.
    pub fn strain_at_strength(&self, size: f64) -> f64 {
        let young = self.parameters.medium.young;
        self.compression.strain_at_peak(size, young)
    }

    /// Largest width of an element that dissipates its fracture energies without snap-back (m).
    pub fn largest_size(&self) -> f64 {
        let crushing = self.compression.largest_size();
        self.tension.largest_size().min(crushing)
    }

    /// Checks that an element of a width normal to a crack (m) does not snap back.
    ///
    /// # Errors
    /// [`MaterialError::SnapBack`], with the largest permitted width.
    pub fn check_size(&self, size: f64) -> Result<(), MaterialError> {
        let limits = [
            (SofteningOf::Tension, Some(self.tension.largest_size())),
            (
                SofteningOf::Compression,
                Some(self.compression.largest_size()),
            ),
        ];
        check_size(size, &limits)
    }

    /// Yield function of an effective stress (Pa) and a history in an element of a width (m), relative
    /// to the effective compressive strength: positive outside the surface.
    pub fn yield_function(&self, effective: &Stress, history: &[f64], size: f64) -> f64 {
        let (mean, shear) = effective.mean_and_shear();
        let greatest = PrincipalAxes::of(effective).values[0];
        let strains = [history[TENSION], history[COMPRESSION]];
        let rates = [self.tension.rate(size), self.compression.rate(size)];
        let strengths = self.strengths(strains, rates).inverse;
        self.excess([mean, shear], greatest, strengths) / (1.0 - self.biaxial)
    }

    #[inline(always)]
    fn closure(&self) -> CrackClosure {
        let p = &self.parameters;
        CrackClosure::new(&p.medium, [p.stiffness_recovery, p.residual_stiffness])
    }

    /// Softening rates `b_t` and `b_c` in bands of the given widths (m).
    #[inline(always)]
    fn rates<L: Lane>(&self, [crack, crushing]: [L; 2]) -> [L; 2] {
        [self.tension.rate(crack), self.compression.rate(crushing)]
    }

    /// Widths of the bands of cracks and of crushing (m), from the axes of the trial stress.
    #[inline(always)]
    fn widths<L: Lane>(&self, input: &LawInput<L>, directions: &[[L; 3]; 3]) -> [L; 2] {
        let [first, _, last] = directions;
        let old = input.history;
        [
            crack_band::width(old[CRACK_WIDTH], &input.extents, first),
            crack_band::width(old[CRUSHING_WIDTH], &input.extents, last),
        ]
    }

    /// Inverses of the effective strengths `t` and `c` (1/Pa) and their derivatives with respect to `e_t`
    /// and `e_c`, the first with respect to both.
    #[inline(always)]
    fn strengths<L: Lane>(&self, strains: [L; 2], rates: [L; 2]) -> Strengths<L> {
        let [compressive, crushing] = self.compression.inverse_strength(strains[1], rates[1]);
        let [own, opening] = self.tension.inverse_strength(strains[0], rates[0]);
        let share = compressive.constant(self.compression.limit() / self.tension.limit());
        let kept = compressive * share;
        let is_kept = own.less(kept);
        let zero = own.constant(0.0);
        Strengths {
            inverse: [own.max(kept), compressive],
            opening: zero.select(is_kept, opening),
            crushing: [(crushing * share).select(is_kept, zero), crushing],
        }
    }

    /// Yield function of the invariants, the greatest stress and the inverses of `t` and `c`,
    /// `(3 A p + sqrt(3 J2) - (1 + A) <s1> - g <-s1>) / c + (1 - A) (<s1> / t - 1)`.
    #[inline(always)]
    fn excess<L: Lane>(
        &self,
        invariants: [L; 2],
        greatest: L,
        [tensile, compressive]: [L; 2],
    ) -> L {
        let number = |value: f64| greatest.constant(value);
        let pulled = greatest.max(number(0.0)) * tensile - number(1.0);
        let pressed = self.over_strength(invariants, greatest) * compressive;
        number(1.0 - self.biaxial).mul_add(pulled, pressed)
    }

    /// Terms of the yield function over the compressive strength,
    /// `3 A p + sqrt(3 J2) - (1 + A) <s1> - g <-s1>`.
    #[inline(always)]
    fn over_strength<L: Lane>(&self, [mean, shear]: [L; 2], greatest: L) -> L {
        let number = |value: f64| mean.constant(value);
        let zero = number(0.0);
        let invariants = number(3.0 * self.biaxial).mul_add(mean, number(ROOT_3) * shear);
        let pressed = number(self.confined).mul_add(greatest.min(zero), invariants);
        number(-1.0 - self.biaxial).mul_add(greatest.max(zero), pressed)
    }
}

/// Inverses of the effective strengths `t` and `c`, with derivatives.
struct Strengths<L> {
    /// Inverses `1 / t` and `1 / c` (1/Pa).
    inverse: [L; 2],
    /// Derivative of the first with respect to `e_t`.
    opening: L,
    /// Derivatives of both with respect to `e_c`.
    crushing: [L; 2],
}

impl ElasticInSeries for LeeFenves {
    fn with_stiffness(&self, factor: f64) -> Self {
        let mut law = *self;
        law.parameters.medium = stiffened(&self.parameters.medium, factor);
        law.tension = self.tension.with_stiffness(factor);
        law.compression = self.compression.with_stiffness(factor);
        law.lambda *= factor;
        law.shear *= factor;
        law
    }
    /// The strengths follow the plastic strain at a rate by the fracture energy, elastic energy included.
    fn with_strengths_of(mut self, other: &Self) -> Self {
        (self.tension, self.compression) = (other.tension, other.compression);
        self
    }
    #[inline(always)]
    fn inelastic_strain<L: Lane>(&self, history: &[L]) -> Option<[L; 6]> {
        Some(array(|i| history[i]))
    }
}

impl ConstitutiveLaw for LeeFenves {
    fn name(&self) -> &str {
        "lee-fenves"
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
        let (zero, one) = (number(0.0), number(1.0));
        let elastic = difference(&input.strain.0, old);
        let mut change = Stress::elastic(number(self.lambda), number(self.shear), &elastic);
        let stress = input.initial + change;
        let mut now = history::load::<L, { HISTORY.len() }>(old);
        now[YIELD_STATE] = zero;

        let (mean, shear) = stress.mean_and_shear();
        // Zero, or NaN where squares are outside the range of numbers: no yield function is defined.
        let finite = shear * zero;
        for normal in &mut change.0[..3] {
            *normal = *normal + finite;
        }
        let strains = [old[TENSION], old[COMPRESSION]];
        // Before first damage the band has no width yet, and the softening does not depend on one.
        let known = |index: usize| old[index].select(zero.less(old[index]), one);
        let rates = self.rates([known(CRACK_WIDTH), known(CRUSHING_WIDTH)]);
        // Lanes without flow keep their elastic limits to the last bit while others soften.
        let mut strengths = [
            number(1.0 / self.tension.limit()),
            number(1.0 / self.compression.limit()),
        ];
        let softened = zero.less(strains[0] + strains[1]);
        if first.any(softened) {
            let [tensile, compressive] = self.strengths(strains, rates).inverse;
            strengths = [
                tensile.select(softened, strengths[0]),
                compressive.select(softened, strengths[1]),
            ];
        }
        // Upper bound of the greatest stress.
        let greatest = shear.mul_add(number(2.0 / ROOT_3), mean);
        let bound = self.excess([mean, shear], greatest, strengths);
        let may_yield = zero.less(bound);
        let mut axes_after = None;
        if first.any(may_yield) {
            let axes = PrincipalAxes::of(&stress);
            let values = axes.values;
            let widths = self.widths(input, &axes.directions);
            let rates = self.rates(widths);
            let excess = self.excess([mean, shear], values[0], strengths);
            let excess = excess.select(may_yield, zero);
            let yielded = zero.less(excess);
            let trial = Trial::new([mean, shear], &values, strains, rates);
            let flow = self.flow(&trial, excess.max(zero), strengths);
            let flow = flow.select(yielded, zero);
            let flowed = self.after(&trial, flow);
            axes_after = Some(PrincipalAxes {
                values: pick(yielded, &flowed.stress, &values),
                directions: axes.directions,
            });

            let most = 1.0 - p.residual_stiffness;
            let torn = self.tension.damage(flowed.strains[0], rates[0], most);
            let broken = self.compression.damage(flowed.strains[1], rates[1], most);
            let at_apex = flow.less(shear);
            let state = number(YieldState::Shear.number());
            let state = state.select(at_apex, number(YieldState::Tension.number()));
            let width_after = |index: usize, strain: usize, i: usize| {
                let grown = flowed.strains[i] - old[strain];
                crack_band::updated(old[index], widths[i], grown)
            };
            for (variable, value) in [
                (TENSION, flowed.strains[0]),
                (COMPRESSION, flowed.strains[1]),
                (DAMAGE_TENSION, torn.max(old[DAMAGE_TENSION])),
                (DAMAGE_COMPRESSION, broken.max(old[DAMAGE_COMPRESSION])),
                (YIELD_STATE, state),
                (CRACK_WIDTH, width_after(CRACK_WIDTH, TENSION, 0)),
                (CRUSHING_WIDTH, width_after(CRUSHING_WIDTH, COMPRESSION, 1)),
            ] {
                now[variable] = value.select(yielded, now[variable]);
            }
            // Deviator and mean decrease by the flow, without a difference of large stresses.
            let lowered = number(self.dilatancy) * flow;
            let volume = lowered * number(1.0 / (3.0 * p.medium.bulk()));
            let compliance = number(0.5 / self.shear);
            for i in 0..6 {
                let deviator = if i < 3 {
                    stress.0[i] - mean
                } else {
                    stress.0[i]
                };
                let taken = flowed.released * deviator;
                let (loss, plastic) = if i < 3 {
                    (taken + lowered, compliance.mul_add(taken, volume))
                } else {
                    (taken, (compliance + compliance) * taken)
                };
                change.0[i] = (change.0[i] - loss).select(yielded, change.0[i]);
                now[i] = (old[i] + plastic).select(yielded, old[i]);
            }
            if let Some(is_far) = flowed.far_from(&trial) {
                let factor = self.shrinking(&trial, &flowed);
                let left = one - flowed.released;
                for i in 0..6 {
                    let placed = if i < 3 {
                        (stress.0[i] - mean).mul_add(left, flowed.invariants[0])
                    } else {
                        stress.0[i] * left
                    };
                    let placed = placed * factor - input.initial.0[i];
                    let placed = placed.select(is_far, change.0[i]);
                    change.0[i] = placed.select(yielded, change.0[i]);
                }
            }
        }
        let closure = self.closure();
        let nominal = closure.nominal_change(&change, &input.initial, axes_after, &mut now);
        history::store(&now, new_history);
        nominal
    }
    /// The yield function has one slope along the greatest stress where that is tensile and another
    /// where it is not; the domain is within both, and the greatest stress below its bound.
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        let (tensile, compressive) = (self.tension.limit(), self.compression.limit());
        let strength = (1.0 - self.biaxial) * compressive;
        let pulled = strength / tensile - (1.0 + self.biaxial);
        let part = |domain: ElasticDomain, slope: f64| {
            let mean = 3.0 * self.biaxial + slope;
            domain.within(mean, ROOT_3 + slope * 2.0 / ROOT_3, strength)
        };
        let domain = part(ElasticDomain::EVERYTHING, pulled);
        Some(part(domain, self.confined))
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        let medium = &self.parameters.medium;
        Some(self.closure().energy(medium, input, new_history))
    }
    #[inline(always)]
    fn remaining_stiffness<L: Lane>(
        &self,
        input: &LawInput<L>,
        new_history: &[L],
        _change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        remaining::of_flow(input, new_history, Some(DAMAGE_INDICES))
    }
    /// Consistent tangent with constant widths of bands; at a kink that of one side.
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        let elastic = difference(&input.strain.0, input.history);
        let respond = |trial: &[Dual; 3]| self.principal_response(input, trial);
        let medium = &self.parameters.medium;
        Some(tangent::of_isotropic(medium, input, &elastic, respond))
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        Ok(self.check_size(size)?)
    }
}
