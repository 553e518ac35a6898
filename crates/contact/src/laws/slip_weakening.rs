//! Friction that falls with slip.

use powerhouse_model::{ContactLaw, ContactState, JointState, ParameterError, Vec3};

use super::{check_friction, opened, shear, with_shear};

/// Parameters of [`SlipWeakening`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipWeakeningParameters {
    /// Friction coefficient before any slip, `mu_s`.
    pub static_friction: f64,
    /// Friction coefficient after the slip `D_c`, at most `mu_s`.
    pub dynamic_friction: f64,
    /// Slip over which friction falls, `D_c` (m).
    pub slip_distance: f64,
}

/// Friction that falls linearly with the accumulated slip `D`, as in dynamic rupture:
///
/// `mu = mu_s - (mu_s - mu_d) min(D / D_c, 1)`
///
/// (Ida 1972; Andrews 1976, Eq. 4). A trial of normal part `n > 0` opens the pair; under pressure
/// it sticks if its shear is at most `-mu n`, else it slides with that shear. The work on slip is
/// booked as friction; the part above the dynamic level, `-(mu_s - mu_d) n D_c / 2` per area, is the
/// fracture energy.
///
/// ```
/// use powerhouse_contact::{SlipWeakening, SlipWeakeningParameters};
/// use powerhouse_model::{ContactLaw, JointState, Vec3};
/// let law = SlipWeakening::new(SlipWeakeningParameters {
///     static_friction: 0.7,
///     dynamic_friction: 0.5,
///     slip_distance: 0.4,
/// })?;
/// let halfway = JointState { slip: 0.2, ..law.initial() };
/// let (traction, _) = law.admissible(Vec3::new(-10.0, 8.0, 0.0), &halfway);
/// assert!((traction.y - 6.0).abs() < 1e-14);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipWeakening(SlipWeakeningParameters);

impl SlipWeakening {
    /// The law with these parameters.
    ///
    /// # Errors
    /// A negative coefficient, `mu_d > mu_s`, or a distance that is not positive.
    pub fn new(parameters: SlipWeakeningParameters) -> Result<Self, ParameterError> {
        check_friction(parameters.static_friction, parameters.dynamic_friction)?;
        let (least, most) = (f64::MIN_POSITIVE, f64::MAX);
        ParameterError::check("slip_distance", parameters.slip_distance, least, most)?;
        Ok(Self(parameters))
    }
    /// Its parameters.
    pub fn parameters(&self) -> &SlipWeakeningParameters {
        &self.0
    }
    /// The friction coefficient after an accumulated slip (m).
    #[inline(always)]
    pub fn friction(&self, slip: f64) -> f64 {
        let law = &self.0;
        let weakened = (slip / law.slip_distance).min(1.0);
        law.static_friction - (law.static_friction - law.dynamic_friction) * weakened
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
    fn admissible(&self, trial: Vec3, state: &JointState) -> (Vec3, JointState) {
        if trial.x > 0.0 {
            return opened(state.bond, state);
        }
        let (shear, strength) = (shear(&trial), self.sliding_strength(trial.x, state));
        let contact = if shear <= strength {
            ContactState::Stick
        } else {
            ContactState::Slide
        };
        let state = JointState { contact, ..*state };
        (with_shear(trial.x, &trial, shear, strength), state)
    }
    #[inline(always)]
    fn sliding_strength(&self, normal: f64, state: &JointState) -> f64 {
        self.friction(state.slip) * (-normal).max(0.0)
    }
}
