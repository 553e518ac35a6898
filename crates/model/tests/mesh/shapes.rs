use std::collections::HashMap;

use powerhouse_model::{ElementKind, Mat3, Mesh, MeshError, Vec3};

use super::{GENERATORS, noise3, rough_block, volume};

const SOLIDS: [ElementKind; 3] = [ElementKind::Hex8, ElementKind::Tet4, ElementKind::Wedge6];

fn one(kind: ElementKind, corners: &[Vec3]) -> Mesh {
    let mut builder = Mesh::builder();
    let tags: Vec<u64> = (1..=corners.len() as u64).collect();
    for (&tag, &corner) in tags.iter().zip(corners) {
        builder.node(tag, corner);
    }
    builder.element(7, kind, &tags, &["rock"]);
    builder.build().unwrap()
}

fn reference_corners(kind: ElementKind) -> Vec<Vec3> {
    let corners = kind.natural_corners().iter();
    corners.map(|&corner| Vec3::from(corner)).collect()
}

/// Every renumbering of the nodes that a rotation of the element onto itself makes.
fn rotations(kind: ElementKind) -> Vec<Vec<usize>> {
    let corners = reference_corners(kind);
    let mut permutation: Vec<usize> = (0..corners.len()).collect();
    let mut found = Vec::new();
    // A permutation is a rotation if some affine map with positive determinant makes it.
    fn visit(
        permutation: &mut Vec<usize>,
        fixed: usize,
        corners: &[Vec3],
        found: &mut Vec<Vec<usize>>,
    ) {
        let basis = |order: &[usize]| {
            let [a, b, c, d] = [order[0], order[1], order[2], order[3]].map(|i| corners[i]);
            (a, Mat3::from_columns(&[b - a, c - a, d - a]))
        };
        // Four corners that span space, whatever the kind.
        let pick = |order: &[usize]| match corners.len() {
            8 => basis(&[order[0], order[1], order[3], order[4]]),
            _ => basis(&[order[0], order[1], order[2], order[3]]),
        };
        if fixed == corners.len() {
            let identity: Vec<usize> = (0..corners.len()).collect();
            let (from, before) = pick(&identity);
            let (to, after) = pick(permutation);
            let Some(inverse) = before.try_inverse() else {
                return;
            };
            let map = after * inverse;
            let maps = |i: usize| {
                (map * (corners[i] - from) + to - corners[permutation[i]]).norm() < 1e-12
            };
            if map.determinant() > 0.5 && (0..corners.len()).all(maps) {
                found.push(permutation.clone());
            }
            return;
        }
        for i in fixed..permutation.len() {
            permutation.swap(fixed, i);
            visit(permutation, fixed + 1, corners, found);
            permutation.swap(fixed, i);
        }
    }
    visit(&mut permutation, 0, &corners, &mut found);
    found
}

/// A sound element stays sound however it is turned into itself, its mirror image never is.
#[test]
fn corner_triads_are_right_handed_in_every_orientation() {
    for (kind, count) in SOLIDS.into_iter().zip([24, 12, 6]) {
        let turned = rotations(kind);
        assert_eq!(turned.len(), count, "{}", kind.name());
        for permutation in turned {
            let skew = Mat3::new(1.0, 0.3, -0.2, 0.1, 0.8, 0.4, -0.3, 0.2, 1.1);
            let corners = reference_corners(kind);
            let sound: Vec<Vec3> = permutation.iter().map(|&i| skew * corners[i]).collect();
            let report = one(kind, &sound).check().unwrap();
            assert!(report.least_scaled_jacobian > 0.2);
            let mirrored: Vec<Vec3> = sound.iter().map(|p| Vec3::new(-p.x, p.y, p.z)).collect();
            let error = one(kind, &mirrored).check().unwrap_err();
            assert!(matches!(error, MeshError::Inverted { element: 7, .. }));
        }
    }
}

/// One corner pulled through the opposite side is found at a corner that it spoils.
#[test]
fn one_corner_out_of_place_is_found() {
    for kind in SOLIDS {
        let corners = reference_corners(kind);
        let centre: Vec3 = corners.iter().sum::<Vec3>() / corners.len() as f64;
        for moved in 0..corners.len() {
            let mut spoiled = corners.clone();
            spoiled[moved] += 4.0 * (centre - corners[moved]);
            assert!(
                one(kind, &spoiled).check().is_err(),
                "{} {moved}",
                kind.name()
            );
        }
    }
}

/// The sides of an element form a closed surface whose orientation is everywhere outward.
#[test]
fn sides_close_and_face_outward() {
    for kind in SOLIDS {
        let mut edges: HashMap<(u8, u8), i32> = HashMap::new();
        for side in kind.sides() {
            for i in 0..side.len() {
                let (from, to) = (side[i], side[(i + 1) % side.len()]);
                *edges.entry((from, to)).or_default() += 1;
            }
        }
        for (&(from, to), &count) in &edges {
            assert_eq!((count, edges.get(&(to, from))), (1, Some(&1)));
        }
        let corners = reference_corners(kind);
        let centre = kind.natural_centre();
        for side in kind.sides() {
            let at = |i: usize| corners[side[i] as usize];
            let normal = (at(1) - at(0)).cross(&(at(2) - at(1)));
            assert!(
                normal.dot(&(at(0) - centre)) > 0.0,
                "{} {side:?}",
                kind.name()
            );
        }
    }
}

/// The scaled Jacobian and the edges of known shapes are those of their closed forms.
#[test]
fn the_quality_report_measures_known_shapes() {
    let brick: Vec<Vec3> = reference_corners(ElementKind::Hex8)
        .iter()
        .map(|p| Vec3::new(p.x, 2.0 * p.y, 4.0 * p.z))
        .collect();
    let report = one(ElementKind::Hex8, &brick).check().unwrap();
    assert!((report.least_scaled_jacobian - 1.0).abs() < 1e-15);
    assert_eq!((report.shortest_edge, report.longest_edge), (2.0, 8.0));
    assert_eq!((report.largest_aspect, report.parts), (4.0, 1));
    // Equal edges: cos(30 degrees) at a wedge's corner, 1 / sqrt(2) at a tetrahedron's.
    let h = 0.75_f64.sqrt();
    let triangle = [Vec3::zeros(), Vec3::x(), Vec3::new(0.5, h, 0.0)];
    let wedge: Vec<Vec3> = triangle
        .iter()
        .copied()
        .chain(triangle.map(|p| p + Vec3::z()))
        .collect();
    let report = one(ElementKind::Wedge6, &wedge).check().unwrap();
    assert!((report.least_scaled_jacobian - h).abs() < 1e-15);
    let tip = Vec3::new(0.5, h / 3.0, (2.0_f64 / 3.0).sqrt());
    let tet = [triangle[0], triangle[1], triangle[2], tip];
    let report = one(ElementKind::Tet4, &tet).check().unwrap();
    assert!((report.least_scaled_jacobian - 0.5_f64.sqrt()).abs() < 1e-15);
    assert_eq!(report.worst_element, 7);
}

/// Shape functions are one at their node, add up to one, and reproduce linear fields; their
/// gradients are their derivatives.
#[test]
fn shape_functions_are_complete() {
    for kind in [SOLIDS.as_slice(), &[ElementKind::Bar2]].concat() {
        let count = kind.node_count();
        let value = |natural: &Vec3| {
            let mut values = [0.0; 8];
            kind.shape_functions(natural, &mut values);
            values
        };
        for (a, &corner) in kind.natural_corners().iter().enumerate() {
            let values = value(&Vec3::from(corner));
            for b in 0..count {
                assert_eq!(values[b], if a == b { 1.0 } else { 0.0 });
            }
        }
        for seed in 0..20 {
            let axes = if kind == ElementKind::Bar2 { 1 } else { 3 };
            let mut natural = noise3(seed);
            for unused in axes..3 {
                natural[unused] = 0.0;
            }
            let values = value(&natural);
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let mut rebuilt = Vec3::zeros();
            for (corner, value) in kind.natural_corners().iter().zip(values) {
                rebuilt += Vec3::from(*corner) * value;
            }
            assert!((rebuilt - natural).norm() < 1e-15);
            let mut gradients = [Vec3::zeros(); 8];
            kind.shape_gradients(&natural, &mut gradients);
            for axis in 0..axes {
                // Of first degree in each coordinate: central differences are exact.
                let step = Vec3::ith(axis, 0.5);
                let (after, before) = (value(&(natural + step)), value(&(natural - step)));
                for a in 0..count {
                    assert!((gradients[a][axis] - (after[a] - before[a])).abs() < 1e-15);
                }
            }
        }
    }
}

/// Elements of a rough block fill its volume as its surface encloses it.
#[test]
fn elements_fill_what_the_surface_encloses() {
    for (kind, generator) in GENERATORS {
        let mesh = rough_block(generator, 0.15);
        mesh.check_connected().unwrap();
        let inside: f64 = (0..mesh.element_count() as u32)
            .map(|element| volume(&mesh, element))
            .sum();
        // Divergence theorem: the integral of x . n dA is three times the volume.
        let mut enclosed = 0.0;
        for facet in mesh.boundary_facets() {
            let geometry = mesh.facet_geometry(facet);
            for (&node, share) in geometry.nodes.iter().zip(&geometry.shares) {
                enclosed += mesh.positions()[node as usize].dot(share) / 3.0;
            }
        }
        assert!(
            (inside - enclosed).abs() < 1e-12 * inside,
            "{}",
            kind.name()
        );
    }
}
