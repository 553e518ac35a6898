//! Pressure alone.

use powerhouse_model::{ContactLaw, ContactState, JointState, Vec3};

use super::opened;

/// Presses, never pulls, never rubs: `t = (min(n, 0), 0, 0)` for a trial of normal part `n`.
///
/// ```
/// use powerhouse_contact::Frictionless;
/// use powerhouse_model::{ContactLaw, Vec3};
/// let (traction, _) = Frictionless.admissible(Vec3::new(-3.0, 1.0, 2.0), &Frictionless.initial());
/// assert_eq!(traction, Vec3::new(-3.0, 0.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frictionless;

impl ContactLaw for Frictionless {
    fn name(&self) -> &str {
        "frictionless"
    }
    fn initial(&self) -> JointState {
        JointState {
            contact: ContactState::Slide,
            ..JointState::default()
        }
    }
    #[inline(always)]
    fn admissible(&self, trial: Vec3, state: &JointState) -> (Vec3, JointState) {
        if trial.x > 0.0 {
            return opened(state.bond, state);
        }
        let contact = ContactState::Slide;
        let state = JointState { contact, ..*state };
        (Vec3::new(trial.x, 0.0, 0.0), state)
    }
    fn sliding_strength(&self, _normal: f64, _state: &JointState) -> f64 {
        0.0
    }
}
