//! Slip-weakening friction.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    ContactLaw, ContactState, JointInput, JointResponse, JointState, ParameterError,
};

use super::{check_friction, opened, shear, with_shear};

/// Parameters of friction that falls with slip ([`SlipWeakening`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(deny_unknown_fields))]
pub struct SlipWeakeningParameters {
    /// Static friction coefficient `mu_s` (1), before any slip, 0 or above.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub static_friction: f64,
    /// Dynamic friction coefficient `mu_d` (1), after the slip `D_c`, 0 to `mu_s`.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub dynamic_friction: f64,
    /// Slip over which friction falls from one to the other, `D_c` (m), above 0.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub slip_distance: f64,
}

/// Contact law of slip-weakening friction, which falls linearly with the accumulated slip `D`, as in
/// dynamic rupture:
///
/// `mu = mu_s - (mu_s - mu_d) min(D / D_c, 1)`
///
/// (Ida 1972; Andrews 1976, Eq. 4). A trial of normal part `n > 0` opens the pair; under pressure
/// it sticks if its shear is at most `-mu n`, else it slides with that shear. The work on slip
/// counts as friction; the part above the dynamic level, `-(mu_s - mu_d) n D_c / 2` per area, is the
/// fracture energy.
///
/// ```
/// use powerhouse_contact::{SlipWeakening, SlipWeakeningParameters};
/// use powerhouse_model::{ContactLaw, JointInput, Vec3};
/// let law = SlipWeakening::new(SlipWeakeningParameters {
///     static_friction: 0.7,
///     dynamic_friction: 0.5,
///     slip_distance: 0.4,
/// })?;
/// let halfway = law.initial().with_slip(0.2);
/// let input = JointInput::new(Vec3::new(-10.0, 8.0, 0.0), &halfway);
/// assert!((law.admissible(&input, &mut []).traction.y - 6.0).abs() < 1e-14);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipWeakening(SlipWeakeningParameters);

impl SlipWeakening {
    /// Law with given parameters.
    ///
    /// # Errors
    /// A negative coefficient, `mu_d > mu_s`, or a distance that is not positive.
    pub fn new(parameters: SlipWeakeningParameters) -> Result<Self, ParameterError> {
        check_friction(parameters.static_friction, parameters.dynamic_friction)?;
        let (least, most) = (f64::MIN_POSITIVE, f64::MAX);
        ParameterError::check("slip_distance", parameters.slip_distance, least, most)?;
        Ok(Self(parameters))
    }
    /// Parameters of the law.
    pub fn parameters(&self) -> &SlipWeakeningParameters {
        &self.0
    }
    /// Friction coefficient (1) after an accumulated slip (m).
    #[inline(always)]
    pub fn friction(&self, slip: f64) -> f64 {
        let law = &self.0;
        let weakened = (slip / law.slip_distance).min(1.0);
        law.static_friction - (law.static_friction - law.dynamic_friction) * weakened
    }
    /// Shear strength (Pa) under a normal traction (Pa) after an accumulated slip (m).
    #[inline(always)]
    fn strength(&self, normal: f64, slip: f64) -> f64 {
        self.friction(slip) * (-normal).max(0.0)
    }
}

impl ContactLaw for SlipWeakening {
    fn name(&self) -> &str {
        "slip-weakening"
    }
    fn initial(&self) -> JointState {
        JointState::default()
    }
    #[inline(always)]
    fn admissible(&self, input: &JointInput, _new_history: &mut [f64]) -> JointResponse {
        let (trial, state) = (input.trial, &input.state);
        if trial.x > 0.0 {
            return opened(state.bond, state);
        }
        let (shear, strength) = (shear(&trial), self.strength(trial.x, state.slip));
        let contact = if shear <= strength {
            ContactState::Stick
        } else {
            ContactState::Slide
        };
        let traction = with_shear(trial.x, &trial, shear, strength);
        JointResponse::new(traction, state.with_contact(contact))
    }
    #[inline(always)]
    fn sliding_strength(&self, normal: f64, input: &JointInput) -> f64 {
        self.strength(normal, input.state.slip)
    }
}
