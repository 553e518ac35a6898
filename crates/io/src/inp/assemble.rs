//! Conversion of the content of a file into a mesh with its sets.

use powerhouse_model::{Facet, Mesh, MeshError};

use super::blocks::{RawElement, RawMesh};
use super::error::{InpFault, Located};
use super::report::InpReport;
use super::sets::{self, AllSets, Set};
use super::shape::Shape;
use crate::MeshOptions;
use crate::degenerate::collapsed;
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
    mut raw: RawMesh,
    options: MeshOptions<'_>,
) -> Result<(Mesh, InpReport), Located> {
    collapse(&mut raw, options.first_order);
    let raw = &raw;
    let found = found_nodes(raw)?;
    let curved = curved(raw);
    let sets = sets::read(bytes, raw)?;
    let places = places(raw);
    let (mut mesh, index) = build(raw, found, &sets, options)?;
    let at_start = |error: MeshError| Located::new("", 0, error);
    let (ungrouped_elements, has_element_sets) =
        element_sets(&mut mesh, raw, &sets, &places).map_err(at_start)?;
    let empty_sets = other_sets(&mut mesh, raw, sets, &index, &places).map_err(at_start)?;
    let mesh = if options.straighten {
        mesh.with_straight_edges()
    } else {
        mesh
    };
    let quality = mesh.check().map_err(|error| locate(raw, error))?;
    let second_order = |e: &&RawElement| !e.shape.edges.is_empty();
    let elements = &raw.elements.elements;
    let counts = &raw.counts;
    let report = InpReport {
        nodes: raw.nodes.tags.len(),
        elements: elements.len(),
        facet_elements: elements.len() - mesh.element_count(),
        has_element_sets,
        ungrouped_elements,
        dropped_nodes: raw.nodes.tags.len() - mesh.node_count(),
        lowered_elements: if options.first_order {
            elements.iter().filter(second_order).count()
        } else {
            0
        },
        curved_nodes: curved.count(),
        largest_curve: curved.largest(),
        collapsed_elements: raw.elements.collapsed.len(),
        coupled_elements: counts.coupled,
        omitted_coordinates: counts.omitted,
        left_out: counts
            .left_out
            .iter()
            .map(|(name, count)| (name.clone(), *count))
            .collect(),
        instances: match &raw.instances[..] {
            [] | [_] => Vec::new(),
            instances => {
                let shifts = instances
                    .iter()
                    .map(|own| (own.name.text.clone(), own.shift));
                shifts.collect()
            }
        },
        empty_sets,
        skipped_keywords: counts.skipped.iter().cloned().collect(),
        quality,
    };
    Ok((mesh, report))
}

/// Makes wedges, pyramids and tetrahedra of solids with repeated corners.
fn collapse(raw: &mut RawMesh, first_order: bool) {
    let elements = &mut raw.elements;
    for (element, index) in elements.elements.iter_mut().zip(0..) {
        let corners = element.shape.corners();
        let nodes = &mut elements.nodes[element.first..][..corners];
        if (1..corners).all(|at| !nodes[..at].contains(&nodes[at])) {
            continue;
        }
        let Some(kind) = element
            .shape
            .kind(first_order)
            .filter(|kind| kind.node_count() == corners)
        else {
            continue;
        };
        let found = collapsed(kind, nodes).and_then(|own| Some((own, Shape::of_kind(own.kind)?)));
        if let Some((own, shape)) = found {
            let mut was = [0; 8];
            was[..corners].copy_from_slice(nodes);
            nodes[..own.nodes().len()].copy_from_slice(own.nodes());
            element.shape = shape;
            elements.collapsed.insert(index, (own, kind, was));
        }
    }
}

/// Index in the file of each node of the elements, at its place in their list; an error for nodes that do not exist or
/// occur twice.
fn found_nodes(raw: &RawMesh) -> Result<Vec<u32>, Located> {
    let mut found = vec![UNUSED; raw.elements.nodes.len()];
    for raw_element in &raw.elements.elements {
        let nodes = raw.elements.nodes_of(raw_element);
        let element = raw_element.tag;
        let fault = |fault: MeshError| Located::new("*ELEMENT", raw_element.offset, fault);
        for (local, &node) in nodes.iter().enumerate() {
            let index = raw.nodes.index.get(&node);
            let index = index.ok_or_else(|| fault(MeshError::DanglingNode { element, node }))?;
            found[raw_element.first + local] = *index;
            if nodes[..local].contains(&node) && !raw_element.shape.is_facet() {
                return Err(fault(MeshError::RepeatedNode { element, node }));
            }
        }
    }
    Ok(found)
}

/// Finds curved edges.
fn curved(raw: &RawMesh) -> CurvedNodes {
    let mut curved = CurvedNodes::default();
    let position = |node: u64| raw.nodes.positions[raw.nodes.index[&node] as usize];
    for element in &raw.elements.elements {
        let edges = (element.shape.corners(), element.shape.edges);
        curved.add(raw.elements.nodes_of(element), edges, position);
    }
    curved
}

/// Index in the mesh of each element of the file, [`UNUSED`] of a facet; none if all are elements of the mesh.
fn places(raw: &RawMesh) -> Option<Vec<u32>> {
    let elements = &raw.elements.elements;
    if !elements.iter().any(|element| element.shape.is_facet()) {
        return None;
    }
    let mut next = 0..;
    let place = |element: &RawElement| {
        if element.shape.is_facet() {
            UNUSED
        } else {
            next.next().unwrap_or(UNUSED)
        }
    };
    Some(elements.iter().map(place).collect())
}

/// Index in the mesh of an element of the file, if it is one there.
fn place(places: &Option<Vec<u32>>, element: u32) -> Option<u32> {
    let found = places
        .as_ref()
        .map_or(element, |places| places[element as usize]);
    (found != UNUSED).then_some(found)
}

/// The mesh with the facet sets of shells alone, and the index in it of each node of the file.
fn build(
    raw: &RawMesh,
    found: Vec<u32>,
    sets: &AllSets,
    options: MeshOptions<'_>,
) -> Result<(Mesh, Vec<u32>), Located> {
    let mut index = vec![UNUSED; raw.nodes.tags.len()];
    let mut builder = Mesh::builder();
    let no_sets: [&str; 0] = [];
    let (mut nodes, mut used) = (Vec::new(), Vec::new());
    for element in &raw.elements.elements {
        let Some(kind) = element.shape.kind(options.first_order) else {
            continue;
        };
        nodes.clear();
        let own = raw.elements.nodes_of(element);
        element
            .shape
            .in_mesh_order(own, options.first_order, &mut nodes);
        used.clear();
        let own = &found[element.first..][..own.len()];
        element
            .shape
            .in_mesh_order(own, options.first_order, &mut used);
        used.iter().for_each(|&node| index[node as usize] = 0);
        builder.element(element.tag, kind, &nodes, &no_sets);
    }
    drop(found);
    for set in &sets.elements.list {
        for &member in &set.members {
            let element = &raw.elements.elements[member as usize];
            if element.shape.is_facet() {
                builder.facet(&set.name, &facet_nodes(raw, element, options.first_order));
            }
        }
    }
    for set in &sets.faces.list {
        for facet in &set.members {
            let element = &raw.elements.elements[facet.element as usize];
            if element.shape.is_facet() {
                builder.facet(&set.name, &facet_nodes(raw, element, options.first_order));
            }
        }
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

/// Nodes of a shell or plane element, each once.
fn facet_nodes(raw: &RawMesh, element: &RawElement, first_order: bool) -> Vec<u64> {
    let nodes = raw.elements.nodes_of(element);
    let count = if first_order {
        element.shape.corners()
    } else {
        nodes.len()
    };
    let mut own: Vec<u64> = Vec::with_capacity(count);
    for node in &nodes[..count] {
        if !own.contains(node) {
            own.push(*node);
        }
    }
    own
}

/// Gives the mesh its element sets; returns the number of elements in no set that is not internal, and whether there are others.
fn element_sets(
    mesh: &mut Mesh,
    raw: &RawMesh,
    sets: &AllSets,
    places: &Option<Vec<u32>>,
) -> Result<(usize, bool), MeshError> {
    let mut grouped = vec![false; mesh.element_count()];
    let own = |members: &[u32]| -> Vec<u32> {
        members
            .iter()
            .filter_map(|&element| place(places, element))
            .collect()
    };
    for set in &sets.elements.list {
        let members = own(&set.members);
        for &element in &members {
            grouped[element as usize] |= !set.internal;
        }
        if !members.is_empty() {
            mesh.set_element_set(&set.name, members)?;
        }
    }
    // Of several instances each is a set of its name, unless the file has another one.
    if raw.instances.len() > 1 {
        for instance in &raw.instances {
            let members = own(&instance.elements.clone().collect::<Vec<u32>>());
            let name = &instance.name.text;
            if members.is_empty() || mesh.element_set(name).is_ok() {
                continue;
            }
            members
                .iter()
                .for_each(|&element| grouped[element as usize] = true);
            mesh.set_element_set(name, members)?;
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
fn other_sets(
    mesh: &mut Mesh,
    raw: &RawMesh,
    sets: AllSets,
    index: &[u32],
    places: &Option<Vec<u32>>,
) -> Result<Vec<String>, MeshError> {
    let mut empty: Vec<String> = Vec::new();
    fn name_if_empty<T>(set: &Set<T>) -> Option<String> {
        set.members.is_empty().then(|| set.name.clone())
    }
    empty.extend(sets.elements.list.iter().filter_map(name_if_empty));
    for set in sets.nodes.list {
        let nodes = set.members.iter().map(|&node| index[node as usize]);
        let nodes: Vec<u32> = nodes.filter(|&node| node != UNUSED).collect();
        if nodes.is_empty() {
            empty.push(set.name)
        } else {
            mesh.set_node_set(&set.name, nodes)?
        }
    }
    for set in sets.faces.list {
        if set.members.is_empty() {
            empty.push(set.name);
            continue;
        }
        // Those of shells are in the mesh.
        let of_solid = |facet: Facet| {
            let is_facet = raw.elements.elements[facet.element as usize]
                .shape
                .is_facet();
            let element = place(places, facet.element).filter(|_| !is_facet)?;
            Some(Facet { element, ..facet })
        };
        let mut facets: Vec<Facet> = set.members.into_iter().filter_map(of_solid).collect();
        if let Ok(own) = mesh.facet_set(&set.name) {
            facets.extend_from_slice(own);
        }
        mesh.set_facet_set(&set.name, facets)?;
    }
    Ok(empty)
}

/// Adds the position in the file to an error of the mesh.
fn locate(raw: &RawMesh, error: MeshError) -> Located {
    if let MeshError::FacetWithoutElement { nodes, .. } = &error {
        let mut facets = raw
            .elements
            .elements
            .iter()
            .filter(|element| element.shape.is_facet());
        let own = |element: &&RawElement| {
            let own = raw.elements.nodes_of(element);
            nodes.iter().all(|node| own.contains(node))
        };
        if let Some(element) = facets.find(own) {
            let name = element.shape.name;
            let fault = InpFault::Shell {
                element: element.tag,
                name,
            };
            return Located::new("*ELEMENT", element.offset, fault);
        }
    }
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
