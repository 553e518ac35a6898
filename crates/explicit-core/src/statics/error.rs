//! Why a static solution cannot be had.

use powerhouse_model::ParameterError;
use thiserror::Error;

/// A model that does not come to rest. Nodes and elements are named by the user's numbers.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StaticError {
    /// An option outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A part of the model that can move as a rigid body.
    #[error(
        "the part with element {element} of set '{set}' ({elements} elements) can {motion} freely"
    )]
    Floating {
        /// An element of the part.
        element: u64,
        /// Its set.
        set: String,
        /// How many elements the part has.
        elements: usize,
        /// The motion that nothing resists.
        motion: String,
    },
    /// A node that nothing resists, or a set next to whose stiffness that of others is all there is.
    #[error("set '{set}' gives node {node} no stiffness")]
    NoStiffness {
        /// The node's number.
        node: u64,
        /// The set of an element at it.
        set: String,
    },
    /// A stiffness that has no Cholesky factor.
    #[error(
        "the stiffness is not positive definite at node {node} (element {element} of set '{set}'): \
         something there softens, or is free to move"
    )]
    NotDefinite {
        /// The node whose elimination failed.
        node: u64,
        /// An element at it.
        element: u64,
        /// That element's set.
        set: String,
    },
    /// A factor for which there is no memory.
    #[error("a direct solution of {unknowns} unknowns needs {bytes} bytes that are not there")]
    NoMemory {
        /// Unknown displacements.
        unknowns: usize,
        /// Bytes of the piece of memory that was refused.
        bytes: usize,
    },
    /// A constraint that knows no static form.
    #[error("'{name}' has no static form")]
    Constraint {
        /// Its name.
        name: String,
    },
    /// A joint whose law does not admit the tractions that hold it together.
    #[error(
        "joint '{joint}' slides or opens at {pairs} of {of} pairs: this method takes what sticks for \
         one body; dynamic relaxation lets it move"
    )]
    JointMoves {
        /// The joint.
        joint: String,
        /// How many of its pairs move.
        pairs: usize,
        /// How many it has.
        of: usize,
    },
    /// A joint that could not be solved.
    #[error("'{name}': {reason}")]
    Joint {
        /// The constraint.
        name: String,
        /// Why.
        reason: String,
    },
    /// Nodes that are held together but driven apart.
    #[error("node {node} is tied to one with another prescribed motion")]
    TiedMotions {
        /// The node's number.
        node: u64,
    },
    /// An element that cannot be computed.
    #[error("element {element} of set '{set}': {reason}")]
    Element {
        /// The element's number.
        element: u64,
        /// Its set.
        set: String,
        /// Why.
        reason: String,
    },
    /// A body that other forces hold than those of the stage before.
    #[error(
        "what holds the body changed by {difference:.3e} of its internal forces (permitted: \
         {tolerance:.1e}) from one stage to the next, most of all at node {node}: a load, an \
         element or a bolt is missing or new, or the body was not at rest"
    )]
    NotHeld {
        /// The change, relative to the internal forces.
        difference: f64,
        /// The permitted change.
        tolerance: f64,
        /// The node where most changed.
        node: u64,
    },
    /// A law that would forget the static stress.
    #[error(
        "set '{set}' relaxes: its damping would act on the static stress, which must be an \
         initial stress for it"
    )]
    Relaxes {
        /// The set.
        set: String,
    },
    /// Forces that do not balance.
    #[error(
        "the forces out of balance stay at {residual:.3e} of the load at {share} of it, most of \
         all at node {node} (element {element} of set '{set}'): {way_out}"
    )]
    NotConverged {
        /// Forces out of balance over the load.
        residual: f64,
        /// The share of the load.
        share: f64,
        /// The node where most is out of balance.
        node: u64,
        /// An element at it.
        element: u64,
        /// That element's set.
        set: String,
        /// What may find the rest that there is.
        way_out: &'static str,
    },
    /// The flag was raised that the model [stops on](crate::ModelBuilder::stop_on).
    #[error("interrupted")]
    Interrupted,
    /// The conjugate gradients do not come to an end.
    #[error("the linear solver leaves {residual:.3e} after {products} products")]
    LinearSolver {
        /// What is left, relative.
        residual: f64,
        /// Products of the operator.
        products: u64,
    },
}
