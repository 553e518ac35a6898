use powerhouse_model::{ElementKind, Mat3, Mesh, MeshError, Vec3};

use super::{GENERATORS, jacobian, noise, noise3, rough_block};

/// Random natural coordinates inside an element of a kind.
fn natural_inside(kind: ElementKind, seed: u64) -> Vec3 {
    let random = noise3(seed);
    let unit = random.map(|x| 0.5 + 0.5 * x);
    match kind {
        ElementKind::Tet4 => unit / (unit.sum() + noise(seed + 1_000_000).abs()),
        ElementKind::Wedge6 => {
            let sum = unit.x + unit.y + noise(seed + 1_000_000).abs();
            Vec3::new(unit.x / sum, unit.y / sum, random.z)
        }
        _ => random,
    }
}

fn place(mesh: &Mesh, element: u32, natural: &Vec3) -> Vec3 {
    let mut values = [0.0; 8];
    mesh.kind(element).shape_functions(natural, &mut values);
    let nodes = mesh.nodes_of(element).iter().zip(values);
    nodes
        .map(|(&node, value)| mesh.positions()[node as usize] * value)
        .sum()
}

/// Points made from natural coordinates are found again in the same element, and a linear field is
/// reproduced to 1e-12, in rough meshes of every kind, near the origin and far from it.
#[test]
fn probes_in_a_linear_field_are_exact() {
    for (kind, generator) in GENERATORS {
        for far in [0.0, 1e4] {
            let mesh = rough_block(generator, 0.24);
            let mesh = mesh
                .map_positions(|p| p + Vec3::new(far, -far, far))
                .unwrap();
            let count = mesh.element_count() as u64;
            let from: Vec<(u32, Vec3)> = (0..3000)
                .map(|seed| ((seed % count) as u32, natural_inside(kind, seed)))
                .collect();
            let points: Vec<Vec3> = from
                .iter()
                .map(|(e, natural)| place(&mesh, *e, natural))
                .collect();
            let gradient = Mat3::new(0.3, -1.0, 0.2, 0.7, 0.1, -0.4, -0.6, 0.5, 0.9) / (1.0 + far);
            let field = |p: &Vec3| gradient * p + Vec3::new(1.0, -2.0, 0.5);
            let located = mesh.locate(&points).unwrap();
            for ((found, point), (element, natural)) in located.iter().zip(&points).zip(&from) {
                assert_eq!((found.element, found.moved), (*element, 0.0));
                assert!((found.natural - natural).amax() < 1e-11 * (1.0 + far));
                assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                let value = found.interpolate(|node| field(&mesh.positions()[node as usize]));
                assert!((value - field(point)).norm() < 1e-12, "{}", kind.name());
            }
        }
    }
}

/// A point on a node, edge or side that elements share is found in the first of them.
#[test]
fn shared_points_belong_to_the_first_element() {
    for (_, generator) in GENERATORS {
        let mesh = rough_block(generator, 0.2);
        let located = mesh.locate(mesh.positions()).unwrap();
        for (node, found) in located.iter().enumerate() {
            let touching = |&element: &u32| mesh.nodes_of(element).contains(&(node as u32));
            let first = (0..mesh.element_count() as u32).find(touching);
            assert_eq!(Some(found.element), first);
            assert_eq!(found.moved, 0.0);
            for (&corner, &weight) in found.nodes.iter().zip(&found.weights) {
                let expected = if corner == node as u32 { 1.0 } else { 0.0 };
                assert!((weight - expected).abs() < 1e-12);
            }
        }
    }
}

/// Random points of a box around a mesh with plane faces: those inside are found, those outside by
/// more than the tolerance are refused, none is lost in between.
#[test]
fn no_point_is_lost() {
    for (_, generator) in GENERATORS {
        let (low, high) = (Vec3::zeros(), Vec3::new(5.0, 4.0, 3.0));
        let mesh = generator(low, high, [5, 4, 3], "rock").unwrap();
        // Inner nodes move, the surface stays.
        let mesh = mesh
            .map_positions(|p| {
                let inner = (0..3).all(|i| p[i] > low[i] && p[i] < high[i]);
                let shift = 0.24 * noise3((p.x + 10.0 * p.y + 100.0 * p.z) as u64);
                if inner { p + shift } else { p }
            })
            .unwrap();
        for seed in 0..2000 {
            let point =
                Vec3::new(2.5, 2.0, 1.5) + noise3(seed).component_mul(&Vec3::new(3.0, 2.4, 1.8));
            let inside = (0..3).all(|i| point[i] >= low[i] && point[i] <= high[i]);
            match mesh.locate(&[point]) {
                Ok(found) => {
                    assert!(inside);
                    let back = found[0].interpolate(|node| mesh.positions()[node as usize]);
                    assert!((back - point).norm() < 1e-13);
                }
                Err(MeshError::PointOutside { distance, .. }) => {
                    assert!(!inside);
                    let gap = point - point.sup(&low).inf(&high);
                    assert!(distance >= gap.norm() - 1e-12);
                }
                Err(other) => panic!("{other}"),
            }
        }
    }
}

/// A point outside by less than the tolerance is moved to the surface and says how far; beyond it
/// the error names the point and the nearest element.
#[test]
fn points_outside_are_moved_or_named() {
    let mesh =
        Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 2.0, 2.0), [4, 2, 2], "rock").unwrap();
    let close = Vec3::new(3.25, 2.0 + 1e-6, 1.5);
    let found = &mesh.locate(&[close]).unwrap()[0];
    assert!((found.moved - 1e-6).abs() < 1e-15);
    let there = found.interpolate(|node| mesh.positions()[node as usize]);
    assert!((there - Vec3::new(3.25, 2.0, 1.5)).norm() < 1e-14);

    let outside = Vec3::new(3.25, 2.125, 1.5);
    match mesh.locate(&[Vec3::repeat(1.0), outside]) {
        Err(MeshError::PointOutside {
            point,
            element,
            distance,
            tolerance,
        }) => {
            assert_eq!((point, element), ([3.25, 2.125, 1.5], 16));
            assert!((distance - 0.125).abs() < 1e-15);
            assert!((tolerance - 3.0_f64.sqrt() * 1e-6).abs() < 1e-15);
        }
        other => panic!("{other:?}"),
    }
    let all: Vec<u32> = (0..16).collect();
    let found = &mesh.locate_among(&all, &[outside], 0.2).unwrap()[0];
    assert!((found.moved - 0.125).abs() < 1e-15 && found.element == 15);
    match mesh.locate(&[Vec3::new(0.0, f64::NAN, 0.0)]) {
        Err(MeshError::PointNotFinite { point }) => assert!(point[1].is_nan()),
        other => panic!("{other:?}"),
    }
    assert_eq!(
        mesh.locate_among(&[], &[outside], 1.0),
        Err(MeshError::Empty)
    );
    assert_eq!(mesh.locate(&[]), Ok(vec![]));
}

/// Where two bodies touch, the chosen elements decide on which side of the joint a probe lies.
#[test]
fn a_probe_lies_on_the_chosen_side_of_a_joint() {
    let mut builder = Mesh::builder();
    for half in 0..2_u64 {
        let block =
            Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(1.0), [1, 1, 1], "rock").unwrap();
        for (tag, position) in block.node_tags().iter().zip(block.positions()) {
            builder.node(tag + 10 * half, position + half as f64 * Vec3::x());
        }
        let nodes: Vec<u64> = block
            .nodes_of(0)
            .iter()
            .map(|&n| u64::from(n) + 1 + 10 * half)
            .collect();
        let set = if half == 0 { "rock" } else { "lining" };
        builder.element(half + 1, ElementKind::Hex8, &nodes, &[set]);
    }
    let mesh = builder.build().unwrap();
    let joint = [Vec3::new(1.0, 0.3, 0.6)];
    assert_eq!(mesh.locate(&joint).unwrap()[0].element, 0);
    let lining = mesh.element_set("lining").unwrap();
    assert_eq!(
        mesh.locate_among(lining, &joint, 1e-9).unwrap()[0].element,
        1
    );
}

/// Elements a thousand times longer than wide, and squeezed to slivers at a corner, still give
/// their points back.
#[test]
fn slender_and_squeezed_elements_are_searched() {
    for (kind, generator) in GENERATORS {
        let mesh = generator(Vec3::zeros(), Vec3::new(3.0, 3.0, 3.0), [3, 3, 3], "rock").unwrap();
        let slender = mesh
            .clone()
            .map_positions(|p| Vec3::new(1000.0 * p.x + 300.0 * p.y, p.y + 0.2 * p.z * p.z, p.z));
        // Towards one corner every element tapers to a fifth, with warped sides.
        let tapered = mesh.map_positions(|p| {
            let taper = 1.0 - 0.8 * (p.x / 3.0) * (p.y / 3.0);
            Vec3::new(p.x, p.y, taper * p.z + 0.3 * p.x * p.y)
        });
        for mesh in [slender.unwrap(), tapered.unwrap()] {
            mesh.check().unwrap();
            for seed in 0..500 {
                let element = (seed % mesh.element_count() as u64) as u32;
                let point = place(&mesh, element, &natural_inside(kind, seed));
                let found = &mesh.locate(&[point]).unwrap()[0];
                assert_eq!(found.moved, 0.0);
                let back = found.interpolate(|node| mesh.positions()[node as usize]);
                assert!((back - point).norm() < 1e-12 * (1.0 + point.norm()));
            }
        }
    }
}

/// Every inner point of single elements as contorted as positive Jacobians permit is found, also
/// where the map reaches the point a second time outside the element.
#[test]
fn contorted_elements_are_searched() {
    let mut searched = 0;
    for kind in [ElementKind::Hex8, ElementKind::Wedge6] {
        let tags: Vec<u64> = (0..kind.node_count() as u64).collect();
        for seed in 0..10_000 {
            let mut builder = Mesh::builder();
            for (&tag, &corner) in tags.iter().zip(kind.natural_corners()) {
                let shift = 0.9 * noise3(100 * seed + tag);
                builder.node(tag, Vec3::from(corner) + shift);
            }
            builder.element(0, kind, &tags, &["rock"]);
            let mesh = builder.build().unwrap();
            if mesh.check().is_err() || least_jacobian(&mesh) < 0.02 {
                continue;
            }
            for i in 0..20 {
                let point = place(&mesh, 0, &natural_inside(kind, 20 * seed + i));
                let found = &mesh.locate(&[point]).unwrap()[0];
                assert_eq!(found.moved, 0.0, "{} {seed}", kind.name());
                searched += 1;
            }
        }
    }
    assert!(searched > 50_000, "{searched}");
}

/// The least determinant on a grid of 7 x 7 x 7 points of element 0, its surface included.
fn least_jacobian(mesh: &Mesh) -> f64 {
    let at = |i: u32| f64::from(i) / 3.0 - 1.0;
    let mut least = f64::INFINITY;
    for (i, j, k) in (0..343).map(|n| (n % 7, n / 7 % 7, n / 49)) {
        let natural = match mesh.kind(0) {
            ElementKind::Wedge6 => {
                let r = 0.5 + 0.5 * at(i);
                Vec3::new(r, (0.5 + 0.5 * at(j)) * (1.0 - r), at(k))
            }
            _ => Vec3::new(at(i), at(j), at(k)),
        };
        least = least.min(jacobian(mesh, 0, &natural));
    }
    least
}
