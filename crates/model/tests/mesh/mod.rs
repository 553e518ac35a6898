//! Meshes: shapes, faults, facets, location of points, selections, parts, refinement, slices and generators.

mod facets;
mod faults;
mod generate;
mod locate;
mod orders;
mod part;
mod periodic;
mod refine;
mod shapes;
mod slice;
mod split;

use powerhouse_model::{ElementKind, Mesh, Vec3};

/// A number in [-1, 1) that depends on nothing but its seed.
fn noise(seed: u64) -> f64 {
    let mut x = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A vector of three such numbers.
fn noise3(seed: u64) -> Vec3 {
    Vec3::new(noise(3 * seed), noise(3 * seed + 1), noise(3 * seed + 2))
}

/// The generators, by kind.
type Generator = fn(Vec3, Vec3, [usize; 3], &str) -> Result<Mesh, powerhouse_model::MeshError>;
const GENERATORS: [(ElementKind, Generator); 3] = [
    (ElementKind::Hex8, Mesh::box_of_hexes),
    (ElementKind::Wedge6, Mesh::box_of_wedges),
    (ElementKind::Tet4, Mesh::box_of_tets),
];

/// A block of 5 x 4 x 3 m whose every node, those on the surface included, is moved by up to
/// `amount` (m) along each axis.
fn rough_block(generator: Generator, amount: f64) -> Mesh {
    let block = generator(Vec3::zeros(), Vec3::new(5.0, 4.0, 3.0), [5, 4, 3], "rock").unwrap();
    block
        .map_positions(|p| p + amount * noise3((p.x + 10.0 * p.y + 100.0 * p.z).round() as u64))
        .unwrap()
}

/// The determinant of the isoparametric map's derivative.
fn jacobian(mesh: &Mesh, element: u32, natural: &Vec3) -> f64 {
    let mut gradients = [Vec3::zeros(); 8];
    mesh.kind(element).shape_gradients(natural, &mut gradients);
    let terms = mesh.nodes_of(element).iter().zip(gradients);
    let derivative: powerhouse_model::Mat3 = terms
        .map(|(&node, gradient)| mesh.positions()[node as usize] * gradient.transpose())
        .sum();
    derivative.determinant()
}

/// The volume of an element (m3) by Gauss points, exact for every kind.
fn volume(mesh: &Mesh, element: u32) -> f64 {
    let kind = mesh.kind(element);
    let jacobian = |natural| jacobian(mesh, element, &natural);
    let g = 1.0 / 3.0_f64.sqrt();
    match kind {
        ElementKind::Tet4 => jacobian(Vec3::repeat(0.25)) / 6.0,
        ElementKind::Wedge6 => {
            let points = [(1.0, 1.0), (4.0, 1.0), (1.0, 4.0)];
            let at = |t: f64| -> f64 {
                let each = points.map(|(r, s)| jacobian(Vec3::new(r / 6.0, s / 6.0, t)) / 6.0);
                each.iter().sum()
            };
            at(-g) + at(g)
        }
        _ => (0..8)
            .map(|i| {
                let sign = |bit: usize| if i & bit == 0 { -g } else { g };
                jacobian(Vec3::new(sign(1), sign(2), sign(4)))
            })
            .sum(),
    }
}
