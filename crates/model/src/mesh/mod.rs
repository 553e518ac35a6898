//! Meshes with named sets.

mod check;
mod facet;
mod kind;

use std::collections::BTreeMap;

use thiserror::Error;

use crate::Vec3;
pub use check::QualityReport;
pub use facet::{FacetGeometry, NodeTributary};
pub use kind::ElementKind;

/// One side of one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Facet {
    /// Mesh index of the element.
    pub element: u32,
    /// Which side, an index into [`ElementKind::sides`].
    pub side: u8,
}

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
        /// `node`, `facet` or `element`.
        what: &'static str,
        /// The wanted name.
        name: String,
        /// Names that exist.
        available: Vec<String>,
    },
    /// A set that refers to something outside the mesh.
    #[error("the {what} set '{name}' refers to number {index}, which does not exist")]
    SetOutOfRange {
        /// `node`, `facet` or `element`.
        what: &'static str,
        /// The set.
        name: String,
        /// The index.
        index: u32,
    },
    /// A facet that is no side of any element.
    #[error("a facet of set '{name}' with nodes {nodes:?} is no side of an element")]
    FacetWithoutElement {
        /// The set.
        name: String,
        /// Numbers of its nodes.
        nodes: Vec<u64>,
    },
    /// More than 2^32 - 1 nodes or elements.
    #[error("the mesh has {count} {what}, more than this version can number")]
    TooLarge {
        /// `nodes` or `elements`.
        what: &'static str,
        /// How many.
        count: usize,
    },
}

/// Nodes, elements and named sets.
///
/// Inside the software nodes and elements are indices from 0 in the order of the file; the user's
/// own numbers (tags) are kept and named in every message and result.
///
/// ```
/// use powerhouse_model::{ElementKind, Mesh, Vec3};
/// let mut builder = Mesh::builder();
/// for (tag, corner) in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].iter().enumerate() {
///     builder.node(tag as u64 + 1, Vec3::from(*corner));
/// }
/// builder.element(1, ElementKind::Tet4, &[1, 2, 3, 4], &["rock"]);
/// let mesh = builder.build()?;
/// assert_eq!(mesh.element_set("rock")?, &[0]);
/// # Ok::<(), powerhouse_model::MeshError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) node_tags: Vec<u64>,
    pub(crate) kinds: Vec<ElementKind>,
    pub(crate) element_tags: Vec<u64>,
    pub(crate) offsets: Vec<u32>,
    pub(crate) connectivity: Vec<u32>,
    pub(crate) node_sets: BTreeMap<String, Vec<u32>>,
    pub(crate) element_sets: BTreeMap<String, Vec<u32>>,
    pub(crate) facet_sets: BTreeMap<String, Vec<Facet>>,
}

impl Mesh {
    /// Starts an empty mesh.
    pub fn builder() -> MeshBuilder {
        MeshBuilder::default()
    }
    /// Positions of the nodes (m).
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }
    /// The user's numbers of the nodes.
    pub fn node_tags(&self) -> &[u64] {
        &self.node_tags
    }
    /// The user's numbers of the elements.
    pub fn element_tags(&self) -> &[u64] {
        &self.element_tags
    }
    /// How many nodes.
    pub fn node_count(&self) -> usize {
        self.positions.len()
    }
    /// How many elements.
    pub fn element_count(&self) -> usize {
        self.kinds.len()
    }
    /// The kind of an element.
    ///
    /// # Panics
    /// If the index is out of range, as the next two.
    pub fn kind(&self, element: u32) -> ElementKind {
        self.kinds[element as usize]
    }
    /// The nodes of an element, in Gmsh's order.
    pub fn nodes_of(&self, element: u32) -> &[u32] {
        let element = element as usize;
        &self.connectivity[self.offsets[element] as usize..self.offsets[element + 1] as usize]
    }
    /// The centroid of an element's nodes (m).
    pub fn centroid(&self, element: u32) -> Vec3 {
        let nodes = self.nodes_of(element);
        let sum: Vec3 = nodes.iter().map(|&n| self.positions[n as usize]).sum();
        sum / nodes.len() as f64
    }
    /// Lowest and highest corner of the box around all nodes (m).
    pub fn bounding_box(&self) -> (Vec3, Vec3) {
        let infinite = Vec3::repeat(f64::INFINITY);
        self.positions
            .iter()
            .fold((infinite, -infinite), |(low, high), p| {
                (low.inf(p), high.sup(p))
            })
    }
    /// Elements of a named set, in rising order.
    ///
    /// # Errors
    /// [`MeshError::NoSuchSet`] with the names that exist; so do the next two.
    pub fn element_set(&self, name: &str) -> Result<&[u32], MeshError> {
        find("element", &self.element_sets, name)
    }
    /// Nodes of a named set, in rising order.
    pub fn node_set(&self, name: &str) -> Result<&[u32], MeshError> {
        find("node", &self.node_sets, name)
    }
    /// Facets of a named set.
    pub fn facet_set(&self, name: &str) -> Result<&[Facet], MeshError> {
        find("facet", &self.facet_sets, name)
    }
    /// All element sets by name.
    pub fn element_sets(&self) -> &BTreeMap<String, Vec<u32>> {
        &self.element_sets
    }
    /// All node sets by name.
    pub fn node_sets(&self) -> &BTreeMap<String, Vec<u32>> {
        &self.node_sets
    }
    /// All facet sets by name.
    pub fn facet_sets(&self) -> &BTreeMap<String, Vec<Facet>> {
        &self.facet_sets
    }
    /// Adds or replaces a node set; duplicates vanish.
    ///
    /// # Errors
    /// [`MeshError::SetOutOfRange`].
    pub fn set_node_set(&mut self, name: &str, mut nodes: Vec<u32>) -> Result<(), MeshError> {
        nodes.sort_unstable();
        nodes.dedup();
        in_range("node", name, nodes.last(), self.node_count())?;
        self.node_sets.insert(name.into(), nodes);
        Ok(())
    }
    /// Adds or replaces an element set; duplicates vanish.
    ///
    /// # Errors
    /// [`MeshError::SetOutOfRange`].
    pub fn set_element_set(&mut self, name: &str, mut elements: Vec<u32>) -> Result<(), MeshError> {
        elements.sort_unstable();
        elements.dedup();
        in_range("element", name, elements.last(), self.element_count())?;
        self.element_sets.insert(name.into(), elements);
        Ok(())
    }
    /// Adds or replaces a facet set; duplicates vanish.
    ///
    /// # Errors
    /// [`MeshError::SetOutOfRange`].
    pub fn set_facet_set(&mut self, name: &str, mut facets: Vec<Facet>) -> Result<(), MeshError> {
        facets.sort_unstable();
        facets.dedup();
        let last = facets.last().map(|facet| facet.element);
        in_range("facet", name, last.as_ref(), self.element_count())?;
        self.facet_sets.insert(name.into(), facets);
        Ok(())
    }
}

fn find<'a, T>(
    what: &'static str,
    sets: &'a BTreeMap<String, Vec<T>>,
    name: &str,
) -> Result<&'a [T], MeshError> {
    sets.get(name)
        .map(Vec::as_slice)
        .ok_or_else(|| MeshError::NoSuchSet {
            what,
            name: name.into(),
            available: sets.keys().cloned().collect(),
        })
}

fn in_range(
    what: &'static str,
    name: &str,
    largest: Option<&u32>,
    count: usize,
) -> Result<(), MeshError> {
    match largest {
        Some(&index) if index as usize >= count => Err(MeshError::SetOutOfRange {
            what,
            name: name.into(),
            index,
        }),
        _ => Ok(()),
    }
}

/// Collects nodes, elements and sets by the user's numbers, then checks them all at once.
#[derive(Clone, Debug, Default)]
pub struct MeshBuilder {
    nodes: Vec<(u64, Vec3)>,
    elements: Vec<(u64, ElementKind, u32)>,
    corners: Vec<u64>,
    element_sets: BTreeMap<String, Vec<u32>>,
    facet_sets: BTreeMap<String, Vec<Vec<u64>>>,
    node_sets: BTreeMap<String, Vec<u64>>,
}

impl MeshBuilder {
    /// Adds a node with the user's number at a position (m).
    pub fn node(&mut self, tag: u64, position: Vec3) -> &mut Self {
        self.nodes.push((tag, position));
        self
    }
    /// Adds an element on nodes given by number, in Gmsh's order, to any number of sets.
    pub fn element(
        &mut self,
        tag: u64,
        kind: ElementKind,
        nodes: &[u64],
        sets: &[impl AsRef<str>],
    ) -> &mut Self {
        let index = self.elements.len() as u32;
        self.elements.push((tag, kind, nodes.len() as u32));
        self.corners.extend_from_slice(nodes);
        for set in sets {
            match self.element_sets.get_mut(set.as_ref()) {
                Some(elements) => elements.push(index),
                None => {
                    self.element_sets.insert(set.as_ref().into(), vec![index]);
                }
            }
        }
        self
    }
    /// Adds a facet, given by the numbers of its nodes in any order, to a set; it must be a side of
    /// an element.
    pub fn facet(&mut self, set: &str, nodes: &[u64]) -> &mut Self {
        self.facet_sets
            .entry(set.into())
            .or_default()
            .push(nodes.to_vec());
        self
    }
    /// Adds nodes to a set.
    pub fn node_set(&mut self, set: &str, nodes: &[u64]) -> &mut Self {
        self.node_sets
            .entry(set.into())
            .or_default()
            .extend_from_slice(nodes);
        self
    }
    /// Checks numbers and ranges and makes the mesh. Quality is the business of
    /// [`Mesh::check`].
    ///
    /// # Errors
    /// The first fault found, with the user's numbers.
    pub fn build(self) -> Result<Mesh, MeshError> {
        check::build(self)
    }
}
