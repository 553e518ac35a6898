//! Unilateral contact without friction.

use powerhouse_model::{ContactLaw, ContactState, JointInput, JointResponse, JointState, Vec3};

use super::opened;

/// Unilateral contact law without friction: `t = (min(n, 0), 0, 0)` for a trial of normal part `n`.
///
/// ```
/// use powerhouse_contact::Frictionless;
/// use powerhouse_model::{ContactLaw, JointInput, Vec3};
/// let input = JointInput::new(Vec3::new(-3.0, 1.0, 2.0), &Frictionless.initial());
/// assert_eq!(Frictionless.admissible(&input, &mut []).traction, Vec3::new(-3.0, 0.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frictionless;

impl ContactLaw for Frictionless {
    fn name(&self) -> &str {
        "frictionless"
    }
    fn initial(&self) -> JointState {
        JointState::default().with_contact(ContactState::Slide)
    }
    #[inline(always)]
    fn admissible(&self, input: &JointInput, _new_history: &mut [f64]) -> JointResponse {
        let (normal, state) = (input.trial.x, &input.state);
        if normal > 0.0 {
            return opened(state.bond, state);
        }
        let state = state.with_contact(ContactState::Slide);
        JointResponse::new(Vec3::new(normal, 0.0, 0.0), state)
    }
    fn sliding_strength(&self, _normal: f64, _input: &JointInput) -> f64 {
        0.0
    }
    fn is_smooth(&self) -> bool {
        true
    }
}
