//! Errors of observers.

use powerhouse_model::{MeshError, ModelError, ParameterError};
use thiserror::Error;

/// Failure of an observer, at construction or during a run. Nodes and elements are named by the user's
/// numbers.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ObserveError {
    /// A parameter outside its permitted range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A set that does not exist, or a point outside the mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Two results with the same name.
    #[error("two results are called '{name}'")]
    NameTwice {
        /// The name of both.
        name: String,
    },
    /// An output request for a node that does not exist.
    #[error("'{name}' refers to node {node}, which does not exist")]
    NoSuchNode {
        /// Name of the output request.
        name: String,
        /// Number of the node.
        node: u64,
    },
    /// An engine that knows stresses as means over elements alone.
    #[error(
        "'{name}' is the stress at a point, of which the engine knows the mean over its element alone"
    )]
    NoStressAtPoint {
        /// Name of the output request.
        name: String,
    },
    /// An output request for an element that does not exist.
    #[error("'{name}' refers to element {element}, which does not exist")]
    NoSuchElement {
        /// Name of the output request.
        name: String,
        /// Number of the element.
        element: u64,
    },
    /// An output request for pairs of a joint that do not exist.
    #[error("'{name}' refers to pair {pair} of joint '{joint}', which does not exist")]
    NoSuchPairs {
        /// Name of the output request.
        name: String,
        /// Name of the joint.
        joint: String,
        /// Index of the last of the pairs.
        pair: usize,
    },
    /// An output request for bolts that the model lacks, or has with another number of segments.
    #[error("the model has no bolts '{name}' with the requested number of segments")]
    NoSuchBolts {
        /// Name of the set of bolts.
        name: String,
    },
    /// An output request for the mean over a set without nodes.
    #[error("'{name}' refers to the mean of node set '{set}', which is empty")]
    EmptySet {
        /// Name of the output request.
        name: String,
        /// Name of the node set.
        set: String,
    },
    /// An output request for a location without active elements, excavated or never cast in the stages.
    #[error(
        "'{name}' refers to {place}, which has no active element in the run: it was excavated, or is never cast; use a location on a wall of the opening, or in elements that are cast into it"
    )]
    InactiveLocation {
        /// Name of the output request.
        name: String,
        /// Description of the location.
        place: String,
    },
    /// A section plane whose normal, or whose direction `along` in the plane, has no length.
    #[error("the {what} ({x}, {y}, {z}) of section '{section}' gives no direction in space")]
    NoDirection {
        /// Name of the section.
        section: String,
        /// `normal` or `along`.
        what: &'static str,
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
        /// Third component.
        z: f64,
    },
    /// A section plane that intersects none of its elements, or none with its centroid in the box of the section.
    #[error(
    "the plane of section '{section}' intersects none of its elements{}",
        if *.outside { " with centroids in its box, but some outside: enlarge the box (`half_extent` in a scene)" } else { "" }
    )]
    EmptySection {
        /// Name of the section.
        section: String,
        /// Whether the plane intersects elements outside the box.
        outside: bool,
    },
    /// A reinforcement that does not fit its section.
    #[error("the reinforcement of section '{section}': {reason}")]
    Reinforcement {
        /// Name of the section.
        section: String,
        /// What does not fit.
        reason: String,
    },
    /// Sections around a lining that is not there, or about an axis without direction.
    #[error("the sections of ring '{ring}': {reason}")]
    Ring {
        /// Name of the ring.
        ring: String,
        /// What is not there, or out of range.
        reason: String,
    },
    /// Section forces in a run of an engine without element forces, at the first observed step.
    #[error("section '{section}': the engine does not provide the forces of its elements")]
    NoForces {
        /// Name of the section.
        section: String,
    },
    /// A sampler of a program whose row has not a value for each of its columns.
    #[error("'{name}' has {found} values for {expected} columns")]
    SampledColumns {
        /// Name of the request.
        name: String,
        /// Number of values.
        found: usize,
        /// Number of columns.
        expected: usize,
    },
    /// An energy history in a run without an energy ledger, at the first observed step.
    #[error("the run has no energy ledger")]
    NoLedger,
    /// An energy ledger whose columns have changed during the run.
    #[error(
        "the energy ledger has the columns {found:?}, but had {expected:?} at the first observed step"
    )]
    LedgerChanged {
        /// Present columns.
        found: Vec<String>,
        /// Columns at the first observed step.
        expected: Vec<String>,
    },
    /// A motion, stress or history variable that is not finite at an observed step; the run fails.
    #[error("{what} of {place} {number} is not finite at t = {time:.6e} s")]
    NotFinite {
        /// `displacement`, `velocity`, `acceleration`, `stress` or the name of a history variable.
        what: &'static str,
        /// `node` or `element`.
        place: &'static str,
        /// Number of the node or element.
        number: u64,
        /// Time (s).
        time: f64,
    },
}

impl From<ObserveError> for ModelError {
    fn from(error: ObserveError) -> Self {
        match error {
            ObserveError::Parameter(source) => Self::Parameter(source),
            ObserveError::Mesh(source) => Self::Mesh(source),
            other => Self::refused("observer", other),
        }
    }
}
