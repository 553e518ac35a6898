//! Errors of static solutions.

use crate::{ParameterError, StateError};
use thiserror::Error;

/// Failure of a static solution. Nodes and elements are named by the user's numbers.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StaticError {
    /// A solution option outside its permitted range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A solution method that the engine does not have.
    #[error("the engine '{engine}' has no static solution by {method}")]
    NoMethod {
        /// Name of the engine.
        engine: String,
        /// Name of the method.
        method: &'static str,
    },
    /// An unsupported part of the model, which can move as a rigid body; found before the solution.
    #[error(
        "the connected part with element {element} of set '{set}' ({elements} elements) can {motion} freely: no support holds it (absorbing faces, and periodic or delayed sides, hold nothing in statics: give the stage a support, such as rollers on one face normal to the motion), and it shares no node or closed joint with what is held (elements that are cast later are absent)"
    )]
    Floating {
        /// Number of an element of the part.
        element: u64,
        /// Set of that element.
        set: String,
        /// Number of elements of the part.
        elements: usize,
        /// The unrestrained rigid motion: a translation along, or a rotation about, an axis.
        motion: String,
    },
    /// A node without stiffness, or with one lost to rounding beside the stiffest of the model.
    #[error("set '{set}' gives node {node} no stiffness")]
    NoStiffness {
        /// Number of the node.
        node: u64,
        /// Set of an element at the node.
        set: String,
    },
    /// A stiffness matrix that is not positive definite and has no Cholesky factor, in an increment that may not be halved
    /// again.
    #[error(
        "the stiffness is not positive definite at node {node} (element {element} of set '{set}'): \
    the material softens there, or the node is not supported"
    )]
    NotDefinite {
        /// Number of the node whose elimination failed.
        node: u64,
        /// Number of an element at the node.
        element: u64,
        /// Set of that element.
        set: String,
    },
    /// Too little memory for the Cholesky factor.
    #[error(
        "the direct solution of {unknowns} unknowns failed to allocate {bytes} bytes of memory"
    )]
    NoMemory {
        /// Number of unknown displacements.
        unknowns: usize,
        /// Size of the allocation that failed (bytes).
        bytes: usize,
    },
    /// A constraint that has neither ties nor joints and therefore no static form.
    #[error(
        "constraint '{name}' cannot be used in a static solution: it has neither ties nor joints"
    )]
    Constraint {
        /// Name of the constraint.
        name: String,
    },
    /// A joint that slides, opens or closes in a method that treats closed pairs as tied.
    #[error(
        "joint '{joint}' slides, opens or closes at {pairs} of {of} pairs: this method treats closed pairs as \
        tied, and open ones as free; dynamic relaxation lets them slide, open and close"
    )]
    JointMoves {
        /// Name of the joint.
        joint: String,
        /// Number of its pairs that slide, open or close.
        pairs: usize,
        /// Number of its pairs.
        of: usize,
    },
    /// A failure of a constraint or joint that corrects a motion: in a step of a dynamic relaxation, or when its tractions
    /// in equilibrium are computed.
    #[error("'{name}': {reason}")]
    Joint {
        /// Name of the constraint.
        name: String,
        /// Cause of the failure.
        reason: String,
    },
    /// Different prescribed motions of nodes that a static solution connects: by a tie, or as a pair of a closed joint.
    #[error("node {node} is tied to a node with another prescribed motion")]
    TiedMotions {
        /// Number of the node.
        node: u64,
    },
    /// An element whose displacement, stress or force is not finite.
    #[error("element {element} of set '{set}': {reason}")]
    Element {
        /// Number of the element.
        element: u64,
        /// Set of the element.
        set: String,
        /// Cause of the failure.
        reason: String,
    },
    /// Carried forces that differ from those of the stage before by more than the tolerance, in
    /// [`StaticModel::hand_over`](crate::StaticModel::hand_over).
    #[error(
        "the forces carried over to the dynamic stage differ from those of the stage before by \
        {difference:.3e} of the internal forces (permitted: {tolerance:.1e}), most at node {node}: a load, an \
        element or a bolt is missing or new, or the body was not in static equilibrium"
    )]
    CarriedForcesChanged {
        /// Norm of the difference over the norm of the internal forces (1).
        difference: f64,
        /// Largest permitted difference over the norm of the internal forces (1).
        tolerance: f64,
        /// Number of the node with the largest difference.
        node: u64,
    },
    /// A set whose internal forces at rest are others in motion, in
    /// [`StaticModel::hand_over`](crate::StaticModel::hand_over): its static stress would not stay.
    #[error(
        "the static stress of set '{set}' would not stay: its internal forces in motion differ from those at rest by \
        {difference:.1e} of them. A viscoelastic law relaxes it, unless it is given as initial stress of this set; other laws \
        keep it in static equilibrium, which a smaller `tolerance` of the stages brings nearer"
    )]
    StressChanges {
        /// Name of the element set.
        set: String,
        /// Norm of the difference over that of the forces at rest (1).
        difference: f64,
    },
    /// Unbalanced forces above the tolerance after all corrections or steps of an increment that may not be halved again.
    #[error(
        "the unbalanced forces remain at {residual:.3e} of the load at load factor {share}, largest \
        at node {node} (element {element} of set '{set}'): {advice}"
    )]
    NotConverged {
        /// Norm of the unbalanced forces over that of the load (1).
        residual: f64,
        /// Load factor that was not reached: share of the load, 0 to 1.
        share: f64,
        /// Number of the node with the largest unbalanced force.
        node: u64,
        /// Number of an element at the node.
        element: u64,
        /// Set of that element.
        set: String,
        /// Change of the solution options that may help.
        advice: &'static str,
    },
    /// State of a static solution that cannot be saved, or from which this one cannot go on.
    #[error("{part}: {source}")]
    State {
        /// Part of the solution, such as a block of elements.
        part: String,
        /// Cause.
        source: StateError,
    },
    /// Failure of the receiver of states of a static solution.
    #[error("checkpoint: {reason}")]
    Checkpoint {
        /// Cause.
        reason: String,
    },
    /// Cancellation by the flag of [`ModelSpec::stop_on`](crate::ModelSpec::stop_on).
    #[error("interrupted")]
    Interrupted,
    /// A failure of the communication between ranks.
    #[error(transparent)]
    Ranks(#[from] crate::RankError),
    /// An option that one rank alone supports, before the solution.
    #[error("{what} cannot be used on {ranks} ranks, only on one")]
    OneRankOnly {
        /// The option.
        what: &'static str,
        /// Number of ranks.
        ranks: usize,
    },
    /// An error on another rank, which ends the solution on all of them.
    #[error("rank {rank}: {message}")]
    OnRank {
        /// Number of the rank.
        rank: usize,
        /// Message of its error.
        message: String,
    },
    /// Conjugate gradients that no longer approach the solution.
    #[error(
        "conjugate gradients leave a relative residual of {residual:.3e} after {products} products and come no nearer: a \
        part of the body is hardly held, or stiffnesses, angles of elements or Poisson's ratios near 0.5 make the system \
        too ill-conditioned; the method `cholesky` (in builds with a direct solver) has no such limit"
    )]
    LinearSolver {
        /// Norm of the residual over that of the right-hand side (1).
        residual: f64,
        /// Number of products of the operator.
        products: u64,
    },
}
