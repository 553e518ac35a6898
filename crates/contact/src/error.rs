//! Errors of this crate.

use powerhouse_model::ModelError;
use thiserror::Error;

/// Error in the definition of a joint. Node and element numbers are those of the mesh file, except where
/// an index is stated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ContactError {
    /// Tolerance of [`pair_nodes`](crate::pair_nodes) that is not a positive length.
    #[error("the pairing tolerance {tolerance} m is not a positive length")]
    Tolerance {
        /// The tolerance (m).
        tolerance: f64,
    },
    /// Node without a partner on the other side, in [`pair_nodes`](crate::pair_nodes).
    #[error(
        "node {node} has no partner within {tolerance:.3e} m on the other side of the joint; \
         the nearest node, {nearest}, is {distance:.3e} m away"
    )]
    NoPartner {
        /// Number of the node.
        node: u64,
        /// Number of the nearest node of the other side.
        nearest: u64,
        /// Distance of that node (m).
        distance: f64,
        /// The permitted distance (m).
        tolerance: f64,
    },
    /// Node with more than one partner within the tolerance, in [`pair_nodes`](crate::pair_nodes).
    #[error(
        "node {node} has two partners within {tolerance:.3e} m on the other side of the joint: \
         {first} and {second}"
    )]
    Ambiguous {
        /// Number of the node.
        node: u64,
        /// Number of one candidate.
        first: u64,
        /// Number of the other candidate.
        second: u64,
        /// The permitted distance (m).
        tolerance: f64,
    },
    /// Facet without a partner on the other side, in [`JointSurface::between`](crate::JointSurface::between); of several
    /// that with the farthest nearest facet.
    #[error(
        "a facet of element {element} has no partner within {tolerance:.3e} m on the other side of \
         the joint; the nearest, of element {nearest}, has its centre {distance:.3e} m away"
    )]
    Unmatched {
        /// Number of the element.
        element: u64,
        /// Number of the element with the nearest facet.
        nearest: u64,
        /// Distance of the centres (m).
        distance: f64,
        /// The permitted distance of corners (m).
        tolerance: f64,
    },
    /// Side without nodes or facets, or joint without pairs, as where both sides have all nodes in common.
    #[error("the joint has no pairs")]
    Empty,
    /// Pair of a new joint whose directions are no unit vectors at right angles, or whose area is not positive.
    #[error(
        "the pair of the nodes with indices {first} and {second} (area {area} m2) needs a positive \
         area and unit vectors at right angles"
    )]
    Pair {
        /// Mesh index of one node.
        first: u32,
        /// Mesh index of the other.
        second: u32,
        /// The area (m2).
        area: f64,
    },
    /// Preload that the law does not admit, or across a gap, in [`Joint::with_preload`](crate::Joint::with_preload).
    #[error(
        "the law does not admit the initial traction of the pair of the nodes with indices {first} \
         and {second}: {normal:.4e} Pa across the joint (positive in tension), {shear:.4e} Pa along \
         it; a pair with a gap has none"
    )]
    Preload {
        /// Mesh index of one node.
        first: u32,
        /// Mesh index of the other.
        second: u32,
        /// Normal traction (Pa), positive in tension.
        normal: f64,
        /// Shear traction (Pa).
        shear: f64,
    },
    /// Initial gap that is negative or not finite, or at a pair with a preload or a law that bears tension, in
    /// [`Joint::with_gaps`](crate::Joint::with_gaps).
    #[error(
        "the pair of the nodes with indices {first} and {second} cannot have an initial gap of {gap} \
         m: it must not be negative, nor bonded or preloaded across"
    )]
    Gap {
        /// Mesh index of one node.
        first: u32,
        /// Mesh index of the other.
        second: u32,
        /// The gap (m).
        gap: f64,
    },
    /// Pair without a bond that could be removed, in [`Joint::without_bond`](crate::Joint::without_bond): it has none, or
    /// its law bears tension without one.
    #[error(
        "the pair of the nodes with indices {first} and {second} has no bond that could be removed"
    )]
    NoBond {
        /// Mesh index of one node.
        first: u32,
        /// Mesh index of the other.
        second: u32,
    },
    /// Two joints with one name, in [`Joint::join`](crate::Joint::join).
    #[error("two joints are named '{name}'")]
    SameName {
        /// The name.
        name: String,
    },
    /// Pair of a node with itself, in a new joint or new ties.
    #[error("the node with index {node} is paired with itself")]
    SelfPair {
        /// Mesh index of the node.
        node: u32,
    },
}

impl ContactError {
    /// Mesh indices of the nodes of the pair that the error concerns, if any.
    pub fn pair(&self) -> Option<[u32; 2]> {
        match *self {
            Self::Pair { first, second, .. }
            | Self::Preload { first, second, .. }
            | Self::Gap { first, second, .. }
            | Self::NoBond { first, second } => Some([first, second]),
            _ => None,
        }
    }
}

impl From<ContactError> for ModelError {
    fn from(error: ContactError) -> Self {
        Self::refused("contact", error)
    }
}
