//! Options of reading meshes, and elements of second order in every format that has them.

use std::collections::HashSet;

use powerhouse_model::{Mesh, Vec3};

/// Options of reading a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MeshOptions<'n> {
    /// Whether all elements of second order are read as those with the same corners; false by default.
    pub first_order: bool,
    /// Whether nodes at the middle of curved edges are moved to the midpoints; false by default: curved edges are an error.
    pub straighten: bool,
    /// Names of the groups of lines of a Gmsh file that are bars; other lines are left out. By default every line of
    /// a group is a bar that can be one.
    pub bars: Option<&'n [&'n str]>,
}

impl<'n> MeshOptions<'n> {
    /// Elements of second order are read as those with the same corners.
    #[must_use]
    pub fn with_first_order(mut self) -> Self {
        self.first_order = true;
        self
    }
    /// Nodes at the middle of curved edges are moved to the midpoints.
    #[must_use]
    pub fn with_straight_edges(mut self) -> Self {
        self.straighten = true;
        self
    }
    /// Lines of the groups of these names alone are bars.
    #[must_use]
    pub fn with_bars(mut self, names: &'n [&'n str]) -> Self {
        self.bars = Some(names);
        self
    }
}

/// Nodes at the middle of an edge that are not at its midpoint.
#[derive(Default)]
pub(crate) struct CurvedNodes {
    tags: HashSet<u64>,
    largest: f64,
}

impl CurvedNodes {
    /// Adds those of an element, from the numbers of its nodes, corners first, and the local ends of the edges whose middle
    /// nodes follow the corners; `position` is that of a node with a number (m).
    pub(crate) fn add(
        &mut self,
        nodes: &[u64],
        (corners, edges): (usize, &[[u8; 2]]),
        position: impl Fn(u64) -> Vec3,
    ) {
        let at = |local: usize| position(nodes[local]);
        for (i, ends) in edges.iter().enumerate() {
            let [a, b] = ends.map(|end| at(end.into()));
            let middle = corners + i;
            let offset = (at(middle) - (a + b) * 0.5).norm();
            if offset > Mesh::STRAIGHT * (b - a).norm() {
                self.tags.insert(nodes[middle]);
                self.largest = self.largest.max(offset);
            }
        }
    }
    /// Number of the nodes.
    pub(crate) fn count(&self) -> usize {
        self.tags.len()
    }
    /// Largest distance of one from its midpoint (m).
    pub(crate) fn largest(&self) -> f64 {
        self.largest
    }
}
