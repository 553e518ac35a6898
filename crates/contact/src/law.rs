//! Laws of joints.

use powerhouse_model::{ContactLaw, JointState, Vec3};

/// A perfect bond: every traction is admissible.
///
/// ```
/// use powerhouse_contact::Tied;
/// use powerhouse_model::{ContactLaw, JointState, Vec3};
/// let pull = Vec3::new(1.0e6, 2.0e5, 0.0);
/// assert_eq!(Tied.admissible(pull, &JointState::default()).0, pull);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tied;

impl ContactLaw for Tied {
    fn name(&self) -> &str {
        "tied"
    }
    fn admissible(&self, trial: Vec3, state: &JointState) -> (Vec3, JointState) {
        (trial, *state)
    }
}
