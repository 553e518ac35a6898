//! What observers refuse.

use powerhouse_model::{MeshError, ModelError, ParameterError};
use thiserror::Error;

/// An observer that cannot be made, or cannot go on. Nodes and elements are named by the user's
/// numbers.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ObserveError {
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A set that does not exist, or a point outside the mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Two results of the same name.
    #[error("two results are called '{name}'")]
    NameTwice {
        /// The name.
        name: String,
    },
    /// A node that does not exist.
    #[error("'{name}' asks for node {node}, which does not exist")]
    NoSuchNode {
        /// Who asks.
        name: String,
        /// The node's number.
        node: u64,
    },
    /// An element that does not exist.
    #[error("'{name}' asks for element {element}, which does not exist")]
    NoSuchElement {
        /// Who asks.
        name: String,
        /// The element's number.
        element: u64,
    },
    /// Pairs of a joint that the body does not have.
    #[error("'{name}' asks for pair {pair} of joint '{joint}', which does not exist")]
    NoSuchPairs {
        /// Who asks.
        name: String,
        /// The joint's name.
        joint: String,
        /// The last of the pairs.
        pair: usize,
    },
    /// Bolts that the body does not have.
    #[error("the body has no bolts '{name}' of the segments that are asked for")]
    NoSuchBolts {
        /// Their name.
        name: String,
    },
    /// A node set without nodes has no mean.
    #[error("'{name}' asks for the mean of node set '{set}', which is empty")]
    EmptySet {
        /// Who asks.
        name: String,
        /// The set.
        set: String,
    },
    /// A place where nothing is, since stages have excavated it or never cast it.
    #[error(
        "'{name}' asks for {place}, where nothing is when the body moves: it was excavated, or is never cast; on a wall of the opening, or in what is cast into it, there is something to record"
    )]
    NothingThere {
        /// Who asks.
        name: String,
        /// The place, in words.
        place: String,
    },
    /// A cut whose normal, or whose direction along in the plane, has no length.
    #[error("the {what} ({x}, {y}, {z}) of cut '{cut}' gives no direction in space")]
    NoDirection {
        /// The cut.
        cut: String,
        /// `normal` or `along`.
        what: &'static str,
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
        /// Third component.
        z: f64,
    },
    /// A cut that meets none of its elements.
    #[error(
        "the plane of cut '{cut}' meets none of its elements{}",
        match .outside {
            true => " within its box, but some outside: those count whose centroids are in the box, a larger `reach` in a scene",
            false => "",
        }
    )]
    EmptyCut {
        /// The cut.
        cut: String,
        /// Whether it would meet some without its box.
        outside: bool,
    },
    /// A cut in an engine that does not tell the forces of elements.
    #[error("cut '{cut}': the engine does not tell the forces of its elements")]
    NoForces {
        /// The cut.
        cut: String,
    },
    /// An energy history without an energy ledger.
    #[error("the run keeps no energy ledger")]
    NoLedger,
    /// A ledger with other columns than before.
    #[error("the energy ledger has the columns {found:?}, before it had {expected:?}")]
    LedgerChanged {
        /// Now.
        found: Vec<String>,
        /// At the first step seen.
        expected: Vec<String>,
    },
    /// A motion or a stress that is not finite.
    #[error("{what} of {place} {number} is not finite at t = {time:.6e} s")]
    NotFinite {
        /// `displacement`, `velocity`, `acceleration` or `stress`.
        what: &'static str,
        /// `node` or `element`.
        place: &'static str,
        /// Its number.
        number: u64,
        /// The time (s).
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
