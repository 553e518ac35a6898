//! The stable time step, and the element that limits it.

use crate::LimitingTerm;

/// The stable time step of a model under an integration scheme, and the element that limits it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StableStep {
    /// Stable step (s): 0.98 of the stability limit of the assembled model with damping.
    pub step: f64,
    /// Stability limit of central differences for the undamped assembled elastic model (s), `2 / w` with the highest
    /// angular frequency `w` (rad/s): joints open, boundary impedances left out. If the Lanczos method did not converge,
    /// `w` is at least the highest frequency of a single element.
    pub assembled_limit: f64,
    /// Least stability bound of a single element, damping included (s); infinite if the blocks
    /// report no element bounds.
    pub element_bound: f64,
    /// The user's number of the limiting element, which has the least bound.
    pub element: u64,
    /// Name of the limiting element's set.
    pub set: String,
    /// Cause of the limit: stiffness damping if its coefficient exceeds half the bound,
    /// mass damping if it alone permits no longer step, else the stiffness.
    pub term: LimitingTerm,
    /// Number of elements whose bound is within 5 % of the least one.
    pub similar_elements: usize,
    /// Least bound (s) of all other sets, the upper limit of the gain from coarsening this set;
    /// none if there is no other set.
    pub next_set_bound: Option<f64>,
    /// Number of operator products of the Lanczos method.
    pub iterations: usize,
    /// Whether the Lanczos method converged; if not, the element bound is used.
    pub converged: bool,
}

impl StableStep {
    /// A stable step (s) of a scheme with the stability limit of central differences of the undamped model (s),
    /// without bounds of elements.
    pub fn new(step: f64, assembled_limit: f64) -> Self {
        Self {
            step,
            assembled_limit,
            element_bound: f64::INFINITY,
            element: 0,
            set: String::new(),
            term: LimitingTerm::Stiffness,
            similar_elements: 0,
            next_set_bound: None,
            iterations: 0,
            converged: true,
        }
    }
}
