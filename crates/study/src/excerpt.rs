//! Extraction of elements into a mesh of their own.

use powerhouse::model::{Mesh, MeshError};

/// The mesh of some elements of another mesh, with the same order and element numbers, all in the set `shown`.
pub(crate) fn excerpt(mesh: &Mesh, elements: &[u32]) -> Result<Mesh, MeshError> {
    let mut builder = Mesh::builder();
    for node in mesh.nodes_of_elements(elements) {
        let position = mesh.positions()[node as usize];
        builder.node(u64::from(node) + 1, position);
    }
    for &element in elements {
        let nodes = mesh.nodes_of(element).iter();
        let nodes: Vec<u64> = nodes.map(|&node| u64::from(node) + 1).collect();
        let tag = mesh.element_tags()[element as usize];
        builder.element(tag, mesh.kind(element), &nodes, &["shown"]);
    }
    builder.build()
}
