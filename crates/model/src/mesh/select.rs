//! Selection of nodes, elements and facets by geometry or by name.

use super::{Facet, Mesh, MeshError};
use crate::Vec3;
#[cfg(feature = "keys")]
use crate::keys::*;

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(rename_all = "kebab-case"))]
pub enum Axis {
    /// The first horizontal axis, x.
    X,
    /// The second horizontal axis, y.
    Y,
    /// The vertical axis z, upwards.
    Z,
}

impl Axis {
    /// Index of the coordinate: 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }
    /// Unit vector along the axis.
    pub fn unit(self) -> Vec3 {
        Vec3::ith(self.index(), 1.0)
    }
    /// Letter of the axis: `x`, `y` or `z`.
    pub fn name(self) -> char {
        ['x', 'y', 'z'][self.index()]
    }
}

impl Mesh {
    /// Surface facets all of whose nodes lie within `tolerance` (m) of the plane on which the
    /// coordinate along `axis` is `value` (m), in rising order.
    pub fn facets_on_plane(&self, axis: Axis, value: f64, tolerance: f64) -> Vec<Facet> {
        self.alone_among(|nodes| {
            nodes.iter().all(|&node| {
                (self.positions[node as usize][axis.index()] - value).abs() <= tolerance
            })
        })
    }

    /// Nodes in a closed box (m), in rising order.
    pub fn nodes_in_box(&self, low: &Vec3, high: &Vec3) -> Vec<u32> {
        let inside = |&node: &u32| lies_in(&self.positions[node as usize], low, high);
        (0..self.node_count() as u32).filter(inside).collect()
    }

    /// Elements whose [centroid](Self::centroid) lies in a closed box (m), in rising order.
    pub fn elements_in_box(&self, low: &Vec3, high: &Vec3) -> Vec<u32> {
        let inside = |&element: &u32| lies_in(&self.centroid(element), low, high);
        (0..self.element_count() as u32).filter(inside).collect()
    }

    /// Nodes of facets, each once, in rising order.
    ///
    /// # Panics
    /// If a facet does not belong to this mesh.
    pub fn nodes_of_facets(&self, facets: &[Facet]) -> Vec<u32> {
        let nodes = facets.iter().flat_map(|&facet| self.facet_nodes(facet));
        sorted_once(nodes.collect())
    }

    /// Nodes of elements, each once, in rising order.
    ///
    /// # Panics
    /// If an element does not belong to this mesh.
    pub fn nodes_of_elements(&self, elements: &[u32]) -> Vec<u32> {
        let nodes = elements.iter().flat_map(|&element| self.nodes_of(element));
        sorted_once(nodes.copied().collect())
    }

    /// The nodes of a named set of any kind, in rising order: of the node set of this name; if there is none,
    /// of the facet set; if there is none either, of the element set.
    ///
    /// # Errors
    /// [`MeshError::NoSuchSet`] with the names of all sets.
    pub fn nodes_of_set(&self, name: &str) -> Result<Vec<u32>, MeshError> {
        if let Some(nodes) = self.node_sets.get(name) {
            return Ok(nodes.clone());
        }
        if let Some(facets) = self.facet_sets.get(name) {
            return Ok(self.nodes_of_facets(facets));
        }
        if let Some(elements) = self.element_sets.get(name) {
            return Ok(self.nodes_of_elements(elements));
        }
        let names = (self.node_sets.keys())
            .chain(self.facet_sets.keys())
            .chain(self.element_sets.keys());
        Err(MeshError::NoSuchSet {
            what: "node, facet or element",
            name: name.into(),
            available: names.cloned().collect(),
        })
    }
}

pub(super) fn lies_in(position: &Vec3, low: &Vec3, high: &Vec3) -> bool {
    (0..3).all(|i| low[i] <= position[i] && position[i] <= high[i])
}

fn sorted_once(mut nodes: Vec<u32>) -> Vec<u32> {
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
