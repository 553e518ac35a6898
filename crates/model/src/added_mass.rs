//! Added mass of nodes.

use crate::Mat3;

/// Added mass of one node, of what moves with the body beside it, such as water: a symmetric positive semi-definite matrix,
/// as the mass may differ by direction.
///
/// It acts on inertia alone: it has no weight and no mass damping, and static solutions do not feel it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AddedMass {
    /// Mesh index of the node.
    pub node: u32,
    /// Mass matrix (kg): force per acceleration.
    pub mass: Mat3,
}

impl AddedMass {
    /// The added mass (kg) of a node (mesh index).
    pub fn new(node: u32, mass: Mat3) -> Self {
        Self { node, mass }
    }
}
