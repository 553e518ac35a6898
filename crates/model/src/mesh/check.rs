//! Checks of numbers, ranges and shapes.

use std::collections::HashMap;

use super::{ElementKind, Facet, Mesh, MeshBuilder, MeshError};
use crate::Vec3;

/// Shapes of a mesh's solid elements.
#[derive(Clone, Debug, PartialEq)]
pub struct QualityReport {
    /// Least scaled Jacobian at any corner, 1 for a box.
    pub least_scaled_jacobian: f64,
    /// The user's number of the element that has it.
    pub worst_element: u64,
    /// Shortest edge (m).
    pub shortest_edge: f64,
    /// Longest edge (m).
    pub longest_edge: f64,
    /// Largest ratio of longest to shortest edge in one element.
    pub largest_aspect: f64,
    /// Parts of the mesh that share no nodes.
    pub parts: usize,
}

pub(super) fn build(builder: MeshBuilder) -> Result<Mesh, MeshError> {
    let mut index_of = HashMap::with_capacity(builder.nodes.len());
    let mut mesh = Mesh::default();
    for (what, count) in [
        ("nodes", builder.nodes.len()),
        ("elements", builder.elements.len()),
    ] {
        if count >= u32::MAX as usize {
            return Err(MeshError::TooLarge { what, count });
        }
    }
    for (index, &(tag, position)) in builder.nodes.iter().enumerate() {
        if index_of.insert(tag, index as u32).is_some() {
            return Err(MeshError::DuplicateNode { node: tag });
        }
        for (axis, value) in ['x', 'y', 'z'].into_iter().zip(position.iter()) {
            if !value.is_finite() {
                return Err(MeshError::CoordinateNotFinite {
                    node: tag,
                    axis,
                    value: *value,
                });
            }
        }
        mesh.node_tags.push(tag);
        mesh.positions.push(position);
    }
    elements(&builder, &index_of, &mut mesh)?;
    for (name, tags) in &builder.node_sets {
        let mut nodes = Vec::with_capacity(tags.len());
        for tag in tags {
            let node = index_of.get(tag).ok_or_else(|| MeshError::SetOutOfRange {
                what: "node",
                name: name.clone(),
                index: *tag as u32,
            })?;
            nodes.push(*node);
        }
        mesh.set_node_set(name, nodes)?;
    }
    for (name, indices) in builder.element_sets {
        mesh.set_element_set(&name, indices)?;
    }
    facets(&builder.facet_sets, &index_of, &mut mesh)?;
    Ok(mesh)
}

fn elements(
    builder: &MeshBuilder,
    index_of: &HashMap<u64, u32>,
    mesh: &mut Mesh,
) -> Result<(), MeshError> {
    if builder.elements.is_empty() {
        return Err(MeshError::Empty);
    }
    let mut seen = HashMap::with_capacity(builder.elements.len());
    let mut same_nodes: HashMap<Vec<u32>, u64> = HashMap::with_capacity(builder.elements.len());
    let mut start = 0;
    mesh.offsets.push(0);
    for &(tag, kind, count) in &builder.elements {
        let corners = &builder.corners[start..start + count as usize];
        start += count as usize;
        if seen.insert(tag, ()).is_some() {
            return Err(MeshError::DuplicateElement { element: tag });
        }
        if corners.len() != kind.node_count() {
            return Err(MeshError::NodeCount {
                element: tag,
                kind: kind.name(),
                found: corners.len(),
                expected: kind.node_count(),
            });
        }
        let first = mesh.connectivity.len();
        for node in corners {
            let index = index_of.get(node).ok_or(MeshError::DanglingNode {
                element: tag,
                node: *node,
            })?;
            if mesh.connectivity[first..].contains(index) {
                return Err(MeshError::RepeatedNode {
                    element: tag,
                    node: *node,
                });
            }
            mesh.connectivity.push(*index);
        }
        let mut key = mesh.connectivity[first..].to_vec();
        key.sort_unstable();
        if let Some(other) = same_nodes.insert(key, tag) {
            return Err(MeshError::CoincidentElements {
                first: other,
                second: tag,
            });
        }
        mesh.kinds.push(kind);
        mesh.element_tags.push(tag);
        mesh.offsets.push(mesh.connectivity.len() as u32);
    }
    Ok(())
}

fn facets(
    sets: &std::collections::BTreeMap<String, Vec<Vec<u64>>>,
    index_of: &HashMap<u64, u32>,
    mesh: &mut Mesh,
) -> Result<(), MeshError> {
    if sets.is_empty() {
        return Ok(());
    }
    let sides = mesh.sides_by_nodes();
    for (name, list) in sets {
        let mut resolved = Vec::with_capacity(list.len());
        for tags in list {
            let lost = || MeshError::FacetWithoutElement {
                name: name.clone(),
                nodes: tags.clone(),
            };
            let mut key = Vec::with_capacity(tags.len());
            for tag in tags {
                key.push(*index_of.get(tag).ok_or_else(lost)?);
            }
            key.sort_unstable();
            resolved.extend_from_slice(sides.get(&key).ok_or_else(lost)?);
        }
        mesh.set_facet_set(name, resolved)?;
    }
    Ok(())
}

impl Mesh {
    /// Every side of every solid element by its sorted nodes; two facets share an interior side.
    pub fn sides_by_nodes(&self) -> HashMap<Vec<u32>, Vec<Facet>> {
        let mut sides: HashMap<Vec<u32>, Vec<Facet>> = HashMap::new();
        for element in 0..self.element_count() as u32 {
            let nodes = self.nodes_of(element);
            for (side, corners) in self.kind(element).sides().iter().enumerate() {
                let mut key: Vec<u32> = corners.iter().map(|&i| nodes[i as usize]).collect();
                key.sort_unstable();
                sides.entry(key).or_default().push(Facet {
                    element,
                    side: side as u8,
                });
            }
        }
        sides
    }

    /// Checks shapes and connections: positive Jacobians at all corners, no orphan nodes.
    ///
    /// # Errors
    /// The first fault found, with the user's numbers.
    pub fn check(&self) -> Result<QualityReport, MeshError> {
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
        let orphans = used.iter().filter(|used| !**used).count();
        if let Some(node) = used.iter().position(|used| !used) {
            return Err(MeshError::OrphanNode {
                node: self.node_tags[node],
                count: orphans,
            });
        }
        report.parts = self.parts().0;
        Ok(report)
    }

    /// The same as [`check`](Self::check), and the mesh must hang together.
    ///
    /// # Errors
    /// As `check`, and [`MeshError::Disconnected`].
    pub fn check_connected(&self) -> Result<QualityReport, MeshError> {
        let report = self.check()?;
        let (parts, element) = self.parts();
        if parts > 1 {
            return Err(MeshError::Disconnected {
                parts,
                element: self.element_tags[element as usize],
            });
        }
        Ok(report)
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
        for corner in self.kind(element).corners() {
            let edges: [Vec3; 3] = core::array::from_fn(|i| at(corner[i + 1]) - at(corner[0]));
            let lengths = edges.map(|edge| edge.norm());
            for length in lengths {
                shortest = shortest.min(length);
                longest = longest.max(length);
            }
            let scaled =
                edges[0].cross(&edges[1]).dot(&edges[2]) / (lengths[0] * lengths[1] * lengths[2]);
            // A NaN (an edge without length) is a fault too.
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

    /// Number of parts, and an element of the second largest one.
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
        sizes.sort_unstable_by(|a, b| b.cmp(a));
        (sizes.len(), sizes.get(1).map_or(0, |part| part.1))
    }
}
