//! Pyramids, and tetrahedra with midpoints.

use std::collections::HashMap;

use powerhouse_model::{ElementKind, Extents, Facet, Mat3, Mesh, MeshError, Vec3};

use super::{noise3, rough_block};

const KINDS: [ElementKind; 2] = [ElementKind::Pyramid5, ElementKind::Tet10];

/// Blocks of both kinds with nodes moved at random; midpoints are midpoints.
fn blocks() -> [Mesh; 2] {
    let tets = rough_block(Mesh::box_of_tets, 0.15);
    [
        rough_block(Mesh::box_of_pyramids, 0.15),
        tets.with_midpoints().unwrap(),
    ]
}

/// Natural coordinates inside an element, from numbers in [-1, 1).
fn inside(kind: ElementKind, seed: u64) -> Vec3 {
    match kind {
        ElementKind::Tet10 => {
            let shares = noise3(seed).map(|x| -(0.5 + 0.499 * x).ln());
            let all = shares.sum() - (0.5 + 0.499 * noise3(seed + 1000).x).ln();
            shares / all
        }
        _ => 0.99 * noise3(seed),
    }
}

/// Shape functions are one at their node and zero at the others, add up to one, reproduce linear fields, are nowhere
/// negative, and their gradients are their derivatives.
#[test]
fn shape_functions_interpolate() {
    for kind in KINDS {
        let nodes = kind.natural_corners();
        let mut values = vec![0.0; nodes.len()];
        for (node, &at) in nodes.iter().enumerate() {
            kind.shape_functions(&Vec3::from(at), &mut values);
            for (other, value) in values.iter().enumerate() {
                let expected = f64::from(u8::from(other == node));
                assert!((value - expected).abs() < 1e-15, "{} {node}", kind.name());
            }
        }
        for seed in 0..200 {
            let natural = inside(kind, seed);
            kind.shape_functions(&natural, &mut values);
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(values.iter().all(|value| *value > -1e-15));
            if kind == ElementKind::Tet10 {
                let terms = nodes.iter().zip(&values);
                let found: Vec3 = terms.map(|(&x, value)| Vec3::from(x) * *value).sum();
                assert!((found - natural).norm() < 1e-14);
            }
            let mut gradients = vec![Vec3::zeros(); nodes.len()];
            kind.shape_gradients(&natural, &mut gradients);
            for axis in 0..3 {
                let step = Vec3::ith(axis, 1e-6);
                let mut other = vec![0.0; nodes.len()];
                kind.shape_functions(&(natural + step), &mut values);
                kind.shape_functions(&(natural - step), &mut other);
                for a in 0..nodes.len() {
                    let slope = (values[a] - other[a]) / 2e-6;
                    assert!((slope - gradients[a][axis]).abs() < 1e-8, "{}", kind.name());
                }
            }
        }
    }
}

/// The sides of an element form a closed surface whose orientation is everywhere outward, and shares of their nodes make
/// the volume and no resultant.
#[test]
fn sides_close_and_their_shares_make_the_volume() {
    for (kind, mesh) in KINDS.into_iter().zip(blocks()) {
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
        let report = mesh.check().unwrap();
        assert_eq!(report.parts, 1);
        let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let (mut tensor, mut resultant) = (Mat3::zeros(), Vec3::zeros());
        for facet in mesh.boundary_facets() {
            let geometry = mesh.facet_geometry(facet);
            resultant += geometry.vector_area;
            let areas: f64 = geometry.areas.iter().sum();
            assert!(areas > 0.99 * geometry.area());
            for (&node, share) in geometry.nodes.iter().zip(&geometry.shares) {
                tensor += mesh.positions()[node as usize] * share.transpose();
            }
        }
        let inside = mesh.volume_of(&all);
        assert!(resultant.norm() < 1e-12);
        assert!((tensor - Mat3::identity() * inside).norm() < 1e-12 * inside);
    }
}

/// On a triangle with midpoints a corner has a twelfth of the area and a midpoint a quarter.
#[test]
fn midpoints_have_three_times_the_area_of_corners() {
    let mesh = blocks()[1].clone();
    for facet in mesh.boundary_facets() {
        let geometry = mesh.facet_geometry(facet);
        assert_eq!(mesh.facet_corners(facet).len(), 3);
        for (i, area) in geometry.areas.iter().enumerate() {
            let part = if i % 2 == 0 { 12.0 } else { 4.0 };
            assert!((area * part / geometry.area() - 1.0).abs() < 1e-13);
        }
        for i in [1, 3, 5] {
            let at = |i: usize| mesh.positions()[geometry.nodes[i % 6] as usize];
            assert!((at(i) - (at(i - 1) + at(i + 1)) * 0.5).norm() < 1e-15 * 10.0);
        }
    }
}

/// Points of every element are found in it, with weights that reproduce linear fields.
#[test]
fn points_are_located() {
    for (kind, mesh) in KINDS.into_iter().zip(blocks()) {
        let mut values = vec![0.0; kind.node_count()];
        let points: Vec<Vec3> = (0..mesh.element_count() as u32)
            .map(|element| {
                kind.shape_functions(&inside(kind, element.into()), &mut values);
                let nodes = mesh.nodes_of(element).iter().zip(&values);
                nodes
                    .map(|(&n, value)| mesh.positions()[n as usize] * *value)
                    .sum()
            })
            .collect();
        for (element, (point, found)) in
            points.iter().zip(mesh.locate(&points).unwrap()).enumerate()
        {
            assert_eq!(found.element as usize, element, "{}", kind.name());
            let there = found.interpolate(|node| mesh.positions()[node as usize]);
            assert!((there - point).norm() < 1e-12);
        }
        // Every node is found too, an apex included.
        for (node, found) in mesh.locate(mesh.positions()).unwrap().iter().enumerate() {
            let there = found.interpolate(|node| mesh.positions()[node as usize]);
            assert!((there - mesh.positions()[node]).norm() < 1e-9);
        }
    }
}

/// Widths are those of the second moments: six pyramids make a cube, and midpoints change nothing.
#[test]
fn widths_are_those_of_the_volume() {
    let skew = Mat3::new(1.0, 0.3, -0.2, 0.1, 2.0, 0.4, 0.0, -0.5, 0.7);
    let corners = |kind: ElementKind| -> Vec<Vec3> {
        let corners = kind.natural_corners().iter();
        corners.map(|&x| skew * Vec3::from(x)).collect()
    };
    let (four, ten) = (ElementKind::Tet4, ElementKind::Tet10);
    let first = Extents::of_element(four, &corners(four));
    let second = Extents::of_element(ten, &corners(ten));
    assert_eq!(first, second);
    // A pyramid with base edge 2 and height 2: V = 8/3, moments b^2/20 across and 3 h^2/80 along its axis.
    let kind = ElementKind::Pyramid5;
    let pyramid: Vec<Vec3> = kind
        .natural_corners()
        .iter()
        .map(|&x| Vec3::from(x))
        .collect();
    let widths = Extents::of_element(kind, &pyramid);
    let across = (12.0 * 4.0 / 20.0_f64).sqrt();
    let along = (12.0 * 3.0 * 4.0 / 80.0_f64).sqrt();
    assert!((widths.along(&[1.0, 0.0, 0.0]) - across).abs() < 1e-12);
    assert!((widths.along(&[0.0, 0.0, 1.0]) - along).abs() < 1e-12);
}

/// A mirrored pyramid is refused, and so is one with a base that looks the wrong way.
#[test]
fn pyramids_of_the_wrong_orientation_are_refused() {
    for order in [[1_u64, 4, 3, 2, 5], [2, 1, 4, 3, 5]] {
        let mut builder = Mesh::builder();
        for (tag, &x) in (1..).zip(ElementKind::Pyramid5.natural_corners()) {
            builder.node(tag, Vec3::from(x));
        }
        builder.element(9, ElementKind::Pyramid5, &order, &["rock"]);
        let error = builder.build().unwrap().check().unwrap_err();
        assert!(matches!(error, MeshError::Inverted { element: 9, .. }));
    }
}

/// An edge that is curved is refused with the element, the node and its distance, and can be straightened.
#[test]
fn curved_edges_are_refused_and_straightened() {
    let mesh = Mesh::box_of_tets(Vec3::zeros(), Vec3::repeat(2.0), [1, 1, 1], "rock").unwrap();
    let straight = mesh.with_midpoints().unwrap();
    let count = mesh.node_count();
    let bent = straight
        .clone()
        .map_positions(|x| {
            if (x - Vec3::new(1.0, 0.0, 0.0)).norm() < 1e-9 {
                x + Vec3::new(0.0, -0.1, 0.0)
            } else {
                x
            }
        })
        .unwrap();
    let error = bent.check().unwrap_err();
    let MeshError::CurvedEdge {
        element,
        kind,
        node,
        offset,
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!((element, kind), (1, "tet10"));
    assert!(node > count as u64);
    assert!((offset - 0.1).abs() < 1e-12);
    assert_eq!(bent.with_straight_edges(), straight);
}

/// Tetrahedra with midpoints do not fit other solids, and are not divided by refinement; neither are pyramids.
#[test]
fn what_does_not_fit_is_refused() {
    let tets = Mesh::box_of_tets(Vec3::zeros(), Vec3::repeat(1.0), [1, 1, 1], "rock").unwrap();
    let mut builder = Mesh::builder();
    for (tag, x) in (1..).zip(tets.positions()) {
        builder.node(tag, *x);
    }
    for element in 0..6 {
        let nodes: Vec<u64> = tets
            .nodes_of(element)
            .iter()
            .map(|&n| 1 + u64::from(n))
            .collect();
        builder.element(1 + u64::from(element), ElementKind::Tet4, &nodes, &["rock"]);
    }
    builder.node(20, Vec3::new(0.5, 0.5, 3.0));
    builder.element(20, ElementKind::Pyramid5, &[5, 6, 8, 7, 20], &["cap"]);
    let mixed = builder.build().unwrap();
    assert!(mixed.check().is_ok());
    let error = mixed.with_midpoints().unwrap_err();
    assert!(
        matches!(error, MeshError::SidesDoNotFit { other: 20, .. }),
        "{error}"
    );
    let bricks = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(1.0), [1, 1, 1], "rock").unwrap();
    assert_eq!(bricks.with_midpoints(), Err(MeshError::NoTetrahedra));
    for mesh in blocks() {
        let error = mesh.refined().unwrap_err();
        assert!(
            matches!(error, MeshError::NotDivided { element: 1, .. }),
            "{error}"
        );
    }
}

/// Facets and sets survive the new nodes: the same sides, with the midpoints between their corners.
#[test]
fn sets_survive_midpoints() {
    let mut mesh = Mesh::box_of_tets(Vec3::zeros(), Vec3::repeat(2.0), [2, 1, 1], "rock").unwrap();
    let floor = mesh.nodes_of_facets(mesh.facet_set("bottom").unwrap());
    mesh.set_node_set("floor", floor).unwrap();
    let fine = mesh.with_midpoints().unwrap();
    assert_eq!(fine.facet_set("bottom"), mesh.facet_set("bottom"));
    let on_floor = fine.nodes_of_facets(fine.facet_set("bottom").unwrap());
    assert_eq!(fine.node_set("floor").unwrap(), on_floor);
    assert_eq!(on_floor.len(), 5 * 3);
    let area: f64 = fine
        .facet_set("bottom")
        .unwrap()
        .iter()
        .map(|&f| fine.facet_geometry(f).area())
        .sum();
    assert!((area - 4.0).abs() < 1e-14);
    let of_side: Vec<Facet> = fine.boundary_facets();
    assert_eq!(of_side, mesh.boundary_facets());
}
