//! Builder of meshes from the user's numbers, with validation.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};

use super::sides::SideTable;
use super::{ElementKind, Mesh, MeshError};
use crate::Vec3;

/// Builder of a [`Mesh`]: nodes, elements and sets by the user's numbers.
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
    /// Adds an element with its nodes by number, in Gmsh's order, to any number of element sets.
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
    /// Adds a facet, given by the numbers of its nodes in any order, to a facet set; it must be a side of
    /// an element.
    pub fn facet(&mut self, set: &str, nodes: &[u64]) -> &mut Self {
        self.facet_sets
            .entry(set.into())
            .or_default()
            .push(nodes.to_vec());
        self
    }
    /// Adds nodes, by the user's numbers, to a node set, which is made if there is none of this name.
    pub fn node_set(&mut self, set: &str, nodes: &[u64]) -> &mut Self {
        self.node_sets
            .entry(set.into())
            .or_default()
            .extend_from_slice(nodes);
        self
    }
    /// Validates numbers and ranges and builds the mesh; the shapes of elements are checked by
    /// [`Mesh::check`].
    ///
    /// # Errors
    /// The first fault found, with the user's numbers.
    pub fn build(self) -> Result<Mesh, MeshError> {
        resolve(self)
    }
}

fn resolve(builder: MeshBuilder) -> Result<Mesh, MeshError> {
    let mut index_of = HashMap::with_capacity(builder.nodes.len());
    let mut mesh = Mesh::default();
    for (what, count) in [
        ("nodes", builder.nodes.len()),
        ("elements", builder.elements.len()),
        ("element corners", builder.corners.len()),
    ] {
        if count >= u32::MAX as usize {
            return Err(MeshError::TooLarge { what, count });
        }
    }
    let MeshBuilder {
        nodes,
        elements,
        corners,
        element_sets,
        facet_sets,
        node_sets,
    } = builder;
    let mut node_tags = Vec::with_capacity(nodes.len());
    let mut positions = Vec::with_capacity(nodes.len());
    for (index, (tag, position)) in (0..).zip(nodes) {
        if index_of.insert(tag, index).is_some() {
            return Err(MeshError::DuplicateNode { node: tag });
        }
        check_position(tag, &position)?;
        node_tags.push(tag);
        positions.push(position);
    }
    (mesh.node_tags, mesh.positions) = (node_tags.into(), positions.into());
    put_elements((&elements, &corners), &index_of, &mut mesh)?;
    // A large mesh has little room beside it.
    drop((elements, corners));
    coincident_elements(&mesh)?;
    for (name, tags) in &node_sets {
        let mut nodes = Vec::with_capacity(tags.len());
        for tag in tags {
            let node = index_of.get(tag).ok_or_else(|| MeshError::SetOutOfRange {
                what: "node",
                name: name.clone(),
                number: *tag,
            })?;
            nodes.push(*node);
        }
        mesh.set_node_set(name, nodes)?;
    }
    for (name, indices) in element_sets {
        mesh.set_element_set(&name, indices)?;
    }
    facets(&facet_sets, &index_of, &mut mesh)?;
    Ok(mesh)
}

/// Refuses a position of a node that is not finite.
pub(super) fn check_position(node: u64, position: &Vec3) -> Result<(), MeshError> {
    for (axis, &value) in ['x', 'y', 'z'].into_iter().zip(position) {
        if !value.is_finite() {
            return Err(MeshError::CoordinateNotFinite { node, axis, value });
        }
    }
    Ok(())
}

/// Puts elements, with the numbers of the nodes of all of them, into a mesh.
fn put_elements(
    (elements, corners): (&[(u64, ElementKind, u32)], &[u64]),
    index_of: &HashMap<u64, u32>,
    mesh: &mut Mesh,
) -> Result<(), MeshError> {
    if elements.is_empty() {
        return Err(MeshError::Empty);
    }
    let mut seen = HashSet::with_capacity(elements.len());
    let mut offsets = Vec::with_capacity(elements.len() + 1);
    let mut connectivity = Vec::with_capacity(corners.len());
    let mut rest = corners;
    offsets.push(0);
    for &(tag, kind, count) in elements {
        let corners;
        (corners, rest) = rest.split_at(count as usize);
        if !seen.insert(tag) {
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
        let first = connectivity.len();
        for node in corners {
            let index = index_of.get(node).ok_or(MeshError::DanglingNode {
                element: tag,
                node: *node,
            })?;
            if connectivity[first..].contains(index) {
                return Err(MeshError::RepeatedNode {
                    element: tag,
                    node: *node,
                });
            }
            connectivity.push(*index);
        }
        offsets.push(connectivity.len() as u32);
    }
    mesh.kinds = elements.iter().map(|&(_, kind, _)| kind).collect();
    mesh.element_tags = elements.iter().map(|&(tag, ..)| tag).collect();
    (mesh.offsets, mesh.connectivity) = (offsets.into(), connectivity.into());
    Ok(())
}

/// Refuses two elements with the same nodes, found by the hash of their sorted nodes.
fn coincident_elements(mesh: &Mesh) -> Result<(), MeshError> {
    let sorted = |element: u32| {
        let mut nodes = mesh.nodes_of(element).to_vec();
        nodes.sort_unstable();
        nodes
    };
    let state = BuildHasherDefault::<DefaultHasher>::default();
    let mut hashes: Vec<(u64, u32)> = (0..mesh.element_count() as u32)
        .map(|element| (state.hash_one(sorted(element)), element))
        .collect();
    hashes.sort_unstable();
    for run in hashes
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|run| run.len() > 1)
    {
        let mut nodes: Vec<(Vec<u32>, u32)> = run.iter().map(|e| (sorted(e.1), e.1)).collect();
        nodes.sort_unstable();
        if let Some(pair) = nodes.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(MeshError::CoincidentElements {
                first: mesh.element_tags[pair[0].1 as usize],
                second: mesh.element_tags[pair[1].1 as usize],
            });
        }
    }
    Ok(())
}

fn facets(
    sets: &BTreeMap<String, Vec<Vec<u64>>>,
    index_of: &HashMap<u64, u32>,
    mesh: &mut Mesh,
) -> Result<(), MeshError> {
    if sets.is_empty() {
        return Ok(());
    }
    let mut is_on_facet = vec![false; mesh.node_count()];
    for tag in sets.values().flatten().flatten() {
        if let Some(&node) = index_of.get(tag) {
            is_on_facet[node as usize] = true;
        }
    }
    let sides = SideTable::with_all_nodes(mesh, |node| is_on_facet[node as usize]);
    for (name, list) in sets {
        let mut resolved = Vec::with_capacity(list.len());
        for tags in list {
            let lost = || MeshError::FacetWithoutElement {
                name: name.clone(),
                nodes: tags.clone(),
            };
            let mut nodes = Vec::with_capacity(tags.len());
            for tag in tags {
                nodes.push(*index_of.get(tag).ok_or_else(lost)?);
            }
            let found = sides.with_nodes(mesh, &nodes);
            if found.is_empty() {
                return Err(lost());
            }
            resolved.extend_from_slice(found);
        }
        mesh.set_facet_set(name, resolved)?;
    }
    Ok(())
}
