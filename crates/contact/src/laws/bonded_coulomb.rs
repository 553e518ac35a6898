//! Brittle bond and Coulomb friction.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    Bond, ContactLaw, ContactState, JointInput, JointResponse, JointState, ParameterError,
};

use super::{check_friction, check_strength, failed, initial_state, opened, shear, with_shear};

/// Parameters of a brittle bond, then Coulomb friction ([`BondedCoulomb`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(deny_unknown_fields))]
pub struct BondedCoulombParameters {
    /// Cohesion of the bond `c` (Pa), 0 by default, possibly infinite.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative", default))]
    pub cohesion: f64,
    /// Tensile strength of the bond `ft` (Pa), 0 by default, possibly infinite. More than the envelope's apex
    /// `c / mu_s` is never reached.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative", default))]
    pub tensile_strength: f64,
    /// Static friction coefficient `mu_s` (1), 0 or above.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub static_friction: f64,
    /// Dynamic friction coefficient `mu_d` (1), 0 to `mu_s`; as key the static one by default.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    #[cfg_attr(feature = "keys", schemars(extend("x-like" = "static_friction")))]
    pub dynamic_friction: f64,
    /// Whether slip breaks the bond; it does by default. If not, cohesion acts along with friction while the
    /// pair slides, and only a tensile crack breaks it.
    #[cfg_attr(feature = "keys", serde(default = "yes"))]
    pub cohesion_loss: bool,
}

/// Contact law with a bond that breaks for good and Coulomb friction with a static and a dynamic
/// coefficient.
///
/// For a trial traction with normal part `n` (positive in tension) and shear `s`:
///
/// - *Bonded*: the trial is carried if `n <= ft` and `norm(s) <= c - mu n`, the envelope of Mohr
///   and Coulomb with a tension cut-off. Beyond it the bond breaks, `c = ft = 0` from then on.
/// - *Not bonded*: no tension, `n > 0` opens the pair. Under pressure it sticks if
///   `norm(s) <= -mu n`, else it slides with `norm(t) = -mu_d n` along `s`.
///
/// `mu` is `mu_s` if the pair stuck in the step before and `mu_d` if it slid or was open: it re-sticks
/// when the stick trial is within `mu_d N` and slips again past `mu_s N`.
///
/// Wang, Chen & Xiao (2019) have the same parameters (Table 1) but drop the shear of a bond in
/// tension, Eq. (23), and keep no history of slip; see [`Paper`](crate::Paper).
///
/// ```
/// use powerhouse_contact::{BondedCoulomb, BondedCoulombParameters};
/// use powerhouse_model::{Bond, ContactLaw, JointInput, Vec3};
/// let law = BondedCoulomb::new(BondedCoulombParameters {
///     cohesion: 1.0e6,
///     tensile_strength: 0.5e6,
///     static_friction: 0.8,
///     dynamic_friction: 0.6,
///     cohesion_loss: true,
/// })?;
/// let input = JointInput::new(Vec3::new(-1.0e6, 2.0e6, 0.0), &law.initial());
/// let response = law.admissible(&input, &mut []);
/// assert_eq!(response.traction, Vec3::new(-1.0e6, 0.6e6, 0.0));
/// assert_eq!(response.state.bond, Bond::Broken);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BondedCoulomb(BondedCoulombParameters);

impl BondedCoulomb {
    /// Law with given parameters.
    ///
    /// # Errors
    /// A negative parameter, or `mu_d > mu_s`.
    pub fn new(parameters: BondedCoulombParameters) -> Result<Self, ParameterError> {
        check_strength("cohesion", parameters.cohesion)?;
        check_strength("tensile_strength", parameters.tensile_strength)?;
        check_friction(parameters.static_friction, parameters.dynamic_friction)?;
        Ok(Self(parameters))
    }
    /// Law of Coulomb friction without a bond, of a static and a dynamic coefficient (1).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn unbonded(static_friction: f64, dynamic_friction: f64) -> Result<Self, ParameterError> {
        Self::new(BondedCoulombParameters {
            cohesion: 0.0,
            tensile_strength: 0.0,
            static_friction,
            dynamic_friction,
            cohesion_loss: true,
        })
    }
    /// Parameters of the law.
    pub fn parameters(&self) -> &BondedCoulombParameters {
        &self.0
    }

    /// Cohesion and tensile strength with a bond in this state (Pa).
    #[inline(always)]
    fn strengths(&self, bond: Bond) -> (f64, f64) {
        match bond {
            Bond::Intact => (self.0.cohesion, self.0.tensile_strength),
            Bond::Never | Bond::Softening | Bond::Broken => (0.0, 0.0),
        }
    }
    /// Shear strength (Pa) of a pair that slides under a normal traction (Pa), with a bond in this state.
    #[inline(always)]
    fn strength(&self, normal: f64, bond: Bond) -> f64 {
        let (cohesion, _) = self.strengths(bond);
        (cohesion - self.0.dynamic_friction * normal).max(0.0)
    }
}

impl ContactLaw for BondedCoulomb {
    fn name(&self) -> &str {
        "bonded-coulomb"
    }
    fn initial(&self) -> JointState {
        initial_state(self.0.cohesion, self.0.tensile_strength)
    }
    #[inline(always)]
    fn admissible(&self, input: &JointInput, _new_history: &mut [f64]) -> JointResponse {
        let (law, trial, state) = (&self.0, input.trial, &input.state);
        let normal = trial.x;
        let (cohesion, tensile_strength) = self.strengths(state.bond);
        let broken = failed(state.bond);
        if normal > tensile_strength {
            return opened(broken, state);
        }
        let friction = match state.contact {
            ContactState::Stick => law.static_friction,
            ContactState::Slide | ContactState::Open => law.dynamic_friction,
        };
        let shear = shear(&trial);
        if shear <= cohesion - friction * normal {
            return JointResponse::new(trial, state.with_contact(ContactState::Stick));
        }
        let bond = if law.cohesion_loss {
            broken
        } else {
            state.bond
        };
        if normal > 0.0 && bond != Bond::Intact {
            return opened(bond, state);
        }
        let slid = state.with_contact(ContactState::Slide).with_bond(bond);
        let strength = self.strength(normal, bond);
        JointResponse::new(with_shear(normal, &trial, shear, strength), slid)
    }
    #[inline(always)]
    fn sliding_strength(&self, normal: f64, input: &JointInput) -> f64 {
        self.strength(normal, input.state.bond)
    }
}
