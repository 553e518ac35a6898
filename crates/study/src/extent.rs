//! Extents of the sets of a mesh.

use std::collections::{BTreeMap, BTreeSet};

use powerhouse::model::{Mesh, Vec3};

/// Box of the nodes of a set, along the axes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SetExtent {
    /// Name of the set.
    pub set: String,
    /// Members of the set: `elements`, `facets` or `nodes`.
    pub of: &'static str,
    /// Number of its members.
    pub count: usize,
    /// Lower corner (m).
    pub low: Vec3,
    /// Upper corner (m).
    pub high: Vec3,
}

impl SetExtent {
    /// Boxes of all sets with members: sets of elements, then of facets, then of nodes.
    pub(crate) fn all(mesh: &Mesh) -> Vec<Self> {
        let elements = mesh.element_sets().iter().map(|(set, elements)| {
            let nodes = mesh.nodes_of_elements(elements);
            (set, "elements", elements.len(), nodes)
        });
        let facets = mesh.facet_sets().iter().map(|(set, facets)| {
            let nodes = mesh.nodes_of_facets(facets);
            (set, "facets", facets.len(), nodes)
        });
        let nodes = (mesh.node_sets().iter())
            .map(|(set, nodes)| (set, "nodes", nodes.len(), nodes.clone()));
        let sets = elements.chain(facets).chain(nodes);
        sets.filter(|(_, _, count, _)| *count > 0)
            .map(|(set, of, count, nodes)| {
                let (low, high) = extent(mesh, &nodes);
                Self {
                    set: set.clone(),
                    of,
                    count,
                    low,
                    high,
                }
            })
            .collect()
    }
}

/// Lower and upper corner of the box of some nodes.
fn extent(mesh: &Mesh, nodes: &[u32]) -> (Vec3, Vec3) {
    let infinite = Vec3::repeat(f64::INFINITY);
    let positions = nodes.iter().map(|&node| mesh.positions()[node as usize]);
    positions.fold((infinite, -infinite), |(low, high), position| {
        (low.inf(&position), high.sup(&position))
    })
}

/// Parts of a mesh that share no nodes, the largest first: number of elements, and the element sets that they are in.
pub(crate) fn separate_parts(mesh: &Mesh) -> Vec<(usize, Vec<String>)> {
    let mut root: Vec<u32> = (0..mesh.node_count() as u32).collect();
    fn find(root: &mut [u32], mut node: u32) -> u32 {
        while root[node as usize] != node {
            root[node as usize] = root[root[node as usize] as usize];
            node = root[node as usize];
        }
        node
    }
    let every = 0..mesh.element_count() as u32;
    for element in every.clone() {
        let nodes = mesh.nodes_of(element);
        for &node in &nodes[1..] {
            let (a, b) = (find(&mut root, nodes[0]), find(&mut root, node));
            root[a.max(b) as usize] = a.min(b);
        }
    }
    let mut parts: BTreeMap<u32, (usize, Vec<String>)> = BTreeMap::new();
    for element in every {
        let part = find(&mut root, mesh.nodes_of(element)[0]);
        parts.entry(part).or_default().0 += 1;
    }
    for (set, elements) in mesh.element_sets() {
        let of = elements.iter().map(|&element| mesh.nodes_of(element)[0]);
        let of: BTreeSet<u32> = of.map(|node| find(&mut root, node)).collect();
        for part in of {
            parts.entry(part).or_default().1.push(set.clone());
        }
    }
    let mut parts: Vec<(usize, Vec<String>)> = parts.into_values().collect();
    parts.sort_by_key(|(count, _)| core::cmp::Reverse(*count));
    parts
}
