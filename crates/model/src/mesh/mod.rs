//! Finite element meshes with named sets.

mod arrays;
mod build;
mod check;
mod copy_on_write;
mod error;
mod facet;
mod generate;
mod kind;
mod locate;
mod near;
mod order;
mod part;
mod refine;
mod select;
mod shape;
mod sides;
mod slice;
mod split;
mod stress_slope;

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::Vec3;
pub use arrays::MeshArrays;
pub use build::MeshBuilder;
pub use check::QualityReport;
use copy_on_write::CopyOnWrite;
pub use copy_on_write::SharedArray;
pub use error::MeshError;
pub use facet::{FacetGeometry, NodeTributary};
pub use kind::ElementKind;
pub use locate::Located;
pub use select::Axis;
pub use split::Split;

/// A facet: one side of one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Facet {
    /// Mesh index of the element.
    pub element: u32,
    /// Index of the side in [`ElementKind::sides`].
    pub side: u8,
}

/// A finite element mesh: nodes, elements, and named sets of nodes, elements and facets.
///
/// Nodes and elements are addressed by mesh indices from 0 in the order of the file; the user's
/// numbers (tags) are kept and used in all messages and results.
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
    pub(crate) positions: CopyOnWrite<Vec3>,
    pub(crate) node_tags: CopyOnWrite<u64>,
    pub(crate) kinds: CopyOnWrite<ElementKind>,
    pub(crate) element_tags: CopyOnWrite<u64>,
    pub(crate) offsets: CopyOnWrite<u32>,
    pub(crate) connectivity: CopyOnWrite<u32>,
    pub(crate) node_sets: Arc<BTreeMap<String, Vec<u32>>>,
    pub(crate) element_sets: Arc<BTreeMap<String, Vec<u32>>>,
    pub(crate) facet_sets: Arc<BTreeMap<String, Vec<Facet>>>,
}

impl Mesh {
    /// A builder of a mesh, without nodes and elements.
    pub fn builder() -> MeshBuilder {
        MeshBuilder::default()
    }
    /// Positions of the nodes (m), in the order of their mesh indices.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }
    /// The user's numbers of the nodes, in the order of their mesh indices.
    pub fn node_tags(&self) -> &[u64] {
        &self.node_tags
    }
    /// The user's numbers of the elements, in the order of their mesh indices.
    pub fn element_tags(&self) -> &[u64] {
        &self.element_tags
    }
    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.positions.len()
    }
    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.kinds.len()
    }
    /// The kind of an element (mesh index).
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn kind(&self, element: u32) -> ElementKind {
        self.kinds[element as usize]
    }
    /// Mesh indices of the nodes of an element, in Gmsh's order.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn nodes_of(&self, element: u32) -> &[u32] {
        let element = element as usize;
        &self.connectivity[self.offsets[element] as usize..self.offsets[element + 1] as usize]
    }
    /// Centroid of the nodes of an element (m).
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn centroid(&self, element: u32) -> Vec3 {
        let nodes = self.nodes_of(element);
        let sum: Vec3 = nodes.iter().map(|&n| self.positions[n as usize]).sum();
        sum / nodes.len() as f64
    }
    /// Bounding box of all nodes: lower and upper corner (m).
    pub fn bounding_box(&self) -> (Vec3, Vec3) {
        let infinite = Vec3::repeat(f64::INFINITY);
        self.positions
            .iter()
            .fold((infinite, -infinite), |(low, high), p| {
                (low.inf(p), high.sup(p))
            })
    }
    /// Mesh indices of the elements of a named set, in rising order.
    ///
    /// # Errors
    /// [`MeshError::NoSuchSet`] with the existing names.
    pub fn element_set(&self, name: &str) -> Result<&[u32], MeshError> {
        find("element", &self.element_sets, name)
    }
    /// Mesh indices of the nodes of a named set, in rising order.
    ///
    /// # Errors
    /// [`MeshError::NoSuchSet`] with the existing names.
    pub fn node_set(&self, name: &str) -> Result<&[u32], MeshError> {
        find("node", &self.node_sets, name)
    }
    /// Facets of a named set, in rising order.
    ///
    /// # Errors
    /// [`MeshError::NoSuchSet`] with the existing names.
    pub fn facet_set(&self, name: &str) -> Result<&[Facet], MeshError> {
        find("facet", &self.facet_sets, name)
    }
    /// All element sets: mesh indices of their elements, by name.
    pub fn element_sets(&self) -> &BTreeMap<String, Vec<u32>> {
        &self.element_sets
    }
    /// All node sets: mesh indices of their nodes, by name.
    pub fn node_sets(&self) -> &BTreeMap<String, Vec<u32>> {
        &self.node_sets
    }
    /// All facet sets: their facets (element and face), by name.
    pub fn facet_sets(&self) -> &BTreeMap<String, Vec<Facet>> {
        &self.facet_sets
    }
    /// Adds or replaces a node set; duplicates are removed.
    ///
    /// # Errors
    /// [`MeshError::SetOutOfRange`].
    pub fn set_node_set(&mut self, name: &str, mut nodes: Vec<u32>) -> Result<(), MeshError> {
        nodes.sort_unstable();
        nodes.dedup();
        in_range("node", name, nodes.last(), self.node_count())?;
        Arc::make_mut(&mut self.node_sets).insert(name.into(), nodes);
        Ok(())
    }
    /// Adds or replaces an element set; duplicates are removed.
    ///
    /// # Errors
    /// [`MeshError::SetOutOfRange`].
    pub fn set_element_set(&mut self, name: &str, mut elements: Vec<u32>) -> Result<(), MeshError> {
        elements.sort_unstable();
        elements.dedup();
        in_range("element", name, elements.last(), self.element_count())?;
        Arc::make_mut(&mut self.element_sets).insert(name.into(), elements);
        Ok(())
    }
    /// Adds or replaces a facet set; duplicates are removed.
    ///
    /// # Errors
    /// [`MeshError::SetOutOfRange`], [`MeshError::NoSuchSide`].
    pub fn set_facet_set(&mut self, name: &str, mut facets: Vec<Facet>) -> Result<(), MeshError> {
        facets.sort_unstable();
        facets.dedup();
        let last = facets.last().map(|facet| facet.element);
        in_range("facet", name, last.as_ref(), self.element_count())?;
        for facet in &facets {
            let sides = self.kind(facet.element).sides().len();
            if facet.side as usize >= sides {
                return Err(MeshError::NoSuchSide {
                    name: name.into(),
                    element: self.element_tags[facet.element as usize],
                    side: facet.side,
                    sides,
                });
            }
        }
        Arc::make_mut(&mut self.facet_sets).insert(name.into(), facets);
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
            number: index.into(),
        }),
        _ => Ok(()),
    }
}
