//! What makes a model impossible to compute with.

use powerhouse_model::{ModelError, ParameterError};
use thiserror::Error;

/// A model that the engine refuses before the run. Nodes and elements are named by the user's
/// numbers.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EngineError {
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A set that does not exist, or a mesh fault.
    #[error(transparent)]
    Mesh(#[from] powerhouse_model::MeshError),
    /// No element set was given.
    #[error("the model has no elements")]
    NoElements,
    /// An element that two sets claim.
    #[error("element {element} is computed by both '{first}' and '{second}'")]
    ElementTwice {
        /// The element's number.
        element: u64,
        /// One set.
        first: String,
        /// The other.
        second: String,
    },
    /// Elements that nothing computes.
    #[error("element {element} is computed by no set ({count} such elements)")]
    ElementUnassigned {
        /// The first such element's number.
        element: u64,
        /// How many there are.
        count: usize,
    },
    /// An element of a kind that the set's kernel does not take.
    #[error("element {element} of set '{set}' is a {found}; its kernel takes {expected}")]
    ElementKind {
        /// The element's number.
        element: u64,
        /// The set.
        set: String,
        /// What it is.
        found: &'static str,
        /// What the kernel takes.
        expected: &'static str,
    },
    /// A point of an element that stands for no volume.
    #[error(
        "element {element} of set '{set}' has the volume {volume:.3e} m3 at an integration point"
    )]
    NoVolume {
        /// The element's number.
        element: u64,
        /// The set.
        set: String,
        /// The point's volume (m3).
        volume: f64,
    },
    /// An element of a width that its law refuses.
    #[error(
        "element {element} of set '{set}', {size:.4} m wide along its {extent} extent: {reason}"
    )]
    ElementSize {
        /// The element's number.
        element: u64,
        /// The set.
        set: String,
        /// Along which of its extents.
        extent: ElementExtent,
        /// The element's width along it (m).
        size: f64,
        /// What the law says, with the widths that it permits.
        reason: String,
    },
    /// An element that leaves a node without mass.
    #[error("element {element} of set '{set}' lumps the mass {mass:.3e} kg at its node {node}")]
    NoLumpedMass {
        /// The element's number.
        element: u64,
        /// The set.
        set: String,
        /// The node's number.
        node: u64,
        /// The mass (kg).
        mass: f64,
    },
    /// A part of a set that does not list a node of its element.
    #[error("element {element} of set '{set}' uses node {node}, which its part does not list")]
    UnlistedNode {
        /// The element's number.
        element: u64,
        /// The set.
        set: String,
        /// The node's number.
        node: u64,
    },
    /// Sets that store their nodes differently.
    #[error("set '{first}' keeps its nodes in double precision, '{second}' in single")]
    MixedNodes {
        /// A set in double precision.
        first: String,
        /// A set in single precision.
        second: String,
    },
    /// A block that names a node which does not exist.
    #[error("a block of set '{set}' names engine node {node}, which does not exist")]
    BlockNode {
        /// The set.
        set: String,
        /// The engine number.
        node: u32,
    },
    /// A node that no element gives mass to.
    #[error("node {node} has mass {mass} kg; every node needs a positive, finite mass")]
    NodeWithoutMass {
        /// The node's number.
        node: u64,
        /// Its mass (kg).
        mass: f64,
    },
    /// Something that acts on a node which does not exist.
    #[error("{part} acts on node index {node}; the mesh has {count} nodes")]
    UnknownNode {
        /// What acts.
        part: String,
        /// The index.
        node: u32,
        /// How many nodes the mesh has.
        count: usize,
    },
    /// A node that something names twice.
    #[error("{part} names node {node} twice")]
    NodeTwice {
        /// What names it.
        part: String,
        /// The node's number.
        node: u64,
    },
    /// A direction without length.
    #[error("{part} has the direction ({x}, {y}, {z}), which is none")]
    NoDirection {
        /// What has it.
        part: String,
        /// Its components.
        x: f64,
        /// Its components.
        y: f64,
        /// Its components.
        z: f64,
    },
    /// Two conditions that contradict each other.
    #[error(
        "node {node} has a prescribed motion in a direction that is already held or prescribed"
    )]
    SupportConflict {
        /// The node's number.
        node: u64,
    },
    /// A load on both sides of a facet: a pressure cancels, a traction counts twice.
    #[error("the loaded facets hold both sides of the face between elements {element} and {other}")]
    BothSides {
        /// The number of the element on one side.
        element: u64,
        /// The number of the element on the other.
        other: u64,
    },
    /// Spring or dashpot that is not symmetric and positive semi-definite.
    #[error("the boundary {what} at node {node} is not symmetric and positive semi-definite")]
    Impedance {
        /// `spring` or `dashpot`.
        what: &'static str,
        /// The node's number.
        node: u64,
    },
    /// A node that two constraints correct.
    #[error("node {node} is corrected by both '{first}' and '{second}'")]
    ConstrainedTwice {
        /// The node's number.
        node: u64,
        /// One constraint.
        first: String,
        /// The other.
        second: String,
    },
    /// Faces that cannot be tied as a periodic pair.
    #[error(
        "periodic faces of {from} and {to} nodes do not match: node {node} lies {distance:.3e} m from its partner (tolerance {tolerance:.1e} m)"
    )]
    PeriodicMismatch {
        /// Nodes of one face.
        from: usize,
        /// Nodes of the other.
        to: usize,
        /// The number of the node that matches worst.
        node: u64,
        /// How far it is from its partner (m).
        distance: f64,
        /// The permitted distance (m).
        tolerance: f64,
    },
    /// Tied nodes that start with different velocities.
    #[error("node {node} is tied to node {partner} but starts with another velocity")]
    TiedVelocity {
        /// The node's number.
        node: u64,
        /// Its partner's number.
        partner: u64,
    },
    /// A state or an initial motion of the wrong length or with numbers that are not finite.
    #[error(
        "the {what} has {found} entries instead of {expected}, or holds a number that is not finite"
    )]
    State {
        /// `displacement`, `velocity` or `initial stress`.
        what: &'static str,
        /// Entries given.
        found: usize,
        /// Entries wanted.
        expected: usize,
    },
    /// A motion that leaves the range of numbers in single precision, in which elements are computed:
    /// it would be lost, or become infinite.
    #[error(
        "the {what} of {largest:.3e} at most is outside [{least:e}, {most:e}], which is left in single precision once it is multiplied by moduli and areas"
    )]
    SinglePrecision {
        /// `displacement` or `velocity`.
        what: &'static str,
        /// The largest component (m or m/s).
        largest: f64,
        /// The least permitted largest component other than zero of a body that nothing drives.
        least: f64,
        /// The greatest permitted component.
        most: f64,
    },
    /// A state of a joint that the model does not have, or has with other pairs.
    #[error("the model has no joint '{name}' of {pairs} pairs, of which the state tells")]
    UnknownJoint {
        /// The joint's name.
        name: String,
        /// How many pairs the state tells of.
        pairs: usize,
    },
    /// A state of a body with other elements than the model's.
    #[error("the state lacks other elements than the model, or had others cast later")]
    OtherElements,
    /// A number of threads that the system refuses.
    #[error("{threads} threads could not be started")]
    Threads {
        /// How many were wanted.
        threads: usize,
    },
}

impl From<EngineError> for ModelError {
    fn from(error: EngineError) -> Self {
        match error {
            EngineError::Parameter(source) => Self::Parameter(source),
            EngineError::Mesh(source) => Self::Mesh(source),
            other => Self::refused("model", other),
        }
    }
}

/// The direction in which an element is widest or narrowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementExtent {
    /// The widest one.
    Greatest,
    /// The narrowest one.
    Least,
}

impl core::fmt::Display for ElementExtent {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Greatest => "greatest",
            Self::Least => "least",
        })
    }
}
