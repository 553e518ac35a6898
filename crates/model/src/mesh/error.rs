//! Errors of meshes and of operations on them.

use thiserror::Error;

/// A fault of a mesh, or a failed operation on a mesh. Nodes and elements are named by the user's numbers (tags).
///
/// Faults up to [`NodeCount`](Self::NodeCount), and those of sets and facets, are found when a mesh is built
/// ([`MeshBuilder::build`](crate::MeshBuilder::build)); those of shapes and nodes without elements by
/// [`Mesh::check`](crate::Mesh::check).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A mesh, or a part of one, without elements; for points, without solid elements.
    #[error("the mesh has no elements")]
    Empty,
    /// A node number that is used twice.
    #[error("node {node} is defined twice")]
    DuplicateNode {
        /// The node number.
        node: u64,
    },
    /// An element number that is used twice.
    #[error("element {element} is defined twice")]
    DuplicateElement {
        /// The element number.
        element: u64,
    },
    /// Two elements on the same nodes.
    #[error("elements {first} and {second} have the same nodes")]
    CoincidentElements {
        /// Number of the first element.
        first: u64,
        /// Number of the second element.
        second: u64,
    },
    /// A coordinate that is not finite.
    #[error("node {node} has coordinate {axis} = {value}, which is not finite")]
    CoordinateNotFinite {
        /// Number of the node.
        node: u64,
        /// Axis of the coordinate: `x`, `y` or `z`.
        axis: char,
        /// Value of the coordinate.
        value: f64,
    },
    /// An element that uses a node twice.
    #[error("element {element} uses node {node} twice")]
    RepeatedNode {
        /// Number of the element.
        element: u64,
        /// Number of the node.
        node: u64,
    },
    /// An element that uses a node which does not exist.
    #[error("element {element} uses node {node}, which does not exist")]
    DanglingNode {
        /// Number of the element.
        element: u64,
        /// Number of the node.
        node: u64,
    },
    /// An element with a number of nodes that does not match its kind.
    #[error("element {element} of kind {kind} has {found} nodes instead of {expected}")]
    NodeCount {
        /// Number of the element.
        element: u64,
        /// Kind of the element.
        kind: &'static str,
        /// Number of nodes given.
        found: usize,
        /// Number of nodes of this kind.
        expected: usize,
    },
    /// Arrays of a mesh whose lengths do not fit.
    #[error("there are {found} {what} instead of {expected}")]
    ArrayLength {
        /// What the array has.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Length expected.
        expected: usize,
    },
    /// An inverted or flat solid element.
    #[error(
        "element {element} is inverted or flat: its scaled Jacobian at corner node {node} is {scaled_jacobian:.3e}"
    )]
    Inverted {
        /// Number of the element.
        element: u64,
        /// Number of the corner node.
        node: u64,
        /// Scaled Jacobian at the corner: determinant over the product of the edge lengths.
        scaled_jacobian: f64,
    },
    /// A node at the middle of an edge that is not at its midpoint: elements with such nodes have straight edges.
    #[error(
        "element {element} of kind {kind} has a curved edge: node {node} is {offset:.3e} m off the midpoint of the edge"
    )]
    CurvedEdge {
        /// Number of the element.
        element: u64,
        /// Kind of the element.
        kind: &'static str,
        /// Number of the node.
        node: u64,
        /// Distance of the node from the midpoint (m).
        offset: f64,
    },
    /// A node that an element with nodes on its edges shares with one of a kind that does not fit its sides.
    #[error(
        "element {element} of kind {kind} and element {other} of kind {other_kind} share node {node}, but their sides do not fit: tetrahedra with midpoints join their like alone"
    )]
    SidesDoNotFit {
        /// Number of the element with nodes on its edges.
        element: u64,
        /// Its kind.
        kind: &'static str,
        /// Number of the other element.
        other: u64,
        /// Its kind.
        other_kind: &'static str,
        /// Number of the node.
        node: u64,
    },
    /// A mesh without tetrahedra, which were to get midpoints.
    #[error("the mesh has no tetrahedra, which alone can be of second order")]
    NoTetrahedra,
    /// An element of a kind that uniform refinement does not divide.
    #[error("element {element} is a {kind}, which refinement does not divide")]
    NotDivided {
        /// Number of the element.
        element: u64,
        /// Kind of the element.
        kind: &'static str,
    },
    /// A bar of length zero.
    #[error("bar {element} has zero length")]
    NoLength {
        /// Number of the element.
        element: u64,
    },
    /// Nodes that belong to no element.
    #[error("node {node} belongs to no element ({count} such nodes)")]
    OrphanNode {
        /// Number of the first such node.
        node: u64,
        /// Number of such nodes.
        count: usize,
    },
    /// A mesh of more than one connected component, in [`Mesh::check_connected`](crate::Mesh::check_connected).
    #[error(
        "the mesh has {parts} parts that share no nodes; the smaller ones contain element {element} and others"
    )]
    Disconnected {
        /// Number of connected components.
        parts: usize,
        /// Number of an element of the second largest component.
        element: u64,
    },
    /// A set that does not exist.
    #[error("there is no {what} set '{name}'; the mesh has {}", available.join(", "))]
    NoSuchSet {
        /// Kind of set: `node`, `facet`, `element`, or all three of them.
        what: &'static str,
        /// The requested name.
        name: String,
        /// Names of the existing sets.
        available: Vec<String>,
    },
    /// A set with a node or element that does not exist.
    #[error("the {what} set '{name}' refers to number {number}, which does not exist")]
    SetOutOfRange {
        /// Kind of set: `node`, `facet` or `element`.
        what: &'static str,
        /// Name of the set.
        name: String,
        /// The user's number of the node or element where it was given, else its index.
        number: u64,
    },
    /// A facet that is not a side of any element.
    #[error("a facet of set '{name}' with nodes {nodes:?} is not a side of an element")]
    FacetWithoutElement {
        /// Name of the facet set.
        name: String,
        /// Numbers of the nodes of the facet.
        nodes: Vec<u64>,
    },
    /// Node or element numbers too large for the numbers of a refined mesh to fit 64 bits.
    #[error("the {what} numbers are too large: numbers of the refined mesh would exceed 64 bits")]
    Numbers {
        /// `node` or `element`.
        what: &'static str,
    },
    /// More than 2^32 - 2 nodes, elements or element corners.
    #[error("the mesh has {count} {what}; at most 4294967294 are supported")]
    TooLarge {
        /// The kind of entity, such as `nodes`.
        what: &'static str,
        /// Number of entities.
        count: usize,
    },
    /// A facet with a side that its element does not have, in [`Mesh::set_facet_set`](crate::Mesh::set_facet_set).
    #[error(
        "the facet set '{name}' contains side {side} of element {element}, which has {sides} sides"
    )]
    NoSuchSide {
        /// Name of the facet set.
        name: String,
        /// Number of the element.
        element: u64,
        /// Index of the side.
        side: u8,
        /// Number of sides of the element.
        sides: usize,
    },
    /// An element in both element lists of [`Mesh::split_between`](crate::Mesh::split_between).
    #[error(
        "element {element} belongs to both element lists between which the mesh is to be split"
    )]
    SharedElement {
        /// Number of the element.
        element: u64,
    },
    /// Two element lists of [`Mesh::split_between`](crate::Mesh::split_between) without common facets.
    #[error("the two element lists between which the mesh is to be split have no facet in common")]
    NoCommonFacets,
    /// A box without extent along an axis, or with corners that are not finite.
    #[error("a box from {low} to {high} along {axis} has no finite, positive extent")]
    NoExtent {
        /// `x`, `y` or `z`.
        axis: char,
        /// The lower coordinate (m).
        low: f64,
        /// The upper coordinate (m).
        high: f64,
    },
    /// A plane of [`Mesh::plane_slice`](crate::Mesh::plane_slice) that intersects no solid element.
    #[error(
        "the plane {axis} = {value} m cuts no element: the mesh extends from {low} to {high} m"
    )]
    NoSlice {
        /// Axis normal to the plane: `x`, `y` or `z`.
        axis: char,
        /// Coordinate of the plane (m).
        value: f64,
        /// Lowest coordinate of the mesh (m).
        low: f64,
        /// Highest coordinate of the mesh (m).
        high: f64,
    },
    /// A box of [`Mesh::within`](crate::Mesh::within) that contains the centroid of no solid element.
    #[error("no solid element has its centroid between {low:?} and {high:?} m")]
    NothingWithin {
        /// Lower corner of the box (m).
        low: [f64; 3],
        /// Upper corner of the box (m).
        high: [f64; 3],
    },
    /// A mesh that is not extruded along an axis, as [`Mesh::plane_slice`](crate::Mesh::plane_slice) requires.
    #[error(
        "the mesh is not the same all along {axis}: element {element} of the slice does not lie between two planes, or the volume of the slice is {share:.6} times its share by thickness instead of 1"
    )]
    NotExtruded {
        /// The axis: `x`, `y` or `z`.
        axis: char,
        /// Number of the first element of the slice that is not between its planes, or of its first element.
        element: u64,
        /// Ratio of the slice's volume to the mesh's volume, times the mesh's extent over the slice's thickness.
        share: f64,
    },
    /// A point to be located with a coordinate that is not finite.
    #[error("the point {point:?} is not finite")]
    PointNotFinite {
        /// Coordinates of the point (m).
        point: [f64; 3],
    },
    /// A point to be located that is outside all elements that may contain it by more than the tolerance.
    #[error(
        "the point {point:?} lies in no element: the nearest is {element}, {distance:.3e} m away (permitted {tolerance:.3e} m)"
    )]
    PointOutside {
        /// Coordinates of the point (m).
        point: [f64; 3],
        /// Number of the nearest element.
        element: u64,
        /// Distance of the point from that element (m).
        distance: f64,
        /// Largest permitted distance (m).
        tolerance: f64,
    },
}
