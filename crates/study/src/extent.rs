//! Extents of the sets of a mesh.

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
