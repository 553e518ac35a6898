//! Conversion of the content of a file into a mesh with its sets.

use powerhouse_model::{Mesh, MeshError};

use super::blocks::RawMesh;
use super::error::{InpFault, Located};
use super::report::InpReport;
use super::sets::{self, AllSets, Set};
use crate::MeshOptions;
use crate::second_order::CurvedNodes;

/// Name of the set of all elements, if none of the file belongs to a set.
const ALL: &str = "all";
/// Name of the set of the elements that belong to no set, if others do.
const UNGROUPED: &str = "ungrouped";

/// Index of a node that no element uses.
const UNUSED: u32 = u32::MAX;

/// Builds the mesh and checks the shapes of its elements.
pub(super) fn assemble(
    bytes: &[u8],
    raw: &RawMesh,
    options: MeshOptions<'_>,
) -> Result<(Mesh, InpReport), Located> {
    check_nodes(raw)?;
    let curved = curved(raw);
    let sets = sets::read(bytes, raw)?;
    let (mut mesh, index) = build(raw, options)?;
    let at_start = |error: MeshError| Located::new("", 0, error);
    let (ungrouped_elements, has_element_sets) =
        element_sets(&mut mesh, &sets).map_err(at_start)?;
    let empty_sets = other_sets(&mut mesh, sets, &index).map_err(at_start)?;
    let mesh = match options.straighten {
        true => mesh.with_straight_edges(),
        false => mesh,
    };
    let quality = mesh.check().map_err(|error| locate(raw, error))?;
    let second_order = |e: &&super::blocks::RawElement| !e.shape.edges.is_empty();
    let elements = &raw.elements.elements;
    let report = InpReport {
        nodes: raw.nodes.tags.len(),
        elements: elements.len(),
        has_element_sets,
        ungrouped_elements,
        dropped_nodes: raw.nodes.tags.len() - mesh.node_count(),
        lowered_elements: match options.first_order {
            true => elements.iter().filter(second_order).count(),
            false => 0,
        },
        curved_nodes: curved.count(),
        largest_curve: curved.largest(),
        empty_sets,
        skipped_keywords: raw.skipped.iter().cloned().collect(),
        quality,
    };
    Ok((mesh, report))
}

/// Refuses elements with nodes that do not exist or occur twice.
fn check_nodes(raw: &RawMesh) -> Result<(), Located> {
    for raw_element in &raw.elements.elements {
        let nodes = raw.elements.nodes_of(raw_element);
        let element = raw_element.tag;
        let fault = |fault: MeshError| Located::new("*ELEMENT", raw_element.offset, fault);
        for (local, &node) in nodes.iter().enumerate() {
            if !raw.nodes.index.contains_key(&node) {
                return Err(fault(MeshError::DanglingNode { element, node }));
            }
            if nodes[..local].contains(&node) {
                return Err(fault(MeshError::RepeatedNode { element, node }));
            }
        }
    }
    Ok(())
}

/// Finds curved edges.
fn curved(raw: &RawMesh) -> CurvedNodes {
    let mut curved = CurvedNodes::default();
    let position = |node: u64| raw.nodes.positions[raw.nodes.index[&node] as usize];
    for element in &raw.elements.elements {
        let corners = element.shape.corners.node_count();
        let edges = (corners, element.shape.edges);
        curved.add(raw.elements.nodes_of(element), edges, position);
    }
    curved
}

/// The mesh without sets, and the index in it of each node of the file.
fn build(raw: &RawMesh, options: MeshOptions<'_>) -> Result<(Mesh, Vec<u32>), Located> {
    let mut index = vec![UNUSED; raw.nodes.tags.len()];
    let mut builder = Mesh::builder();
    let no_sets: [&str; 0] = [];
    for element in &raw.elements.elements {
        let nodes = raw.elements.nodes_of(element);
        let nodes = element.shape.in_mesh_order(nodes, options.first_order);
        for node in &nodes {
            index[raw.nodes.index[node] as usize] = 0;
        }
        let kind = element.shape.kind(options.first_order);
        builder.element(element.tag, kind, &nodes, &no_sets);
    }
    let nodes = raw.nodes.tags.iter().zip(&raw.nodes.positions);
    let used = index.iter_mut().zip(nodes);
    for (next, (own, (&tag, &position))) in used.filter(|(own, _)| **own != UNUSED).enumerate() {
        *own = next as u32;
        builder.node(tag, position);
    }
    let mesh = builder.build().map_err(|error| locate(raw, error))?;
    Ok((mesh, index))
}

/// Gives the mesh its element sets; returns the number of elements in no set that is not internal, and whether there are others.
fn element_sets(mesh: &mut Mesh, sets: &AllSets) -> Result<(usize, bool), MeshError> {
    let mut grouped = vec![false; mesh.element_count()];
    for set in &sets.elements.list {
        for &element in &set.members {
            grouped[element as usize] |= !set.internal;
        }
        if !set.members.is_empty() {
            mesh.set_element_set(&set.name, set.members.clone())?;
        }
    }
    let ungrouped = (0..mesh.element_count() as u32).filter(|&e| !grouped[e as usize]);
    let ungrouped: Vec<u32> = ungrouped.collect();
    let count = ungrouped.len();
    let any = grouped.contains(&true);
    if count > 0 {
        let name = if any { UNGROUPED } else { ALL };
        let own = mesh.element_set(name).map(<[u32]>::to_vec);
        let mut elements = own.unwrap_or_default();
        elements.extend(ungrouped);
        mesh.set_element_set(name, elements)?;
    }
    Ok((count, any))
}

/// Gives the mesh its node and facet sets; returns the names of all sets without a member.
fn other_sets(mesh: &mut Mesh, sets: AllSets, index: &[u32]) -> Result<Vec<String>, MeshError> {
    let mut empty: Vec<String> = Vec::new();
    fn name_if_empty<T>(set: &Set<T>) -> Option<String> {
        set.members.is_empty().then(|| set.name.clone())
    }
    empty.extend(sets.elements.list.iter().filter_map(name_if_empty));
    for set in sets.nodes.list {
        let nodes = set.members.iter().map(|&node| index[node as usize]);
        let nodes: Vec<u32> = nodes.filter(|&node| node != UNUSED).collect();
        match nodes.is_empty() {
            true => empty.push(set.name),
            false => mesh.set_node_set(&set.name, nodes)?,
        }
    }
    for set in sets.faces.list {
        match set.members.is_empty() {
            true => empty.push(set.name),
            false => mesh.set_facet_set(&set.name, set.members)?,
        }
    }
    Ok(empty)
}

/// Adds the position in the file to an error of the mesh.
fn locate(raw: &RawMesh, error: MeshError) -> Located {
    let element = match &error {
        MeshError::CoincidentElements { second: tag, .. }
        | MeshError::Inverted { element: tag, .. }
        | MeshError::CurvedEdge { element: tag, .. }
        | MeshError::SidesDoNotFit { element: tag, .. }
        | MeshError::NoLength { element: tag } => raw.elements.index.get(tag),
        _ => None,
    };
    let element = element.map(|&index| &raw.elements.elements[index as usize]);
    let offset = element.map_or(0, |element| element.offset);
    Located::new("*ELEMENT", offset, InpFault::from(error))
}
