//! A perfect bond.

use powerhouse_model::{Bond, ContactLaw, ContactState, JointState, Vec3};

/// A perfect bond: every traction is admissible.
///
/// ```
/// use powerhouse_contact::Tied;
/// use powerhouse_model::{ContactLaw, Vec3};
/// let pull = Vec3::new(1.0e6, 2.0e5, 0.0);
/// assert_eq!(Tied.admissible(pull, &Tied.initial()).0, pull);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tied;

impl ContactLaw for Tied {
    fn name(&self) -> &str {
        "tied"
    }
    fn initial(&self) -> JointState {
        JointState {
            bond: Bond::Intact,
            ..JointState::default()
        }
    }
    #[inline(always)]
    fn admissible(&self, trial: Vec3, state: &JointState) -> (Vec3, JointState) {
        let contact = ContactState::Stick;
        (trial, JointState { contact, ..*state })
    }
    fn sliding_strength(&self, _normal: f64, _state: &JointState) -> f64 {
        f64::INFINITY
    }
}
