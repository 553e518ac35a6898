//! Checks of element shapes and connectivity.

use std::cmp::Reverse;
use std::collections::HashMap;

use super::{ElementKind, Mesh, MeshError};
use crate::Vec3;

/// Quality measures of the elements of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct QualityReport {
    /// Least scaled Jacobian (determinant over the product of edge lengths) at any corner: 1 for a box, at most 0.87 in a
    /// wedge and 0.71 in a tetrahedron or pyramid of equal edges; infinite if there are only bars.
    pub least_scaled_jacobian: f64,
    /// The user's number of the element with the least scaled Jacobian; zero if there are only bars.
    pub worst_element: u64,
    /// Length of the shortest edge of any element (m).
    pub shortest_edge: f64,
    /// Length of the longest edge of any element (m).
    pub longest_edge: f64,
    /// Largest aspect ratio: longest over shortest edge of one element.
    pub largest_aspect: f64,
    /// Number of connected components of the mesh, which share no nodes.
    pub parts: usize,
}

impl Mesh {
    /// Distance of a node from the midpoint of its edge, over the length of the edge, up to which the edge counts as straight.
    pub const STRAIGHT: f64 = 1e-6;

    /// Checks the mesh for positive Jacobians at all corners and for nodes without elements.
    ///
    /// # Errors
    /// The first fault found, with the user's numbers.
    pub fn check(&self) -> Result<QualityReport, MeshError> {
        Ok(self.shapes_and_parts()?.0)
    }

    /// Checks the mesh as [`check`](Self::check), and that it has one connected component.
    ///
    /// # Errors
    /// As `check`, and [`MeshError::Disconnected`].
    pub fn check_connected(&self) -> Result<QualityReport, MeshError> {
        let (report, element) = self.shapes_and_parts()?;
        if report.parts > 1 {
            return Err(MeshError::Disconnected {
                parts: report.parts,
                element: self.element_tags[element as usize],
            });
        }
        Ok(report)
    }

    /// The report, and an element of the second largest connected component.
    fn shapes_and_parts(&self) -> Result<(QualityReport, u32), MeshError> {
        let mut report = QualityReport {
            least_scaled_jacobian: f64::INFINITY,
            worst_element: 0,
            shortest_edge: f64::INFINITY,
            longest_edge: 0.0,
            largest_aspect: 0.0,
            parts: 0,
        };
        let mut used = vec![false; self.node_count()];
        for element in 0..self.element_count() as u32 {
            for &node in self.nodes_of(element) {
                used[node as usize] = true;
            }
            self.check_shape(element, &mut report)?;
        }
        self.check_shared_nodes()?;
        let orphans = used.iter().filter(|used| !**used).count();
        if let Some(node) = used.iter().position(|used| !used) {
            return Err(MeshError::OrphanNode {
                node: self.node_tags[node],
                count: orphans,
            });
        }
        let (parts, element) = self.parts();
        report.parts = parts;
        Ok((report, element))
    }

    fn check_shape(&self, element: u32, report: &mut QualityReport) -> Result<(), MeshError> {
        let tag = self.element_tags[element as usize];
        let nodes = self.nodes_of(element);
        let at = |i: u8| self.positions[nodes[i as usize] as usize];
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        if self.kind(element) == ElementKind::Bar2 {
            shortest = (at(1) - at(0)).norm();
            longest = shortest;
            if shortest == 0.0 {
                return Err(MeshError::NoLength { element: tag });
            }
        }
        self.check_edges(element)?;
        for corner in self.kind(element).corners() {
            let edges: [Vec3; 3] = core::array::from_fn(|i| at(corner[i + 1]) - at(corner[0]));
            let lengths = edges.map(|edge| edge.norm());
            for length in lengths {
                shortest = shortest.min(length);
                longest = longest.max(length);
            }
            let scaled =
                edges[0].cross(&edges[1]).dot(&edges[2]) / (lengths[0] * lengths[1] * lengths[2]);
            // NaN (an edge without length) counts as a fault too.
            if scaled.is_nan() || scaled <= 1e-9 {
                return Err(MeshError::Inverted {
                    element: tag,
                    node: self.node_tags[nodes[corner[0] as usize] as usize],
                    scaled_jacobian: scaled,
                });
            }
            if scaled < report.least_scaled_jacobian {
                report.least_scaled_jacobian = scaled;
                report.worst_element = tag;
            }
        }
        report.shortest_edge = report.shortest_edge.min(shortest);
        report.longest_edge = report.longest_edge.max(longest);
        report.largest_aspect = report.largest_aspect.max(longest / shortest);
        Ok(())
    }

    /// Checks that nodes between the corners of an element are at the midpoints of its edges, within a millionth of the
    /// length of the edge.
    ///
    /// # Errors
    /// [`MeshError::CurvedEdge`].
    ///
    /// # Panics
    /// If the element does not belong to this mesh.
    pub fn check_edges(&self, element: u32) -> Result<(), MeshError> {
        let kind = self.kind(element);
        let nodes = self.nodes_of(element);
        let at = |i: usize| self.positions[nodes[i] as usize];
        let first = kind.first_order().node_count();
        for (i, ends) in kind.edges_with_midpoint().iter().enumerate() {
            let [a, b] = ends.map(|end| at(end.into()));
            let offset = (at(first + i) - (a + b) * 0.5).norm();
            if offset > Self::STRAIGHT * (b - a).norm() {
                return Err(MeshError::CurvedEdge {
                    element: self.element_tags[element as usize],
                    kind: kind.name(),
                    node: self.node_tags[nodes[first + i] as usize],
                    offset,
                });
            }
        }
        Ok(())
    }

    /// Checks that elements with nodes on their edges share nodes with solids of their kind alone.
    pub(super) fn check_shared_nodes(&self) -> Result<(), MeshError> {
        let has_midpoints = |element: &u32| !self.kind(*element).edges_with_midpoint().is_empty();
        let all = 0..self.element_count() as u32;
        let mut owner = vec![u32::MAX; self.node_count()];
        let mut found = false;
        for element in all.clone().filter(has_midpoints) {
            found = true;
            for &node in self.nodes_of(element) {
                owner[node as usize] = element;
            }
        }
        if !found {
            return Ok(());
        }
        for other in all.filter(|element| self.kind(*element).is_solid()) {
            for &node in self.nodes_of(other) {
                let element = owner[node as usize];
                if element != u32::MAX && self.kind(element) != self.kind(other) {
                    let tag = |element: u32| self.element_tags[element as usize];
                    return Err(MeshError::SidesDoNotFit {
                        element: tag(element),
                        kind: self.kind(element).name(),
                        other: tag(other),
                        other_kind: self.kind(other).name(),
                        node: self.node_tags[node as usize],
                    });
                }
            }
        }
        Ok(())
    }

    /// Number of connected components, and an element of the second largest one.
    fn parts(&self) -> (usize, u32) {
        let mut parent: Vec<u32> = (0..self.node_count() as u32).collect();
        fn root(parent: &mut [u32], mut node: u32) -> u32 {
            while parent[node as usize] != node {
                parent[node as usize] = parent[parent[node as usize] as usize];
                node = parent[node as usize];
            }
            node
        }
        for element in 0..self.element_count() as u32 {
            let nodes = self.nodes_of(element);
            let first = root(&mut parent, nodes[0]);
            for &node in &nodes[1..] {
                let other = root(&mut parent, node);
                parent[other as usize] = first;
            }
        }
        let mut parts: HashMap<u32, (usize, u32)> = HashMap::new();
        for element in 0..self.element_count() as u32 {
            let part = root(&mut parent, self.nodes_of(element)[0]);
            parts.entry(part).or_insert((0, element)).0 += 1;
        }
        let mut sizes: Vec<(usize, u32)> = parts.into_values().collect();
        // Of components of equal size the one with the first element counts as the largest.
        sizes.sort_unstable_by_key(|&(size, element)| (Reverse(size), element));
        (sizes.len(), sizes.get(1).map_or(0, |part| part.1))
    }
}
