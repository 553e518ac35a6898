//! Shapes of hexahedra: their distribution, not only the worst.

use powerhouse::model::{ElementKind, Mesh, Vec3};

/// The least scaled Jacobian at the corners of each hexahedron: 1 for a box, not positive for one that
/// is turned inside out. Other elements are passed over.
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
    let scaled = ElementKind::Hex8.corners().iter().map(|places| {
        let [corner, a, b, c] = places.map(|place| corners[usize::from(place)]);
        let [a, b, c] = [a, b, c].map(|end| (end - corner).normalize());
        a.cross(&b).dot(&c)
    });
    scaled.fold(f64::INFINITY, f64::min)
}

/// The volume (m3) of hexahedra of a mesh, in eight points of Gauss.
pub(crate) fn volume(mesh: &Mesh, elements: impl IntoIterator<Item = u32>) -> f64 {
    let place = 1.0 / 3.0_f64.sqrt();
    let mut gradients = [Vec3::zeros(); 8];
    let mut sum = 0.0;
    for element in elements {
        let nodes = mesh.nodes_of(element);
        for point in 0..8 {
            let sign = |axis: usize| {
                if point >> axis & 1 == 0 {
                    -place
                } else {
                    place
                }
            };
            let natural = Vec3::new(sign(0), sign(1), sign(2));
            ElementKind::Hex8.shape_gradients(&natural, &mut gradients);
            let mut columns = [Vec3::zeros(); 3];
            for (gradient, &node) in gradients.iter().zip(nodes) {
                let position = mesh.positions()[node as usize];
                for axis in 0..3 {
                    columns[axis] += position * gradient[axis];
                }
            }
            sum += columns[0].cross(&columns[1]).dot(&columns[2]);
        }
    }
    sum
}
