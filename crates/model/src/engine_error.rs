//! Errors of model assembly.

use crate::{ModelError, ParameterError, Vec3};
use thiserror::Error;

/// An invalid model, refused before the run. Nodes and elements are named by the user's numbers.
///
/// Where no other operation is named, [`Engine::build`](crate::Engine::build) returns it, as the source of a
/// [`ModelError::Refused`].
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EngineError {
    /// A parameter outside its permitted range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A set that does not exist, or a fault of the mesh.
    #[error(transparent)]
    Mesh(#[from] crate::MeshError),
    /// A model without elements.
    #[error("the model has no elements")]
    NoElements,
    /// An element that belongs to two element sets of the model.
    #[error("element {element} belongs to both sets '{first}' and '{second}' of the model")]
    ElementTwice {
        /// Number of the element.
        element: u64,
        /// Name of the first set.
        first: String,
        /// Name of the second set.
        second: String,
    },
    /// Elements that belong to no element set of the model.
    #[error("element {element} belongs to no set of the model ({count} such elements)")]
    ElementUnassigned {
        /// Number of the first such element.
        element: u64,
        /// Number of such elements.
        count: usize,
    },
    /// An element of a set of another kind than that of the kernel of the set.
    #[error("element {element} of set '{set}' is a {found}; its kernel takes {expected}")]
    ElementKind {
        /// Number of the element.
        element: u64,
        /// Name of the element set.
        set: String,
        /// Kind of the element.
        found: &'static str,
        /// Kind that the kernel supports.
        expected: &'static str,
    },
    /// An integration point of an element without positive volume.
    #[error(
        "element {element} of set '{set}' has the volume {volume:.3e} m3 at an integration point"
    )]
    NoVolume {
        /// Number of the element.
        element: u64,
        /// Name of the element set.
        set: String,
        /// Volume of the integration point (m3).
        volume: f64,
    },
    /// An element with an extent outside the range that its law permits, such as a crack band width.
    #[error(
        "element {element} of set '{set}', {size:.4} m wide along its {extent} extent: {reason}"
    )]
    ElementSize {
        /// Number of the element.
        element: u64,
        /// Name of the element set.
        set: String,
        /// The extent in question.
        extent: ElementExtent,
        /// Extent of the element (m).
        size: f64,
        /// Message of the law, with the permitted range.
        reason: String,
    },
    /// An element with a lumped nodal mass that is not positive.
    #[error("element {element} of set '{set}' lumps the mass {mass:.3e} kg at its node {node}")]
    NoLumpedMass {
        /// Number of the element.
        element: u64,
        /// Name of the element set.
        set: String,
        /// Number of the node.
        node: u64,
        /// The lumped mass (kg).
        mass: f64,
    },
    /// A [block part](crate::BlockPart) whose node list lacks a node of one of its elements.
    #[error(
        "element {element} of set '{set}' uses node {node}, which its block part does not list"
    )]
    UnlistedNode {
        /// Number of the element.
        element: u64,
        /// Name of the element set.
        set: String,
        /// Number of the node.
        node: u64,
    },
    /// Element sets of which some store nodal values in double precision, others in single precision.
    #[error(
        "set '{first}' stores nodal values in double precision, set '{second}' in single precision"
    )]
    MixedNodes {
        /// Name of a set in double precision.
        first: String,
        /// Name of a set in single precision.
        second: String,
    },
    /// A block with an engine node that does not exist.
    #[error("a block of set '{set}' names engine node {node}, which does not exist")]
    BlockNode {
        /// Name of the element set.
        set: String,
        /// Engine number of the node.
        node: u32,
    },
    /// A node without positive, finite mass.
    #[error("node {node} has mass {mass} kg; every node needs a positive, finite mass")]
    NodeWithoutMass {
        /// Number of the node.
        node: u64,
        /// Lumped mass of the node (kg).
        mass: f64,
    },
    /// A boundary condition, load or constraint on a node that does not exist.
    #[error("{part} acts on node index {node}; the mesh has {count} nodes")]
    UnknownNode {
        /// The boundary condition, load or constraint.
        part: String,
        /// Mesh index of the node.
        node: u32,
        /// Number of nodes of the mesh.
        count: usize,
    },
    /// A load or constraint that lists a node twice.
    #[error("{part} names node {node} twice")]
    NodeTwice {
        /// The load or constraint.
        part: String,
        /// Number of the node.
        node: u64,
    },
    /// A direction vector of length zero, or with a component that is not finite.
    #[error("the direction ({x}, {y}, {z}) of {part} must have a finite length above zero")]
    NoDirection {
        /// The boundary condition or bolt with this direction.
        part: String,
        /// Component along x.
        x: f64,
        /// Component along y.
        y: f64,
        /// Component along z.
        z: f64,
    },
    /// A prescribed motion along a direction that is already fixed or prescribed.
    #[error(
        "node {node} has a prescribed motion in a direction that is already fixed or prescribed"
    )]
    SupportConflict {
        /// Number of the node.
        node: u64,
    },
    /// A load or added mass on both sides of a face, in the constructors of `FacePressure`, `FaceTraction` and
    /// `FaceMass`: a pressure cancels, a traction or mass counts twice.
    #[error("the facets include both sides of the face between elements {element} and {other}")]
    BothSides {
        /// Number of the element on one side.
        element: u64,
        /// Number of the element on the other side.
        other: u64,
    },
    /// A boundary spring or dashpot that is not symmetric and positive semi-definite.
    #[error("the boundary {what} at node {node} is not symmetric and positive semi-definite")]
    Impedance {
        /// `spring` or `dashpot`.
        what: &'static str,
        /// Number of the node.
        node: u64,
    },
    /// A facet that is deeper under water than its added mass is defined, in the constructor of `FaceMass`.
    #[error(
        "the facet of element {element} reaches to {depth:.6} m below the level; the added mass is defined to {most:.6} m"
    )]
    TooDeep {
        /// Number of the element.
        element: u64,
        /// Greatest depth of a corner (m).
        depth: f64,
        /// Greatest depth at which the mass is defined (m).
        most: f64,
    },
    /// Facets for an added mass none of which is under water, in the constructor of `FaceMass`.
    #[error("none of the {count} facets is below the level {level} m")]
    DryFacets {
        /// Number of facets.
        count: usize,
        /// Elevation of the level (m).
        level: f64,
    },
    /// Facets that are not those of a conduit of a diameter, in the constructor of `FaceMass`.
    #[error(
        "the facets do not surround water with the diameter {given} m: their curvature is that of {found:.4} m (negative where they bulge into the water, infinite where they are plane); it may differ by 20 %"
    )]
    OtherDiameter {
        /// Diameter by the angles between the facets (m).
        found: f64,
        /// Diameter given (m).
        given: f64,
    },
    /// An [added mass](crate::AddedMass) that a node cannot have.
    #[error("node {node} cannot have an added mass: {reason}")]
    AddedMass {
        /// Number of the node.
        node: u64,
        /// Why it cannot.
        reason: &'static str,
    },
    /// A gyroscopic matrix of a boundary that is not skew, or of a body that is no delayed slice.
    #[error(
        "the boundary at node {node} has a gyroscopic matrix, which must be skew and which a delayed slice alone takes"
    )]
    Gyroscopic {
        /// Number of the node.
        node: u64,
    },
    /// A node that belongs to two constraints.
    #[error("node {node} belongs to both constraints '{first}' and '{second}'")]
    ConstrainedTwice {
        /// Number of the node.
        node: u64,
        /// Name of the first constraint.
        first: String,
        /// Name of the second constraint.
        second: String,
    },
    /// A constraint whose [parts](crate::DividedConstraint::parts) do not have each of its nodes once.
    #[error(
        "the parts of constraint '{constraint}' do not have each of its nodes once: look at node {node}"
    )]
    ConstraintParts {
        /// Name of the constraint.
        constraint: String,
        /// Number of the first node that is missing, superfluous or has two parts.
        node: u64,
    },
    /// A node that cannot be in a [fibre](crate::Fibre), where fibres are [set](crate::FibreModel::set_fibres).
    #[error("node {node} cannot be in a fibre: {reason}")]
    FibreNode {
        /// Number of the node.
        node: u64,
        /// Why it cannot.
        reason: &'static str,
    },
    /// Two faces whose nodes do not match as periodic pairs, in
    /// [`PeriodicPairs::by_translation`](crate::PeriodicPairs::by_translation).
    #[error(
        "periodic faces of {from} and {to} nodes do not match: node {node} lies {distance:.3e} m from its partner (tolerance {tolerance:.1e} m)"
    )]
    PeriodicMismatch {
        /// Number of nodes of the first face.
        from: usize,
        /// Number of nodes of the second face.
        to: usize,
        /// Number of the node farthest from its partner.
        node: u64,
        /// Distance of that node from its partner, after the translation (m).
        distance: f64,
        /// Largest permitted distance (m).
        tolerance: f64,
    },
    /// Coincident nodes of two periodic faces, as at a joint that crosses them, that cannot be paired by the side on which
    /// the body lies, in [`PeriodicPairs::by_translation`](crate::PeriodicPairs::by_translation).
    #[error(
        "several nodes of one periodic face have node {node} of the other as their partner: nodes coincide there, and the surface of the body is on the same side of all of them"
    )]
    PeriodicSides {
        /// Number of the partner of several nodes.
        node: u64,
    },
    /// A node at a delayed end that is in no pair, or in several.
    #[error(
        "node {node} is in {count} delayed pairs, but every node at the two ends of the body normal to y must be in one, with the node at its other end: the two sets of delayed ends must hold all facets of these ends"
    )]
    DelayedNode {
        /// Number of the node.
        node: u64,
        /// Number of pairs that it is in.
        count: usize,
    },
    /// A delayed pair that is not along y, or farther apart than others.
    #[error(
        "the nodes {first} and {second} are a delayed pair, but not apart by ({}, {}, {}) m: delayed ends are normal to y, one of them the other translated along y", expected[0], expected[1], expected[2]
    )]
    DelayedPair {
        /// Number of the first node.
        first: u64,
        /// Number of the second node.
        second: u64,
        /// Distance of the other pairs (m).
        expected: [f64; 3],
    },
    /// Something that a body with delayed ends does not take.
    #[error("a body with delayed ends under waves along y does not take {what}: {way}")]
    DelayedWith {
        /// What it does not take.
        what: String,
        /// The way out.
        way: &'static str,
    },
    /// A slowness along y at which the inertia of a node is not positive: P waves of the material are faster than the motion
    /// along y.
    #[error(
        "at the slowness {slowness:.4e} s/m along y the share of the mass of node {node} that is left is {share:.3}, below {least}: P waves of every material must be slower than the motion along y; at most {most:.4e} s/m is possible: take the sine of the incidence at most {:.3} times as large, or an azimuth nearer to x",
        most / slowness
    )]
    DelayedMass {
        /// Number of the node.
        node: u64,
        /// Slowness along y (s/m).
        slowness: f64,
        /// Share of the mass that is left (1).
        share: f64,
        /// Least permitted share (1).
        least: f64,
        /// Slowness at which the share is the least one (s/m).
        most: f64,
    },
    /// A slowness of delayed pairs that is not finite.
    #[error("the slowness of delayed pairs along y is {slowness} s/m and must be finite")]
    DelayedSlowness {
        /// The slowness (s/m).
        slowness: f64,
    },
    /// Tied nodes with different initial velocities, where a motion or state is [set](crate::EngineModel::set_initial).
    #[error("node {node} is tied to node {partner} but has another initial velocity")]
    TiedVelocity {
        /// Number of the node.
        node: u64,
        /// Number of the node to which it is tied.
        partner: u64,
    },
    /// A state or initial motion that is [set](crate::StatefulModel::set_state), of the wrong length or with numbers that are not
    /// finite.
    #[error(
        "the {what} has {found} entries instead of {expected}, or holds a number that is not finite"
    )]
    State {
        /// `displacement`, `velocity` or `initial stress`.
        what: &'static str,
        /// Number of entries given.
        found: usize,
        /// Number of entries required.
        expected: usize,
    },
    /// An initial motion that is [set](crate::EngineModel::set_initial) and whose forces would underflow or overflow in single
    /// precision.
    #[error(
        "the largest component {largest:.3e} of the initial {what} is outside [{least:e}, {most:e}]: forces would leave the range of single precision"
    )]
    SinglePrecision {
        /// `displacement` or `velocity`.
        what: &'static str,
        /// The largest component (m or m/s).
        largest: f64,
        /// Least permitted value of the largest component (m or m/s), unless it is zero; 0 with loads or prescribed
        /// motion.
        least: f64,
        /// Greatest permitted component (m or m/s).
        most: f64,
    },
    /// A joint of a state that is [set](crate::StatefulModel::set_state) and that the model lacks, or has with other pairs.
    #[error("the state has a joint '{name}' of {pairs} pairs, which the model does not have")]
    UnknownJoint {
        /// Name of the joint.
        name: String,
        /// Number of its pairs in the state.
        pairs: usize,
    },
    /// A state that is [set](crate::StatefulModel::set_state) and whose absent or cast elements differ from those of the model.
    #[error("the absent or cast elements of the state differ from those of the model")]
    OtherElements,
    /// More ranks than blocks of elements, each of which is computed by one rank.
    #[error(
        "{ranks} ranks need as many blocks of elements, and there are {blocks}: take {blocks} ranks at most (in Rust, a block size of {block_size} elements or less gives enough blocks)"
    )]
    TooManyRanks {
        /// Number of ranks.
        ranks: usize,
        /// Number of blocks.
        blocks: usize,
        /// Largest number of elements per block with which there are enough blocks.
        block_size: usize,
    },
    /// More ranks than elements.
    #[error("{ranks} ranks cannot share {elements} elements")]
    MoreRanksThanElements {
        /// Number of ranks.
        ranks: usize,
        /// Number of elements.
        elements: usize,
    },
    /// Ranks whose models differ.
    #[error("{what} differs between the ranks, which must all build the same model")]
    RanksDiffer {
        /// The part of the model that differs.
        what: &'static str,
    },
    /// A part of a model that one rank alone can compute at present.
    #[error("{what} cannot be computed on {ranks} ranks, only on one")]
    OneRankOnly {
        /// The part of the model.
        what: String,
        /// Number of ranks.
        ranks: usize,
    },
    /// A number of threads outside 1 to 4096, or one that the operating system cannot start.
    #[error("{threads} threads could not be started (permitted: 1 to 4096)")]
    Threads {
        /// Number of threads requested.
        threads: usize,
    },
}

impl EngineError {
    /// The unit vector of a direction that a boundary condition or bolt, `part`, has.
    ///
    /// # Errors
    /// [`EngineError::NoDirection`] if its length is zero or not finite.
    pub fn check_direction(part: &str, direction: Vec3) -> Result<Vec3, Self> {
        let norm = direction.norm();
        if norm.is_finite() && norm > 0.0 {
            Ok(direction / norm)
        } else {
            Err(Self::NoDirection {
                part: part.into(),
                x: direction.x,
                y: direction.y,
                z: direction.z,
            })
        }
    }
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

/// Extent of an element: its greatest or its least one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementExtent {
    /// The greatest extent.
    Greatest,
    /// The least extent.
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
