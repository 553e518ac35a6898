//! Errors of this crate.

use powerhouse_model::ModelError;
use thiserror::Error;

/// A joint that cannot be made. Numbers of nodes are the user's, except where an index is said.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ContactError {
    /// A tolerance that is not a positive length.
    #[error("the pairing tolerance {tolerance} m is not a positive length")]
    Tolerance {
        /// What was given (m).
        tolerance: f64,
    },
    /// A node without a counterpart on the other side.
    #[error(
        "node {node} has no partner within {tolerance:.3e} m on the other side of the joint; \
         the nearest node, {nearest}, is {distance:.3e} m away"
    )]
    NoPartner {
        /// The node's number.
        node: u64,
        /// The number of the nearest node of the other side.
        nearest: u64,
        /// Its distance (m).
        distance: f64,
        /// The permitted distance (m).
        tolerance: f64,
    },
    /// A node with more than one counterpart.
    #[error(
        "node {node} has two partners within {tolerance:.3e} m on the other side of the joint: \
         {first} and {second}"
    )]
    Ambiguous {
        /// The node's number.
        node: u64,
        /// The number of one candidate.
        first: u64,
        /// The number of the other.
        second: u64,
        /// The permitted distance (m).
        tolerance: f64,
    },
    /// A facet without a counterpart on the other side; of several the one that is farthest off.
    #[error(
        "a facet of element {element} has no partner within {tolerance:.3e} m on the other side of \
         the joint; the nearest, of element {nearest}, has its centre {distance:.3e} m away"
    )]
    Unmatched {
        /// The element's number.
        element: u64,
        /// The number of the element with the nearest facet.
        nearest: u64,
        /// Distance of the centres (m).
        distance: f64,
        /// The permitted distance of corners (m).
        tolerance: f64,
    },
    /// A side, or a list of pairs, without nodes.
    #[error("the joint has no pairs")]
    Empty,
    /// A pair whose directions are no unit vectors at right angles, or whose area is not positive.
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
    /// A static traction that the law does not admit.
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
    /// An initial distance that cannot be.
    #[error(
        "the pair of the nodes with indices {first} and {second} cannot have an initial gap of {gap} \
         m: it must not be negative, nor bonded or preloaded across"
    )]
    Gap {
        /// Mesh index of one node.
        first: u32,
        /// Mesh index of the other.
        second: u32,
        /// The distance (m).
        gap: f64,
    },
    /// A pair whose bond cannot be taken.
    #[error(
        "the pair of the nodes with indices {first} and {second} has no bond that could be taken from it"
    )]
    NoBond {
        /// Mesh index of one node.
        first: u32,
        /// Mesh index of the other.
        second: u32,
    },
    /// Two joints of one name.
    #[error("two joints are named '{name}'")]
    SameName {
        /// The name.
        name: String,
    },
    /// A pair of a node with itself.
    #[error("the node with index {node} is paired with itself")]
    SelfPair {
        /// Mesh index of the node.
        node: u32,
    },
}

impl ContactError {
    /// The mesh indices of the pair that it concerns, if it concerns one.
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
