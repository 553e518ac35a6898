//! What can be wrong with a mesh, or with a question about it.

use thiserror::Error;

/// A mesh that cannot be computed with. Numbers are the user's tags.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No elements.
    #[error("the mesh has no elements")]
    Empty,
    /// A node number that stands twice.
    #[error("node {node} is defined twice")]
    DuplicateNode {
        /// The number.
        node: u64,
    },
    /// An element number that stands twice.
    #[error("element {element} is defined twice")]
    DuplicateElement {
        /// The number.
        element: u64,
    },
    /// Two elements on the same nodes.
    #[error("elements {first} and {second} have the same nodes")]
    CoincidentElements {
        /// One number.
        first: u64,
        /// The other.
        second: u64,
    },
    /// A coordinate that is not finite.
    #[error("node {node} has coordinate {axis} = {value}, which is not finite")]
    CoordinateNotFinite {
        /// The node's number.
        node: u64,
        /// `x`, `y` or `z`.
        axis: char,
        /// The value.
        value: f64,
    },
    /// An element that names a node twice.
    #[error("element {element} uses node {node} twice")]
    RepeatedNode {
        /// The element's number.
        element: u64,
        /// The node's number.
        node: u64,
    },
    /// An element that names a node which does not exist.
    #[error("element {element} uses node {node}, which does not exist")]
    DanglingNode {
        /// The element's number.
        element: u64,
        /// The node's number.
        node: u64,
    },
    /// A node count that does not fit the kind.
    #[error("element {element} of kind {kind} has {found} nodes instead of {expected}")]
    NodeCount {
        /// The element's number.
        element: u64,
        /// Its kind.
        kind: &'static str,
        /// Nodes given.
        found: usize,
        /// Nodes wanted.
        expected: usize,
    },
    /// An inverted or flat element.
    #[error(
        "element {element} is inverted or flat: its scaled Jacobian at corner node {node} is {scaled_jacobian:.3e}"
    )]
    Inverted {
        /// The element's number.
        element: u64,
        /// The number of the corner node.
        node: u64,
        /// Jacobian determinant over the product of its edge lengths.
        scaled_jacobian: f64,
    },
    /// A bar without length.
    #[error("bar {element} has no length")]
    NoLength {
        /// The element's number.
        element: u64,
    },
    /// Nodes without elements.
    #[error("node {node} belongs to no element ({count} such nodes)")]
    OrphanNode {
        /// The first such node's number.
        node: u64,
        /// How many there are.
        count: usize,
    },
    /// The mesh falls apart.
    #[error(
        "the mesh has {parts} parts that share no nodes; the smaller ones hold element {element} and others"
    )]
    Disconnected {
        /// How many.
        parts: usize,
        /// An element of the second largest part.
        element: u64,
    },
    /// A set that does not exist.
    #[error("there is no {what} set '{name}'; the mesh has {}", available.join(", "))]
    NoSuchSet {
        /// `node`, `facet`, `element`, or all three of them.
        what: &'static str,
        /// The wanted name.
        name: String,
        /// Names that exist.
        available: Vec<String>,
    },
    /// A set that refers to something outside the mesh.
    #[error("the {what} set '{name}' refers to number {number}, which does not exist")]
    SetOutOfRange {
        /// `node`, `facet` or `element`.
        what: &'static str,
        /// The set.
        name: String,
        /// A node's or element's number as far as it was given as such, else its index.
        number: u64,
    },
    /// A facet that is no side of any element.
    #[error("a facet of set '{name}' with nodes {nodes:?} is no side of an element")]
    FacetWithoutElement {
        /// The set.
        name: String,
        /// Numbers of its nodes.
        nodes: Vec<u64>,
    },
    /// Numbers so large that smaller elements cannot have numbers of their own behind them.
    #[error("numbers of {what}s are too large for more of them to have numbers of their own")]
    Numbers {
        /// `node` or `element`.
        what: &'static str,
    },
    /// More than 2^32 - 1 nodes or elements.
    #[error("the mesh has {count} {what}, more than this version can number")]
    TooLarge {
        /// What they are, such as `nodes`.
        what: &'static str,
        /// How many.
        count: usize,
    },
    /// A facet with a side that its element does not have.
    #[error(
        "the facet set '{name}' names side {side} of element {element}, which has {sides} sides"
    )]
    NoSuchSide {
        /// The set.
        name: String,
        /// The element's number.
        element: u64,
        /// The side.
        side: u8,
        /// How many sides the element has.
        sides: usize,
    },
    /// An element on both sides of a cut.
    #[error("element {element} belongs to both parts between which the mesh is to be cut")]
    SharedElement {
        /// The element's number.
        element: u64,
    },
    /// Two parts that do not touch.
    #[error("the two parts between which the mesh is to be cut have no facet in common")]
    NoCommonFacets,
    /// A box without extent along an axis, or with corners that are not finite.
    #[error("a box from {low} to {high} along {axis} has no extent")]
    NoExtent {
        /// `x`, `y` or `z`.
        axis: char,
        /// The lower coordinate (m).
        low: f64,
        /// The upper coordinate (m).
        high: f64,
    },
    /// A plane that meets no element, or only touches them.
    #[error(
        "the plane {axis} = {value} m cuts no element: the mesh reaches from {low} to {high} m"
    )]
    NoSlice {
        /// `x`, `y` or `z`.
        axis: char,
        /// Where the plane is (m).
        value: f64,
        /// The lowest coordinate of the mesh (m).
        low: f64,
        /// The highest one (m).
        high: f64,
    },
    /// A box in which no solid element lies.
    #[error("no solid element has its centre between {low:?} and {high:?} m")]
    NothingWithin {
        /// The lowest coordinates of the box (m).
        low: [f64; 3],
        /// The highest ones (m).
        high: [f64; 3],
    },
    /// A mesh that is not the same in every slice across an axis.
    #[error(
        "the mesh is not the same all along {axis}: element {element} of the slice does not stand between two planes, or the slice is {share:.6} of the volume for its thickness instead of 1"
    )]
    NotExtruded {
        /// `x`, `y` or `z`.
        axis: char,
        /// The number of the element that is farthest from it.
        element: u64,
        /// Volume of the slice over that of the mesh, times extent over thickness.
        share: f64,
    },
    /// A point with a coordinate that is not finite.
    #[error("the point {point:?} is not finite")]
    PointNotFinite {
        /// Its coordinates (m).
        point: [f64; 3],
    },
    /// A point that lies in no solid element.
    #[error(
        "the point {point:?} lies in no element: the nearest is {element}, {distance:.3e} m away (permitted {tolerance:.3e} m)"
    )]
    PointOutside {
        /// Its coordinates (m).
        point: [f64; 3],
        /// The number of the nearest element.
        element: u64,
        /// How far the point would have to move to lie in it (m).
        distance: f64,
        /// How far it may move (m).
        tolerance: f64,
    },
}
