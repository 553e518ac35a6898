//! Quality of hexahedra: the whole distribution, not only the worst element.

use powerhouse::model::{ElementKind, Mesh, Vec3};

/// Least scaled Jacobian (1) among the corners of each hexahedron, in the order of the elements.
///
/// It is 1 for a box and not positive for an inverted element. Elements of other types are skipped.
pub fn scaled_jacobians(mesh: &Mesh) -> Vec<f64> {
    let hexes = hexahedra(mesh);
    hexes
        .map(|corners| least_scaled_jacobian(&corners))
        .collect()
}

fn hexahedra(mesh: &Mesh) -> impl Iterator<Item = [Vec3; 8]> + '_ {
    let all = 0..mesh.element_count() as u32;
    let hexes = all.filter(|&element| mesh.kind(element) == ElementKind::Hex8);
    hexes.map(|element| {
        let nodes = mesh.nodes_of(element);
        core::array::from_fn(|corner| mesh.positions()[nodes[corner] as usize])
    })
}

fn least_scaled_jacobian(corners: &[Vec3; 8]) -> f64 {
    let scaled = ElementKind::Hex8.corners().iter().map(|local| {
        let [corner, a, b, c] = local.map(|index| corners[usize::from(index)]);
        let [a, b, c] = [a, b, c].map(|end| (end - corner).normalize());
        a.cross(&b).dot(&c)
    });
    scaled.fold(f64::INFINITY, f64::min)
}
