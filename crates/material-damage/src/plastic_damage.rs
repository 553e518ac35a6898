//! Plasticity with scalar damage: the concrete of the paper.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, HistoryVariable, Lane, LawEnergy, LawInput,
    ModelError, ParameterError, RemainingStiffness, Stress, array, each,
};

use crate::crack_band::{self, CRACK_BAND_WIDTH, CRUSHING_BAND_WIDTH};
use crate::crack_closure::CrackClosure;
use crate::dual::Dual;
use crate::energy::difference;
use crate::history::{self, PLASTIC_STRAINS, number};
use crate::remaining::{self, DamageIndices};
use crate::softening::{DamageCurve, check_size};
use crate::surface::{FlowInAxes, YieldSurface, strains_of_loss};
use crate::{ElasticInSeries, MaterialError, PrincipalAxes, Softening, SofteningOf, tangent};

/// Parameters of a [`PlasticDamage`] law.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
pub struct PlasticDamageParameters<S> {
    /// Yield surface of the effective stress.
    #[cfg_attr(feature = "keys", serde(rename = "+"), schemars(flatten))]
    pub surface: S,
    /// Damage evolution in tension (opening of cracks); as key that of the preset, or no damage.
    #[cfg_attr(feature = "keys", serde(default))]
    pub tension: Softening,
    /// Damage evolution in compression (crushing and shear); as key that of the preset, or no damage.
    #[cfg_attr(feature = "keys", serde(default))]
    pub compression: Softening,
    /// Stiffness recovery `w`: share of tensile damage that is without effect when cracks close (1), 0 to 1; as key 1 by
    /// default.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    #[cfg_attr(feature = "keys", serde(default = "ratio::<1, 1>"))]
    pub stiffness_recovery: f64,
    /// Residual stiffness: share that damage never removes (1), 1e-6 to 1; as key 0.001 by default.
    #[cfg_attr(feature = "keys", serde(with = "Share", default = "ratio::<1, 1000>"))]
    pub residual_stiffness: f64,
}

impl<S> PlasticDamageParameters<S> {
    /// The same parameters with another surface.
    pub fn with_surface<T>(&self, surface: T) -> PlasticDamageParameters<T> {
        PlasticDamageParameters {
            surface,
            tension: self.tension,
            compression: self.compression,
            stiffness_recovery: self.stiffness_recovery,
            residual_stiffness: self.residual_stiffness,
        }
    }
}

pub(crate) const TENSION: usize = 6;
pub(crate) const COMPRESSION: usize = 7;
pub(crate) const DAMAGE_TENSION: usize = 8;
pub(crate) const DAMAGE_COMPRESSION: usize = 9;
pub(crate) const DAMAGE: usize = 10;
pub(crate) const DAMAGE_TYPE: usize = 11;
pub(crate) const YIELD_STATE: usize = 12;
pub(crate) const CRACK_WIDTH: usize = 13;
pub(crate) const CRUSHING_WIDTH: usize = 14;
pub(crate) const DAMAGE_INDICES: DamageIndices = DamageIndices {
    whole: DAMAGE,
    parts: [DAMAGE_TENSION, DAMAGE_COMPRESSION],
};
pub(crate) const HISTORY: [HistoryVariable; 15] = {
    let [xx, yy, zz, xy, yz, zx] = PLASTIC_STRAINS;
    [
        xx,
        yy,
        zz,
        xy,
        yz,
        zx,
        number("equivalent_plastic_strain_tension"),
        number("equivalent_plastic_strain_compression"),
        number("damage_tension"),
        number("damage_compression"),
        number("damage"),
        history::DAMAGE_TYPE,
        history::YIELD_STATE,
        CRACK_BAND_WIDTH,
        CRUSHING_BAND_WIDTH,
    ]
};

/// Perfect plasticity of the effective stress, with scalar damage by the plastic strain.
///
/// `sigma = (1 - d_c) ((1 - d_t) s + w d_t s-)`, `s = sigma0 + C (epsilon - epsilon_p)` returned to the yield surface
///
/// with the [`stiffness_recovery`](PlasticDamageParameters::stiffness_recovery) `w` and the closed-crack stress `s-`:
/// the effective stress less that of crack strains whose principal values are not negative, such that its elastic energy
/// `U(s-)` is least, the stress of a material without tensile strength. It equals `s` where no principal stress
/// is tensile and vanishes normal to an open crack.
///
/// `d_t` and `d_c` grow by [`Softening`] with `e_t`, the sum of the positive principal increments
/// of plastic strain, and `e_c`, the sum of the negative ones times `1 - r`, `r = sum <s_i> / sum |s_i|`
/// (after Lee & Fenves 1998). The damage `D` is the share of the elastic energy of `s` that is lost:
///
/// `D = 1 - (1 - d_c)(1 - k d_t)`, `k = 1 - w U(s-) / U(s)`
///
/// The paper's coefficient `k` of stiffness restitution thus is 1 where cracks are open and `1 - w` under pressure.
///
/// # History
/// Plastic strain (six components, engineering shears), `e_t`, `e_c`, `d_t`, `d_c`, `D`, the
/// damage type (0 none, 1 tension, 2 shear or compression, 3 both; of `d_t` and `d_c` above a
/// thousandth), the [`YieldState`](crate::YieldState) of the last step, and the widths of the bands of
/// cracks and of crushing: those of the element along the greatest and the least principal stress at
/// first damage in tension and in compression.
///
/// # Valid range
/// `D` is below one by the residual stiffness. Softening by fracture energy permits elements
/// up to [`largest_size`](Self::largest_size), which [`check_size`](Self::check_size) verifies;
/// in larger ones damage is immediate. A strain that is not finite gives a stress that is not
/// finite. When cracks close, `D` falls; no energy is gained by it. With recovery a crack that opens under a free
/// lateral strain keeps a lateral effective stress, and dissipates its fracture energy to two hundredths.
///
/// # Why so
/// *Closing cracks generate no energy.* Eq. (25) multiplies all stresses by one factor `1 - D` with `k = 1 - w (1 - r)`.
/// That stress is not the derivative of an energy: where a crack closes beside stresses in other directions, these jump,
/// and a body that is shaken gains energy. Here the stress at constant plastic strain and damage is the derivative of
/// `(1 - d_c) ((1 - d_t) U(s) + w d_t U(s-))`, which is convex, so that no tangent exceeds the elastic one. Under uniaxial
/// pressure both agree.
///
/// *Lateral contraction of an opening crack is not crushing.* A surface with dilation contracts
/// laterally as it yields in tension: without a factor these increments would add compressive damage to
/// a crack and falsify its fracture energy. The factor `1 - r` is zero in tension and one in
/// compression.
///
/// Sources: Wang, Chen & Xiao (2019), Eq. (25); Carol & Willam (1996), *Int. J. Solids Structures* 33(20-22), for
/// the energy; Del Piero (1989), *Meccanica* 24, for the material without tensile strength.
///
/// ```
/// use powerhouse_material_damage::presets;
/// use powerhouse_model::{ConstitutiveLaw, LawInput, Strain};
///
/// let concrete = presets::paper_concrete()?;
/// concrete.check_size(0.5)?;
/// let strain = Strain([4.0e-4, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// let (old, mut new) = ([0.0; 15], [0.0; 15]);
/// concrete.stress_change(&LawInput::new(strain, &old).with_size(0.5), &mut new);
/// assert!(new[8] > 0.5, "the point has cracked: d_t = {}", new[8]);
/// # Ok::<(), powerhouse_material_damage::MaterialError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticDamage<S> {
    parameters: PlasticDamageParameters<S>,
    tension: DamageCurve,
    compression: DamageCurve,
    lambda: f64,
    shear: f64,
}

impl<S: YieldSurface> PlasticDamage<S> {
    /// Law of the given parameters.
    ///
    /// # Errors
    /// If a parameter is outside its range.
    pub fn new(parameters: PlasticDamageParameters<S>) -> Result<Self, MaterialError> {
        let PlasticDamageParameters {
            surface,
            tension,
            compression,
            stiffness_recovery,
            residual_stiffness,
        } = &parameters;
        ParameterError::check("stiffness_recovery", *stiffness_recovery, 0.0, 1.0)?;
        ParameterError::check("residual_stiffness", *residual_stiffness, 1.0e-6, 1.0)?;
        let medium = surface.medium();
        let sum = |flow: [f64; 3], sign: f64| flow.iter().map(|e| (sign * e).max(0.0)).sum();
        let opening = sum(surface.flow_in_uniaxial_tension(), 1.0);
        let closing = sum(surface.flow_in_uniaxial_compression(), -1.0);
        let [pulled, pressed] = [surface.uniaxial_tension(), surface.uniaxial_compression()];
        Ok(Self {
            tension: DamageCurve::new(*tension, pulled, medium.young, opening)?,
            compression: DamageCurve::new(*compression, pressed, medium.young, closing)?,
            lambda: medium.lambda(),
            shear: medium.shear(),
            parameters,
        })
    }

    /// Parameters of the law.
    pub fn parameters(&self) -> &PlasticDamageParameters<S> {
        &self.parameters
    }

    #[inline(always)]
    fn closure(&self) -> CrackClosure {
        let p = &self.parameters;
        CrackClosure::new(&self.medium(), [p.stiffness_recovery, p.residual_stiffness])
    }

    /// Damage `d_t` and `d_c` of equivalent plastic strains in bands of the given widths (m).
    #[inline(always)]
    fn damage<L: Lane>(&self, [opened, crushed]: [L; 2], widths: [L; 2]) -> [L; 2] {
        let most = 1.0 - self.parameters.residual_stiffness;
        [
            self.tension.damage(opened, widths[0], most),
            self.compression.damage(crushed, widths[1], most),
        ]
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

    /// Largest width of an element that dissipates its fracture energy without snap-back (m); `None` if
    /// no softening is by fracture energy.
    pub fn largest_size(&self) -> Option<f64> {
        let sizes = [self.tension.largest_size(), self.compression.largest_size()];
        sizes.into_iter().flatten().reduce(f64::min)
    }

    /// Checks that an element of a width normal to a crack (m) does not snap back.
    ///
    /// # Errors
    /// [`MaterialError::SnapBack`], with the largest permitted width.
    pub fn check_size(&self, size: f64) -> Result<(), MaterialError> {
        let limits = [
            (SofteningOf::Tension, self.tension.largest_size()),
            (SofteningOf::Compression, self.compression.largest_size()),
        ];
        check_size(size, &limits)
    }
}

impl<S: YieldSurface> ElasticInSeries for PlasticDamage<S> {
    fn with_stiffness(&self, factor: f64) -> Self {
        let mut law = self.clone();
        law.parameters.surface = self.parameters.surface.with_stiffness(factor);
        law.tension = self.tension.with_stiffness(factor);
        law.compression = self.compression.with_stiffness(factor);
        law.lambda *= factor;
        law.shear *= factor;
        law
    }
    #[inline(always)]
    fn inelastic_strain<L: Lane>(&self, history: &[L]) -> Option<[L; 6]> {
        Some(array(|i| history[i]))
    }
}

/// Share of tension in principal stresses, `r = sum <s_i> / sum |s_i|`; one without stress.
#[inline(always)]
pub(crate) fn share_of_tension<L: Lane>(stress: &[L; 3]) -> L {
    let zero = stress[0].constant(0.0);
    let one = stress[0].constant(1.0);
    let [a, b, c] = *stress;
    let all = a.abs() + b.abs() + c.abs();
    let pulled = a.max(zero) + b.max(zero) + c.max(zero);
    let some = zero.less(all);
    (pulled / all.select(some, one)).select(some, one)
}

/// Sum of the positive numbers.
#[inline(always)]
fn positive<L: Lane>(numbers: [L; 3]) -> L {
    let zero = numbers[0].constant(0.0);
    let [a, b, c] = numbers;
    a.max(zero) + b.max(zero) + c.max(zero)
}

impl<S: YieldSurface> ConstitutiveLaw for PlasticDamage<S> {
    fn name(&self) -> &str {
        "plastic-damage"
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
        let elastic = difference(&input.strain.0, old);
        let mut change = Stress::elastic(number(self.lambda), number(self.shear), &elastic);
        let trial = input.initial + change;
        let mut now = history::load::<L, { HISTORY.len() }>(old);
        now[YIELD_STATE] = zero;

        let mut axes = None;
        if let Some(flow) = FlowInAxes::of_trial(&self.parameters.surface, &trial) {
            let tension = share_of_tension(&flow.stress);
            for i in 0..6 {
                now[i] = now[i] + flow.flow.plastic[i];
            }
            let opened = old[TENSION] + positive(flow.plastic);
            let crushed = (one - tension) * positive(each(&flow.plastic, |e| -e));
            let crushed = old[COMPRESSION] + crushed;
            let widths = self.widths(input, &flow.directions);
            let [torn, broken] = self.damage([opened, crushed], widths);
            let width_after =
                |index: usize, width, damage| crack_band::updated(old[index], width, damage);
            for (variable, value) in [
                (CRACK_WIDTH, width_after(CRACK_WIDTH, widths[0], torn)),
                (
                    CRUSHING_WIDTH,
                    width_after(CRUSHING_WIDTH, widths[1], broken),
                ),
                (TENSION, opened),
                (COMPRESSION, crushed),
                (DAMAGE_TENSION, torn.max(old[DAMAGE_TENSION])),
                (DAMAGE_COMPRESSION, broken.max(old[DAMAGE_COMPRESSION])),
            ] {
                now[variable] = value.select(flow.yielded, old[variable]);
            }
            now[YIELD_STATE] = flow.flow.state;
            change = flow.flow.stress_change(&change, &input.initial);
            axes = Some(PrincipalAxes {
                values: flow.stress,
                directions: flow.directions,
            });
        }
        let closure = self.closure();
        let nominal = closure.nominal_change(&change, &input.initial, axes, &mut now);
        history::store(&now, new_history);
        nominal
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        self.parameters.surface.elastic_domain()
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        Some(self.closure().energy(&self.medium(), input, new_history))
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
        let p = &self.parameters;
        let old = input.history;
        let medium = self.medium();
        let elastic = difference(&input.strain.0, old);
        let fixed = |variable: usize| Dual::fixed(old[variable]);
        let trial = input.initial + Stress::elastic(self.lambda, self.shear, &elastic);
        let widths = self.widths(input, &PrincipalAxes::of(&trial).directions);
        let closure = self.closure();
        let respond = |trial: &[Dual; 3]| {
            let (mut torn, mut broken) = (fixed(DAMAGE_TENSION), fixed(DAMAGE_COMPRESSION));
            let mut stress = *trial;
            let yields = p.surface.excess(&trial.map(|s| s.value)) > 0.0;
            if yields {
                let returned = p.surface.return_principal(trial);
                stress = returned.stress;
                let plastic = strains_of_loss(&medium, &returned.loss);
                let crushed = Dual::fixed(1.0) - share_of_tension(&stress);
                let crushed = crushed * positive(each(&plastic, |e| -e));
                let strains = [
                    fixed(TENSION) + positive(plastic),
                    fixed(COMPRESSION) + crushed,
                ];
                let [grown, ground] = self.damage(strains, widths.map(Dual::fixed));
                (torn, broken) = (grown.max(torn), ground.max(broken));
            }
            closure.nominal([torn, broken], &stress)
        };
        Some(tangent::of_isotropic(&medium, input, &elastic, respond))
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        Ok(self.check_size(size)?)
    }
}
