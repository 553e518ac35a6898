//! Partition of element sets into blocks, and numbering of nodes so that each block owns a contiguous range.

use powerhouse_model::{EngineError, Mesh, Numbering, Vec3};

use crate::numbering::{Incidence, reverse_cuthill_mckee};

/// A part of the partition: the elements and nodes of one block.
pub(crate) struct Part {
    /// Index of the element set.
    pub(crate) set: usize,
    /// Mesh indices of its elements in the order of computation.
    pub(crate) elements: Vec<u32>,
    /// Engine numbers of its nodes: owned ones first, rising, then the others, rising.
    pub(crate) nodes: Vec<u32>,
}

/// Node numbering and partition of a mesh into blocks.
pub(crate) struct Partition {
    pub(crate) numbering: Numbering,
    pub(crate) parts: Vec<Part>,
    /// Engine numbers of nodes whose elements are all absent.
    pub(crate) orphans: Vec<u32>,
}

/// Divides element sets into parts of at most `size` elements, and numbers the nodes.
///
/// A set is bisected across its longest extent until its parts are small: compact parts share few
/// nodes with others, and each shared node costs a slot. Within a part, elements and nodes are in
/// reverse Cuthill-McKee order, so that the elements of a SIMD batch are neighbours. A node
/// is owned by the first part that has it, and nodes are numbered part by part, so a part owns
/// a contiguous range. Nodes whose elements are all absent belong to the last part. Nothing here depends
/// on the number of threads.
pub(crate) fn partition(
    mesh: &Mesh,
    labels: &[&str],
    sets: &[&[u32]],
    absent: &[bool],
    size: usize,
) -> Result<Partition, EngineError> {
    check_cover(mesh, labels, sets, absent)?;
    let order = reverse_cuthill_mckee(mesh, &Incidence::of(mesh));
    let mut rank = vec![0u32; order.len()];
    for (i, &node) in order.iter().enumerate() {
        rank[node as usize] = i as u32;
    }
    let key = |element: u32| {
        let ranks = mesh.nodes_of(element).iter().map(|&n| rank[n as usize]);
        ranks.fold((u32::MAX, 0), |(low, high), r| (low.min(r), high.max(r)))
    };
    let mut parts: Vec<((u32, u32), Part)> = Vec::new();
    for (set, elements) in sets.iter().enumerate() {
        let mut sorted: Vec<SortedElement> = (elements.iter())
            .map(|&element| SortedElement {
                centroid: mesh.centroid(element),
                key: key(element),
                element,
            })
            .collect();
        bisect(&mut sorted, elements.len().div_ceil(size), &mut |part| {
            part.sort_unstable_by_key(|entry| (entry.key, entry.element));
            let elements = part.iter().map(|entry| entry.element).collect();
            let nodes = Vec::new();
            parts.push((
                part[0].key,
                Part {
                    set,
                    elements,
                    nodes,
                },
            ));
        });
    }
    parts.sort_by_key(|(first, part)| (*first, part.set));
    let mut parts: Vec<Part> = parts.into_iter().map(|(_, part)| part).collect();
    let (numbering, orphans) = number_by_owner(mesh, &rank, absent, &mut parts);
    Ok(Partition {
        numbering,
        parts,
        orphans,
    })
}

/// An element with its sort keys.
#[derive(Clone, Copy)]
struct SortedElement {
    centroid: Vec3,
    /// Least and greatest rank of its nodes.
    key: (u32, u32),
    element: u32,
}

/// Divides elements into nearly equal parts by recursive bisection across the longest extent.
fn bisect(
    elements: &mut [SortedElement],
    parts: usize,
    emit: &mut impl FnMut(&mut [SortedElement]),
) {
    if elements.is_empty() {
        return;
    }
    if parts <= 1 {
        emit(elements);
        return;
    }
    let first = elements[0].centroid;
    let (low, high) = elements.iter().fold((first, first), |(low, high), entry| {
        (low.inf(&entry.centroid), high.sup(&entry.centroid))
    });
    let axis = (high - low).imax();
    let half = parts / 2;
    let middle = elements.len() * half / parts;
    elements.select_nth_unstable_by(middle, |a, b| {
        let along = a.centroid[axis].total_cmp(&b.centroid[axis]);
        along
            .then(a.key.cmp(&b.key))
            .then(a.element.cmp(&b.element))
    });
    let (left, right) = elements.split_at_mut(middle);
    bisect(left, half, emit);
    bisect(right, parts - half, emit);
}

fn check_cover(
    mesh: &Mesh,
    labels: &[&str],
    sets: &[&[u32]],
    absent: &[bool],
) -> Result<(), EngineError> {
    const FREE: u32 = u32::MAX;
    if sets.iter().all(|set| set.is_empty()) {
        return Err(EngineError::NoElements);
    }
    let mut owner = vec![FREE; mesh.element_count()];
    for (set, elements) in sets.iter().enumerate() {
        for &element in *elements {
            let set_of = owner.get_mut(element as usize).ok_or_else(|| {
                powerhouse_model::MeshError::SetOutOfRange {
                    what: "element",
                    name: labels[set].into(),
                    number: u64::from(element),
                }
            })?;
            if *set_of != FREE {
                return Err(EngineError::ElementTwice {
                    element: mesh.element_tags()[element as usize],
                    first: labels[*set_of as usize].into(),
                    second: labels[set].into(),
                });
            }
            *set_of = set as u32;
        }
    }
    // Bars without a set are lines of the mesh, not a gap in the body.
    let left_out = |element: &u32| {
        let index = *element as usize;
        owner[index] == FREE && !absent[index] && mesh.kind(*element).is_solid()
    };
    let mut unassigned = (0..mesh.element_count() as u32).filter(left_out);
    match unassigned.next() {
        Some(first) => Err(EngineError::ElementUnassigned {
            element: mesh.element_tags()[first as usize],
            count: 1 + unassigned.count(),
        }),
        None => Ok(()),
    }
}

/// Node numbering, and engine numbers of orphan nodes (all their elements are absent).
fn number_by_owner(
    mesh: &Mesh,
    rank: &[u32],
    absent: &[bool],
    parts: &mut [Part],
) -> (Numbering, Vec<u32>) {
    const FREE: u32 = u32::MAX;
    let mut numbering = Numbering::new(
        vec![FREE; mesh.node_count()],
        Vec::with_capacity(mesh.node_count()),
    );
    for part in parts.iter_mut() {
        let mut touched: Vec<u32> = part
            .elements
            .iter()
            .flat_map(|&e| mesh.nodes_of(e).iter().copied())
            .collect();
        touched.sort_unstable_by_key(|&n| rank[n as usize]);
        touched.dedup();
        let mut borrowed = Vec::new();
        for node in touched {
            let engine = &mut numbering.engine_of[node as usize];
            if *engine == FREE {
                *engine = numbering.mesh_of.len() as u32;
                numbering.mesh_of.push(node);
                part.nodes.push(*engine);
            } else {
                borrowed.push(*engine);
            }
        }
        borrowed.sort_unstable();
        part.nodes.append(&mut borrowed);
    }
    // Nodes without elements come last; those that never had any are refused later for want of
    // mass.
    let mut had = vec![false; mesh.node_count()];
    for (element, _) in absent.iter().enumerate().filter(|(_, absent)| **absent) {
        for &node in mesh.nodes_of(element as u32) {
            had[node as usize] = true;
        }
    }
    let mut orphans = Vec::new();
    for node in 0..mesh.node_count() {
        if numbering.engine_of[node] == FREE {
            let engine = numbering.mesh_of.len() as u32;
            numbering.engine_of[node] = engine;
            numbering.mesh_of.push(node as u32);
            if had[node] {
                orphans.push(engine);
            }
        }
    }
    if let Some(last) = parts.last_mut() {
        last.nodes.extend_from_slice(&orphans);
    }
    (numbering, orphans)
}
