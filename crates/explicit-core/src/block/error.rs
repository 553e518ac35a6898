//! Why a set cannot become blocks.

use thiserror::Error;

/// An element that does not suit the kernel of its set.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BlockError {
    /// The kernel computes another kind.
    #[error("element {element} is a {found}; the kernel '{kernel}' computes {expected}")]
    WrongKind {
        /// The element's number.
        element: u64,
        /// Its kind.
        found: &'static str,
        /// The kernel.
        kernel: &'static str,
        /// What the kernel computes.
        expected: &'static str,
    },
    /// A point of the element stands for no volume.
    #[error("element {element} has the volume {volume:.3e} m3 at an integration point")]
    NoVolume {
        /// The element's number.
        element: u64,
        /// The point's volume (m3).
        volume: f64,
    },
    /// A node of the element gets no mass.
    #[error("element {element} lumps the mass {mass:.3e} kg at its node {node}")]
    NoMass {
        /// The element's number.
        element: u64,
        /// The node's number.
        node: u64,
        /// The mass (kg).
        mass: f64,
    },
    /// The part does not list a node of its element.
    #[error("element {element} uses node {node}, which its part does not list")]
    MissingNode {
        /// The element's number.
        element: u64,
        /// The node's number.
        node: u64,
    },
}
