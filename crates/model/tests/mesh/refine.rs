//! Meshes whose every element is cut into smaller ones.

use std::collections::BTreeSet;

use powerhouse_model::{ElementKind, Facet, Mesh, MeshError, Vec3};

use super::{GENERATORS, rough_block, volume};

fn vector_area(mesh: &Mesh, facets: &[Facet]) -> Vec3 {
    let areas = facets
        .iter()
        .map(|&facet| mesh.facet_geometry(facet).vector_area);
    areas.sum()
}

/// The parts of an element fill it, turned as it is, whatever its shape; neighbours have the nodes of their
/// common side in common; the parent nodes of a new node determine its position.
#[test]
fn parts_fill_the_whole_and_hang_together() {
    for (kind, generator) in GENERATORS {
        let mesh = rough_block(generator, 0.2);
        let fine = mesh.refined().unwrap();
        assert_eq!(fine.element_count(), 8 * mesh.element_count());
        // The least power of ten above all numbers.
        let stride = if kind == ElementKind::Hex8 { 100 } else { 1000 };
        for element in 0..mesh.element_count() as u32 {
            let parts: Vec<f64> = (8 * element..8 * element + 8)
                .map(|e| volume(&fine, e))
                .collect();
            let (sum, whole): (f64, f64) = (parts.iter().sum(), volume(&mesh, element));
            assert!((sum / whole - 1.0).abs() < 1e-13, "{kind:?} {sum} {whole}");
            assert!(parts.iter().all(|part| *part > 0.0), "{kind:?}");
            let tag = mesh.element_tags()[element as usize];
            let last = fine.element_tags()[8 * element as usize + 7];
            assert_eq!(last, 8 * stride + tag);
        }
        assert_eq!(fine.check_connected().unwrap().parts, 1);
        // A node on a side or edge of a neighbour would leave sides inside the body without neighbours.
        assert_eq!(
            fine.boundary_facets().len(),
            4 * mesh.boundary_facets().len()
        );
        let old = mesh.node_count();
        assert_eq!(&fine.positions()[..old], mesh.positions());
        assert_eq!(&fine.node_tags()[..old], mesh.node_tags());
        for (tags, count) in [
            (fine.node_tags(), fine.node_count()),
            (fine.element_tags(), fine.element_count()),
        ] {
            let all: BTreeSet<u64> = tags.iter().copied().collect();
            assert_eq!(all.len(), count);
        }
        // Boxes of a mesh of half the size have as many nodes as it.
        assert_eq!(fine.node_count(), 11 * 9 * 7, "{kind:?}");
    }
}

/// Sets of elements and facets hold the parts of what they held, sets of nodes what lies between theirs.
#[test]
fn sets_hold_what_lies_in_them() {
    for (kind, generator) in GENERATORS {
        let mut mesh = rough_block(generator, 0.2);
        let left = mesh.facet_set("left").unwrap().to_vec();
        let nodes = mesh.nodes_of_facets(&left);
        mesh.set_node_set("left", nodes).unwrap();
        mesh.set_node_set("one", vec![17]).unwrap();
        mesh.set_element_set("some", vec![3, 5]).unwrap();
        let fine = mesh.refined().unwrap();
        for (name, facets) in mesh.facet_sets() {
            let parts = fine.facet_set(name).unwrap();
            assert_eq!(parts.len(), 4 * facets.len());
            let difference = vector_area(&fine, parts) - vector_area(&mesh, facets);
            assert!(difference.norm() < 1e-12, "{kind:?} {name}");
        }
        let of_facets = fine.nodes_of_facets(fine.facet_set("left").unwrap());
        assert_eq!(fine.node_set("left").unwrap(), of_facets);
        assert_eq!(fine.node_set("one").unwrap(), [17]);
        let some: Vec<u32> = (24..32).chain(40..48).collect();
        assert_eq!(fine.element_set("some").unwrap(), some);
    }
}

/// Elements of several kinds on common sides stay on common sides; bars are cut in two.
#[test]
fn kinds_may_be_mixed() {
    let mut builder = Mesh::builder();
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.1, 1.0, 0.0],
        [0.0, 1.2, 0.1],
        [0.0, 0.0, 1.0],
        [1.0, 0.1, 1.0],
        [1.0, 1.0, 1.3],
        [0.0, 1.0, 1.0],
        // A ridge beside the side x = 1, and a point before it.
        [2.0, 0.0, 0.5],
        [2.2, 1.0, 0.5],
        [1.5, -1.0, 0.5],
    ];
    for (place, corner) in corners.into_iter().enumerate() {
        builder.node(place as u64 + 1, Vec3::from(corner));
    }
    builder.element(1, ElementKind::Hex8, &[1, 2, 3, 4, 5, 6, 7, 8], &["rock"]);
    builder.element(2, ElementKind::Wedge6, &[2, 6, 9, 3, 7, 10], &["rock"]);
    builder.element(3, ElementKind::Tet4, &[2, 9, 6, 11], &["rock"]);
    builder.element(4, ElementKind::Bar2, &[1, 7], &["bolt"]);
    builder.element(5, ElementKind::Bar2, &[7, 6], &["bolt"]);
    let mesh = builder.build().unwrap();
    mesh.check().unwrap();
    let fine = mesh.refined().unwrap();
    assert_eq!(fine.element_count(), 8 + 8 + 8 + 1 + 2);
    fine.check_connected().unwrap();
    assert_eq!(
        fine.boundary_facets().len(),
        4 * mesh.boundary_facets().len()
    );
    // A bar across a brick has no node of a solid in its middle, and stays; one along an edge is cut there.
    assert_eq!(fine.element_set("bolt").unwrap(), [24, 25, 26]);
    assert_eq!(fine.element_tags()[24..], [14, 15, 25]);
    assert_eq!(fine.nodes_of(24), [0, 6]);
    let [first, second] = [25, 26].map(|bar| fine.nodes_of(bar));
    assert_eq!((first[0], first[1], second[1]), (6, second[0], 5));
    let middle = 0.5 * (Vec3::from(corners[5]) + Vec3::from(corners[6]));
    assert_eq!(fine.positions()[first[1] as usize], middle);
}

/// A tetrahedron on the unit triangle, of nodes that are numbered one after the other.
fn tetrahedron(first: u64, element: u64, top: Vec3) -> Mesh {
    let mut builder = Mesh::builder();
    let tags = [first, first + 1, first + 2, first + 3];
    for (tag, corner) in tags
        .into_iter()
        .zip([Vec3::zeros(), Vec3::x(), Vec3::y(), top])
    {
        builder.node(tag, corner);
    }
    builder.element(element, ElementKind::Tet4, &tags, &["rock"]);
    builder.build().unwrap()
}

/// Numbers that leave none for more nodes or elements are refused.
#[test]
fn numbers_without_room_are_refused() {
    for (node, element, wanted) in [(u64::MAX - 3, 1, "node"), (1, u64::MAX - 3, "element")] {
        let refused = tetrahedron(node, element, Vec3::z()).refined();
        let refused = refused.unwrap_err();
        assert!(
            matches!(refused, MeshError::Numbers { what } if what == wanted),
            "{refused}"
        );
    }
}

/// The octahedron in a tetrahedron is cut along its shortest diagonal: twice halved, shapes do not get worse.
#[test]
fn tetrahedra_do_not_get_flatter() {
    for ends in [
        [9.0, 0.0, 0.0],
        [0.0, 9.0, 0.0],
        [9.0, 9.0, 1.0],
        [3.0, 1.0, 7.0],
    ] {
        let mesh = tetrahedron(1, 1, Vec3::z() + Vec3::from(ends) * 0.1);
        let once = mesh.refined().unwrap();
        let twice = once.refined().unwrap();
        let quality = |mesh: &Mesh| mesh.check().unwrap().least_scaled_jacobian;
        assert!(
            (quality(&twice) / quality(&once) - 1.0).abs() < 1e-12,
            "{ends:?}"
        );
        assert!(quality(&once) > 0.3 * quality(&mesh), "{ends:?}");
    }
}
