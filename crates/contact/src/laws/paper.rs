//! Contact law of Wang, Chen & Xiao (2019).

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    Bond, ContactLaw, ContactState, JointInput, JointResponse, JointState, ParameterError, Vec3,
};

use super::{check_friction, check_strength, failed, initial_state, opened, shear, with_shear};

/// Parameters of a bond and friction after Wang, Chen & Xiao (2019), Eqs. 22 to 24 ([`Paper`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(deny_unknown_fields))]
pub struct PaperParameters {
    /// Initial cohesion `c` (Pa), 0 by default, possibly infinite.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative", default))]
    pub cohesion: f64,
    /// Tensile strength `sigma` (Pa), 0 by default, possibly infinite.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative", default))]
    pub tensile_strength: f64,
    /// Static friction coefficient `mu_s` (1), 0 or above; Wang, Chen & Xiao (2019) give no value.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub static_friction: f64,
    /// Dynamic friction coefficient `mu_d` (1), at most `mu_s`; as key the static one by default. Wang, Chen & Xiao (2019)
    /// give no value.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    #[cfg_attr(feature = "keys", schemars(extend("x-like" = "static_friction")))]
    pub dynamic_friction: f64,
}

/// Contact law of Wang, Chen & Xiao (2019), Eqs. (22) to (24), as printed.
///
/// For a trial traction with normal part `n` (positive in tension) and shear `s`:
///
/// | if | then | equation |
/// |---|---|---|
/// | `n > sigma` | `t = 0`: a crack | (22) |
/// | `0 < n <= sigma` | the shear is dropped, `t = (n, 0)` | (23) |
/// | `n <= 0`, `norm(s) > mu_s norm(n) + c` | `t = (n, mu_d norm(n) s / norm(s))`: slip | (24) |
/// | `n <= 0`, otherwise | `t` is the trial: the pair sticks | |
///
/// A crack or slip sets `c = 0`. Nothing else is lost, as in the paper: whether a pair slid before
/// makes no difference to the threshold `mu_s`, and a crack that has closed again carries tension
/// up to `sigma` once more. Only while the pair is open is there none: the trial would close the gap
/// in tension. [`BondedCoulomb`](crate::BondedCoulomb) corrects these points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper(PaperParameters);

impl Paper {
    /// Law with given parameters.
    ///
    /// # Errors
    /// A negative parameter, or `mu_d > mu_s`.
    pub fn new(parameters: PaperParameters) -> Result<Self, ParameterError> {
        check_strength("cohesion", parameters.cohesion)?;
        check_strength("tensile_strength", parameters.tensile_strength)?;
        check_friction(parameters.static_friction, parameters.dynamic_friction)?;
        Ok(Self(parameters))
    }
    /// Parameters of the law.
    pub fn parameters(&self) -> &PaperParameters {
        &self.0
    }
}

impl ContactLaw for Paper {
    fn name(&self) -> &str {
        "paper"
    }
    fn initial(&self) -> JointState {
        initial_state(self.0.cohesion, self.0.tensile_strength)
    }
    #[inline(always)]
    fn admissible(&self, input: &JointInput, _new_history: &mut [f64]) -> JointResponse {
        let (law, trial, state) = (&self.0, input.trial, &input.state);
        let normal = trial.x;
        let after_failure = failed(state.bond);
        if normal > 0.0 {
            let carries = state.contact != ContactState::Open && normal <= law.tensile_strength;
            if !carries {
                return opened(after_failure, state);
            }
            let state = state.with_contact(ContactState::Slide);
            return JointResponse::new(Vec3::new(normal, 0.0, 0.0), state);
        }
        let shear = shear(&trial);
        let cohesion = match state.bond {
            Bond::Intact => law.cohesion,
            Bond::Never | Bond::Softening | Bond::Broken => 0.0,
        };
        if shear <= law.static_friction * -normal + cohesion {
            return JointResponse::new(trial, state.with_contact(ContactState::Stick));
        }
        let slid = state.with_contact(ContactState::Slide);
        let slid = slid.with_bond(after_failure);
        let strength = law.dynamic_friction * -normal;
        JointResponse::new(with_shear(normal, &trial, shear, strength), slid)
    }
    fn sliding_strength(&self, normal: f64, _input: &JointInput) -> f64 {
        self.0.dynamic_friction * (-normal).max(0.0)
    }
    fn unbonded_tension(&self, input: &JointInput) -> f64 {
        match input.state.contact {
            ContactState::Open => 0.0,
            ContactState::Stick | ContactState::Slide => self.0.tensile_strength,
        }
    }
}
