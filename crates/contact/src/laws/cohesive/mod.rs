//! Cohesive bond with fracture energies, and Coulomb friction.

mod envelope;

use std::sync::Arc;

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    Bond, BondEnergies, ContactLaw, ContactState, ElasticMedium, HistoryVariable, JointInput,
    JointResponse, JointState, ParameterError, Vec3,
};

use self::envelope::{BondChange, StillBond, bearing, envelope};
use super::{bisected, check_friction, opened, shear, with_shear};

/// Parameters of a bond that fails gradually, with fracture energies, and Coulomb friction ([`Cohesive`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(deny_unknown_fields))]
pub struct CohesiveParameters {
    /// Tensile strength of the bond `ft` (Pa), above 0.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub tensile_strength: f64,
    /// Cohesion of the bond `c` (Pa): its shear strength without pressure, above 0.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub cohesion: f64,
    /// Fracture energy in opening, `GI` (J/m2), above 0.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub opening_energy: f64,
    /// Fracture energy in shear, `GII` (J/m2), at least `GI`; as key ten times that by default.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    #[cfg_attr(feature = "keys", schemars(extend("x-like" = "opening_energy", "x-times" = 10)))]
    pub shear_energy: f64,
    /// Exponent of mixed modes after Benzeggagh and Kenane (1996), `eta` (1), above 0; as key 2 by default.
    #[cfg_attr(feature = "keys", serde(with = "Positive", default = "ratio::<2, 1>"))]
    pub mode_exponent: f64,
    /// Static friction coefficient `mu_s` (1), 0 or above: of an intact bond under pressure, and after its failure.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub static_friction: f64,
    /// Dynamic friction coefficient `mu_d` (1), 0 to `mu_s`: while the bond softens, and of slip after its failure; as key
    /// the static one by default.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    #[cfg_attr(feature = "keys", schemars(extend("x-like" = "static_friction")))]
    pub dynamic_friction: f64,
    /// Reduction of the strengths where the mesh does not resolve the failure, with the energies kept: as the key `reduce`
    /// by the media, which is the default, or none.
    #[cfg_attr(feature = "keys", serde(rename = "reduce"))]
    #[cfg_attr(feature = "keys", serde(default, deserialize_with = "reduction"))]
    #[cfg_attr(feature = "keys", schemars(with = "bool", extend("default" = true)))]
    pub reduction: StrengthReduction,
}

/// Reads whether strengths are reduced.
#[cfg(feature = "keys")]
fn reduction<'de, D: Deserializer<'de>>(deserializer: D) -> Result<StrengthReduction, D::Error> {
    let reduce: bool = Deserialize::deserialize(deserializer)?;
    Ok(if reduce {
        StrengthReduction::ByMedia
    } else {
        StrengthReduction::None
    })
}

/// Reduction of the strengths of a bond where the mesh does not resolve its failure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StrengthReduction {
    /// By the media of the two sides of the joint: none until the law is put [between](ContactLaw::between) them.
    #[default]
    ByMedia,
    /// By a plane-strain modulus `E'` (Pa), `2/E' = 1/E1' + 1/E2'` of the two sides.
    Modulus(f64),
    /// None, whatever the mesh.
    None,
}

/// Contact law with a bond that fails gradually, by traction-separation with fracture energies in opening and shear, and
/// Coulomb friction that grows as the bond fades.
///
/// - *Intact*: a traction with normal part `n` (positive in tension) and shear `s` is carried without opening or slip if
///   `(n/ft)^2 + (s/c)^2 <= 1` in tension, `s <= c - mu_s n` under pressure.
/// - *Softening*: with `b = c/ft` and the opening `g` and slip `d` since then, the bond bears
///   `T = F (g, b^2 d)`. The secant stiffness `F` (Pa/m) falls only: it ends where
///   `F lambda = ft (1 - lambda/lf)` with `lambda = sqrt(g^2 + b^2 d^2)` and `lf = 2 G/ft`, so that the whole separation
///   takes the energy `G`. It is `GI` in opening, `GII` in shear and
///   `GI + (GII - GI) B^eta` between, `B = b^2 d^2/lambda^2` (Benzeggagh & Kenane 1996). Under pressure the faces are in
///   contact, the bond bears shear alone, and friction `mu_d` acts beside it.
/// - *Failed*: friction as of [`BondedCoulomb`](crate::BondedCoulomb) without a bond.
///
/// There is no penalty stiffness and no loss of stable step: the traction of a step is found together with the opening at its
/// end, and on the softening branch with the mean opening of the step before and after it, so that the work of central
/// differences is the area under the curve. It is unique for `step * compliance * ft/lf < 4`, compliance as in
/// [`JointInput::compliance`].
///
/// # Coarse meshes
/// A mesh resolves the zone in which the bond softens if some five node pairs are in it. Where they are not, the strength
/// is reduced and the energy kept (Turon et al. 2007): `ft = min(ft, 0.42 sqrt(E' GI/h))`, cohesion likewise with `GII`,
/// with the [spacing](JointInput::spacing) `h` of the pairs. Cracks then begin early, and take the right energy.
///
/// ```
/// use powerhouse_contact::{Cohesive, CohesiveParameters, StrengthReduction};
/// use powerhouse_model::{ContactLaw, JointInput, Vec3};
/// let law = Cohesive::new(CohesiveParameters {
///     tensile_strength: 1.0e6,
///     cohesion: 2.0e6,
///     opening_energy: 100.0,
///     shear_energy: 1000.0,
///     mode_exponent: 2.0,
///     static_friction: 0.7,
///     dynamic_friction: 0.7,
///     reduction: StrengthReduction::ByMedia,
/// })?;
/// let intact = vec![0.0; law.history().len()];
/// let mut history = intact.clone();
/// let trial = Vec3::new(0.6e6, 1.6e6, 0.0);
/// let input = JointInput::new(trial, &law.initial()).with_history(&intact);
/// assert_eq!(law.admissible(&input, &mut history).traction, trial);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cohesive(CohesiveParameters);

/// History variables: secant compliance `1/F`, zero while intact; share of the separation at failure, 1 when failed;
/// energies per area; tangential displacement at which the bond was intact.
const HISTORY: [HistoryVariable; 7] = [
    HistoryVariable::amount("bond_compliance", "m/Pa"),
    HistoryVariable::amount("bond_damage", "1"),
    HistoryVariable::amount("bond_stored", "J/m2"),
    HistoryVariable::amount("bond_dissipated", "J/m2"),
    HistoryVariable::amount("bond_friction", "J/m2"),
    HistoryVariable::amount("bond_anchor_1", "m"),
    HistoryVariable::amount("bond_anchor_2", "m"),
];
const COMPLIANCE: usize = 0;
const DAMAGE: usize = 1;
const STORED: usize = 2;
const DISSIPATED: usize = 3;
const FRICTION: usize = 4;
const ANCHOR: usize = 5;

/// Greatest share of `sqrt(E' G/h)` that a strength has: five node pairs in a softening zone of `9 pi/32` times the
/// cohesive length `E' G/ft^2` (Turon et al. 2007).
const RESOLVED: f64 = 0.42;
/// Least separation of a bond that softens, as a share of that at failure: its secant stiffness is finite.
const ONSET: f64 = 1e-12;
/// Damage up to which a bond whose damage is taken back is where it was intact, but for rounding.
const CLOSED: f64 = 1e-9;

/// Strengths of a pair (Pa), and the separation at failure in opening (m) is from them.
#[derive(Clone, Copy, Debug)]
struct Strengths {
    tensile: f64,
    cohesion: f64,
}

/// Displacement of the second side relative to the first, or traction on the first: part along the normal, and two along
/// the tangents.
#[derive(Clone, Copy, Debug)]
struct Split {
    normal: f64,
    tangential: [f64; 2],
}

impl Split {
    /// Size of the tangential part.
    fn shear(&self) -> f64 {
        self.tangential[0].hypot(self.tangential[1])
    }
    /// Both parts by functions of the components.
    fn map(self, normal: impl Fn(f64) -> f64, tangential: impl Fn(usize, f64) -> f64) -> Self {
        Self {
            normal: normal(self.normal),
            tangential: [0, 1].map(|c| tangential(c, self.tangential[c])),
        }
    }
}

impl Cohesive {
    /// Law with given parameters.
    ///
    /// # Errors
    /// A strength, energy, exponent or modulus that is not finite and above 0, `GII` below `GI`, a negative friction
    /// coefficient, or `mu_d > mu_s`.
    pub fn new(parameters: CohesiveParameters) -> Result<Self, ParameterError> {
        const LEAST: f64 = f64::MIN_POSITIVE;
        let above_zero = |name, value| ParameterError::check(name, value, LEAST, f64::MAX);
        above_zero("tensile_strength", parameters.tensile_strength)?;
        above_zero("cohesion", parameters.cohesion)?;
        above_zero("opening_energy", parameters.opening_energy)?;
        let least = parameters.opening_energy;
        ParameterError::check("shear_energy", parameters.shear_energy, least, f64::MAX)?;
        above_zero("mode_exponent", parameters.mode_exponent)?;
        check_friction(parameters.static_friction, parameters.dynamic_friction)?;
        if let StrengthReduction::Modulus(modulus) = parameters.reduction {
            above_zero("modulus", modulus)?;
        }
        Ok(Self(parameters))
    }
    /// Parameters of the law.
    pub fn parameters(&self) -> &CohesiveParameters {
        &self.0
    }
    /// Factors (1) by which tensile strength and cohesion are reduced where pairs have a spacing (m); 1 where the mesh
    /// resolves the bond's failure.
    pub fn reduction(&self, spacing: f64) -> [f64; 2] {
        let law = &self.0;
        let strengths = self.strengths(spacing);
        [
            strengths.tensile / law.tensile_strength,
            strengths.cohesion / law.cohesion,
        ]
    }

    fn strengths(&self, spacing: f64) -> Strengths {
        let law = &self.0;
        let (mut tensile, mut cohesion) = (law.tensile_strength, law.cohesion);
        if let StrengthReduction::Modulus(modulus) = law.reduction
            && spacing > 0.0
        {
            let resolved = |energy: f64| RESOLVED * (modulus * energy / spacing).sqrt();
            tensile = tensile.min(resolved(law.opening_energy));
            cohesion = cohesion.min(resolved(law.shear_energy));
        }
        Strengths { tensile, cohesion }
    }

    /// Whether an intact bond carries a traction (Pa) with a friction coefficient (1).
    fn carries(&self, strengths: &Strengths, traction: &Vec3, friction: f64) -> bool {
        let shear = shear(traction);
        if traction.x > 0.0 {
            let (n, s) = (traction.x / strengths.tensile, shear / strengths.cohesion);
            n * n + s * s <= 1.0
        } else {
            shear <= strengths.cohesion - friction * traction.x
        }
    }

    /// Response of a pair without a bond: no tension, and friction.
    fn unbonded(&self, input: &JointInput) -> JointResponse {
        let (trial, state) = (input.trial, &input.state);
        if trial.x > 0.0 {
            return opened(state.bond, state);
        }
        let friction = match state.contact {
            ContactState::Stick => self.0.static_friction,
            ContactState::Slide | ContactState::Open => self.0.dynamic_friction,
        };
        let size = shear(&trial);
        if size <= -friction * trial.x {
            return JointResponse::new(trial, state.with_contact(ContactState::Stick));
        }
        let strength = -self.0.dynamic_friction * trial.x;
        let slid = state.with_contact(ContactState::Slide);
        JointResponse::new(with_shear(trial.x, &trial, size, strength), slid)
    }

    /// The bond of a closed pair that softens, if it does not slide in a step: with its secant stiffness up to the separation that
    /// it had, else on the envelope at the mean displacement, as if it slid by nothing.
    fn still(
        &self,
        strengths: &Strengths,
        stiffness: f64,
        now: &Split,
        before: &Split,
    ) -> StillBond {
        let Strengths { tensile, cohesion } = *strengths;
        let ratio = cohesion / tensile;
        let last = 2.0 * self.0.shear_energy / tensile;
        let reached = tensile / (stiffness + tensile / last);
        let mean = [0, 1].map(|c| 0.25 * (3.0 * now.tangential[c] + before.tangential[c]));
        let (end, along) = (ratio * now.shear(), ratio * mean[0].hypot(mean[1]));
        if end.max(along) <= reached {
            let own = ratio * ratio * stiffness;
            return StillBond {
                traction: now.tangential.map(|part| own * part),
                change: BondChange::elastic(0.5 * own * now.shear().powi(2)),
            };
        }
        let separation = along.max(reached);
        let share = if end > 0.0 {
            ratio * bearing(tensile, last, separation, end) / now.shear()
        } else {
            0.0
        };
        StillBond {
            traction: now.tangential.map(|part| share * part),
            change: BondChange::on_envelope(tensile, [reached, last], separation, end),
        }
    }

    /// Response of a pair whose bond begins to soften or softens.
    fn softening(
        &self,
        strengths: &Strengths,
        input: &JointInput,
        new: &mut [f64],
    ) -> JointResponse {
        let (law, trial, state) = (&self.0, input.trial, &input.state);
        let compliance = input.step * input.compliance;
        let Strengths { tensile, cohesion } = *strengths;
        let ratio = cohesion / tensile;
        let intact = input.history[COMPLIANCE] == 0.0;
        let stiffness = 1.0 / input.history[COMPLIANCE];
        let closed = trial.x <= 0.0;

        // Displacements at the start of the step, a step before, and at its end if the pair bore no traction.
        if intact {
            new[ANCHOR..ANCHOR + 2].copy_from_slice(&input.shear_displacement);
        }
        let now = Split {
            normal: input.opening - input.dilation,
            tangential: [0, 1].map(|c| input.shear_displacement[c] - new[ANCHOR + c]),
        };
        let before = now.map(
            |opening| opening - input.step * input.opening_rate,
            |c, sliding| sliding - input.step * input.slip_rate[c],
        );
        // The trial takes back the opening, and no displacement along the tangents but rounding.
        let mut free = Split {
            normal: compliance * trial.x,
            tangential: [0, 1].map(|c| compliance * trial[c + 1] + now.tangential[c]),
        };

        // Friction beside the bond.
        let mut friction = [0.0; 2];
        if closed {
            let stick = [0, 1].map(|c| (free.tangential[c] - now.tangential[c]) / compliance);
            let still = if intact {
                StillBond::default()
            } else {
                self.still(strengths, stiffness, &now, &before)
            };
            let beside = [0, 1].map(|c| stick[c] - still.traction[c]);
            let (size, most) = (beside[0].hypot(beside[1]), -law.dynamic_friction * trial.x);
            if !intact && size <= most {
                still.change.record(new);
                let traction = Vec3::new(trial.x, stick[0], stick[1]);
                let state = state
                    .with_contact(ContactState::Slide)
                    .with_bond(still.change.bond());
                return JointResponse::new(traction, state);
            }
            if size > 0.0 {
                friction = beside.map(|part| most * part / size);
            }
            free.tangential = [0, 1].map(|c| free.tangential[c] - compliance * friction[c]);
            free.normal = 0.0;
        }

        // Mean of the opening before and after the step at its start.
        let opened_by = |opening: f64| if closed { 0.0 } else { opening.max(0.0) };
        let mean = Split {
            normal: opened_by(0.25 * (free.normal + 2.0 * now.normal + before.normal)),
            tangential: [0, 1].map(|c| {
                0.25 * (free.tangential[c] + 2.0 * now.tangential[c] + before.tangential[c])
            }),
        };
        let slid = ratio * mean.shear();
        let size = mean.normal.hypot(slid);
        let mixed = if size > 0.0 {
            (slid / size).powi(2)
        } else {
            0.0
        };
        let (least, most) = (law.opening_energy, law.shear_energy);
        let energy = least + (most - least) * mixed.powf(law.mode_exponent);
        let last = 2.0 * energy / tensile;
        let reached = if intact {
            0.0
        } else {
            tensile / (stiffness + tensile / last)
        };

        let bond = |secant: f64, end: Split| {
            let shear = ratio * ratio * secant;
            Split {
                normal: secant * end.normal,
                tangential: end.tangential.map(|part| shear * part),
            }
        };
        // End of the step with a secant stiffness.
        let ended = |secant: f64| {
            free.map(
                |opening| opening / (1.0 + compliance * secant),
                |_, sliding| sliding / (1.0 + compliance * ratio * ratio * secant),
            )
        };
        let size_of = |end: &Split| end.normal.hypot(ratio * end.shear());
        let secant_end = ended(stiffness);
        let end_size = size_of(&secant_end);
        // In scaled space, where the bond is the same in all directions: tractions along the end of the step if the bond did not
        // soften, as where it unloads, so that small changes of the trial cause small changes of the traction.
        let along = if intact {
            free.map(|opening| opening, |_, sliding| sliding / ratio)
        } else {
            secant_end.map(|opening| opening, |_, sliding| ratio * sliding)
        };
        let length = along.normal.hypot(along.shear()).max(f64::MIN_POSITIVE);
        let along = along.map(|part| part / length, |_, part| part / length);
        // A pair that turns back ends within the separation that its mean has.
        let end_after = |separation: f64| {
            if intact {
                separation
            } else {
                size_of(&ended(envelope(tensile, last, separation) / separation))
            }
        };
        let bears = |separation: f64| bearing(tensile, last, separation, end_after(separation));
        let mean_after = |separation: f64| {
            let taken = 0.25 * compliance * bears(separation);
            let slid =
                [0, 1].map(|c| ratio * (mean.tangential[c] - ratio * taken * along.tangential[c]));
            (mean.normal - taken * along.normal).hypot(slid[0].hypot(slid[1]))
        };
        let is_within = || end_size <= reached && mean_after(reached) <= reached;
        let (traction, change) = if !intact && is_within() {
            let stored = 0.5 * stiffness * end_size * end_size;
            (bond(stiffness, secant_end), BondChange::elastic(stored))
        } else if size >= last {
            let none = Split {
                normal: 0.0,
                tangential: [0.0; 2],
            };
            let change = BondChange::on_envelope(tensile, [reached, last], last, last);
            (none, change)
        } else {
            let root = bisected(|separation| mean_after(separation) - separation, last);
            let separation = root.max(reached).max(ONSET * last);
            let bears = bears(separation);
            let traction = Split {
                normal: bears * along.normal,
                tangential: along.tangential.map(|part| ratio * bears * part),
            };
            let end = end_after(separation);
            let change = BondChange::on_envelope(tensile, [reached, last], separation, end);
            (traction, change)
        };
        change.record(new);

        let end = [0, 1].map(|c| free.tangential[c] - compliance * traction.tangential[c]);
        let rubbed = [0, 1].map(|c| 0.5 * friction[c] * (end[c] - before.tangential[c]));
        new[FRICTION] += (rubbed[0] + rubbed[1]).max(0.0);
        let total = Vec3::new(
            // No more than closes the pair.
            if closed {
                trial.x
            } else {
                traction.normal.min(trial.x)
            },
            traction.tangential[0] + friction[0],
            traction.tangential[1] + friction[1],
        );
        let contact = if closed {
            ContactState::Slide
        } else {
            ContactState::Open
        };
        JointResponse::new(total, state.with_contact(contact).with_bond(change.bond()))
    }
}

impl ContactLaw for Cohesive {
    fn name(&self) -> &str {
        "cohesive"
    }
    fn initial(&self) -> JointState {
        JointState::default().with_bond(Bond::Intact)
    }
    fn history(&self) -> &[HistoryVariable] {
        &HISTORY
    }
    fn admissible(&self, input: &JointInput, new_history: &mut [f64]) -> JointResponse {
        let failed =
            input.history[DAMAGE] >= 1.0 || matches!(input.state.bond, Bond::Never | Bond::Broken);
        if failed {
            return self.unbonded(input);
        }
        let strengths = self.strengths(input.spacing);
        let intact = input.history[COMPLIANCE] == 0.0;
        // A bond that was let go in this step has slid: with static friction again it would hold and slide in turn.
        let friction = match input.state.bond {
            Bond::Softening => self.0.dynamic_friction,
            _ => self.0.static_friction,
        };
        if intact && self.carries(&strengths, &input.trial, friction) {
            let state = input.state.with_contact(ContactState::Stick);
            return JointResponse::new(input.trial, state.with_bond(Bond::Intact));
        }
        if input.step * input.compliance <= 0.0 {
            // A static check: nothing is known of the motion.
            return opened(Bond::Softening, &input.state);
        }
        self.softening(&strengths, input, new_history)
    }
    fn sliding_strength(&self, normal: f64, _input: &JointInput) -> f64 {
        (-self.0.dynamic_friction * normal).max(0.0)
    }
    fn between(&self, media: [&ElasticMedium; 2]) -> Option<Arc<dyn ContactLaw>> {
        if self.0.reduction != StrengthReduction::ByMedia {
            return None;
        }
        let compliance = |medium: &ElasticMedium| (1.0 - medium.poisson.powi(2)) / medium.young;
        let modulus = 2.0 / (compliance(media[0]) + compliance(media[1]));
        let reduction = StrengthReduction::Modulus(modulus);
        Some(Arc::new(Self(CohesiveParameters {
            reduction,
            ..self.0
        })))
    }
    fn strength_factor(&self, spacing: f64) -> f64 {
        let [tensile, cohesion] = self.reduction(spacing);
        tensile.min(cohesion)
    }
    fn softening_ratio(&self, compliance: f64, spacing: f64) -> f64 {
        let Strengths { tensile, cohesion } = self.strengths(spacing);
        let ratio = |strength: f64, energy: f64| 0.5 * compliance * strength * strength / energy;
        let opening = ratio(tensile, self.0.opening_energy);
        opening.max(ratio(cohesion, self.0.shear_energy))
    }
    fn bond_energies(&self, history: &[f64]) -> Option<BondEnergies> {
        Some(BondEnergies::new(
            history[STORED],
            history[DISSIPATED],
            history[FRICTION],
        ))
    }
    fn undo_damage(
        &self,
        (former, old): (&JointState, &[f64]),
        share: f64,
        state: &mut JointState,
        history: &mut [f64],
    ) {
        let law = &self.0;
        let was_failed = old[DAMAGE] >= 1.0 || matches!(former.bond, Bond::Never | Bond::Broken);
        if was_failed || state.bond == Bond::Intact || share <= 0.0 {
            return;
        }
        if former.bond == Bond::Intact && history[DAMAGE] <= CLOSED {
            history.copy_from_slice(old);
            *state = state
                .with_contact(ContactState::Stick)
                .with_bond(Bond::Intact);
            return;
        }
        let now = history[DAMAGE];
        for kept in [DAMAGE, DISSIPATED] {
            history[kept] = old[kept] + (1.0 - share) * (history[kept] - old[kept]);
        }
        // The secant compliance is in proportion to d / (1 - d) for a damage d, and not known at d = 1.
        let kept = history[DAMAGE];
        let onset = ONSET * 2.0 * law.opening_energy / law.tensile_strength.powi(2);
        if now < 1.0 {
            history[COMPLIANCE] *= kept / (1.0 - kept) * (1.0 - now) / now;
        } else if share >= 1.0 {
            history[COMPLIANCE] = 0.0;
        }
        history[COMPLIANCE] = history[COMPLIANCE].max(old[COMPLIANCE]).max(onset);
        *state = state.with_bond(Bond::Softening);
    }
    fn follows_displacement(&self, state: &JointState) -> bool {
        matches!(state.bond, Bond::Intact | Bond::Softening)
    }
}
