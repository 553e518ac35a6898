//! Perfect bond.

use powerhouse_model::{Bond, ContactLaw, ContactState, JointInput, JointResponse, JointState};

/// Contact law of a perfect bond: every traction is admissible.
///
/// ```
/// use powerhouse_contact::Tied;
/// use powerhouse_model::{ContactLaw, JointInput, Vec3};
/// let pull = Vec3::new(1.0e6, 2.0e5, 0.0);
/// let input = JointInput::new(pull, &Tied.initial());
/// assert_eq!(Tied.admissible(&input, &mut []).traction, pull);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tied;

impl ContactLaw for Tied {
    fn name(&self) -> &str {
        "tied"
    }
    fn initial(&self) -> JointState {
        JointState::default().with_bond(Bond::Intact)
    }
    #[inline(always)]
    fn admissible(&self, input: &JointInput, _new_history: &mut [f64]) -> JointResponse {
        JointResponse::new(input.trial, input.state.with_contact(ContactState::Stick))
    }
    fn sliding_strength(&self, _normal: f64, _input: &JointInput) -> f64 {
        f64::INFINITY
    }
    fn bears_tension(&self) -> bool {
        true
    }
}
