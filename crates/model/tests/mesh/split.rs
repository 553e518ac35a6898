//! Meshes cut open between two parts.

use powerhouse_model::{Mesh, MeshError, Vec3};

/// A box of 4 x 2 x 4 unit cubes, and the elements whose centroid meets a condition.
fn block() -> Mesh {
    Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 2.0, 4.0), [4, 2, 4], "rock").unwrap()
}

fn chosen(mesh: &Mesh, condition: impl Fn(Vec3) -> bool) -> Vec<u32> {
    (0..mesh.element_count() as u32)
        .filter(|&e| condition(mesh.centroid(e)))
        .collect()
}

/// A cut through the whole body copies each node of its plane once, for the second side: two sound
/// parts, facets that face each other, copies in the node sets of their originals, and numbers that
/// follow the greatest one.
#[test]
fn a_cut_through_the_body_parts_it() {
    let mut mesh = block();
    let plane = mesh.nodes_in_box(&Vec3::new(2.0, -1.0, -1.0), &Vec3::new(2.0, 3.0, 5.0));
    mesh.set_node_set("plane", plane.clone()).unwrap();
    let (left, right) = (chosen(&mesh, |c| c.x < 2.0), chosen(&mesh, |c| c.x > 2.0));
    let split = mesh.split_between(&left, &right).unwrap();
    assert_eq!(split.mesh.check().unwrap().parts, 2);
    assert_eq!(split.copies.len(), 15);
    assert_eq!(split.mesh.node_set("plane").unwrap().len(), 30);
    assert_eq!(split.mesh.node_tags()[75..], (76..91).collect::<Vec<u64>>());
    assert_eq!(split.mesh.facet_sets(), mesh.facet_sets());
    for (first, second) in split.first.iter().zip(&split.second) {
        let (a, b) = (
            split.mesh.facet_geometry(*first),
            split.mesh.facet_geometry(*second),
        );
        assert!((a.vector_area + b.vector_area).norm() < 1e-15);
        assert_eq!(a.centroid, b.centroid);
        assert!(a.nodes.iter().all(|node| plane.contains(node)));
        assert!(b.nodes.iter().all(|node| *node >= 75));
    }
}

/// A cut that ends inside the body stays closed along its edge there, and is open at the surface.
#[test]
fn a_cut_is_closed_at_its_tip() {
    let mesh = block();
    let below = chosen(&mesh, |c| c.x < 2.0 && c.z < 2.0);
    let beside = chosen(&mesh, |c| c.x > 2.0 && c.z < 2.0);
    let split = mesh.split_between(&below, &beside).unwrap();
    assert_eq!(split.mesh.check().unwrap().parts, 1);
    // Nodes at z = 0 and 1, not those of the edge at z = 2.
    assert_eq!(split.copies.len(), 2 * 3);
    assert!(
        split
            .copies
            .iter()
            .all(|[node, _]| mesh.positions()[*node as usize].z < 1.5)
    );
}

/// Cuts that meet along a line, made one after the other, open the line for three bodies.
#[test]
fn cuts_meet_along_a_line() {
    let mesh = block();
    let (lower, left) = (
        chosen(&mesh, |c| c.z < 2.0),
        chosen(&mesh, |c| c.z > 2.0 && c.x < 2.0),
    );
    let right = chosen(&mesh, |c| c.z > 2.0 && c.x > 2.0);
    let line = |mesh: &Mesh| {
        mesh.nodes_in_box(&Vec3::new(2.0, 0.0, 2.0), &Vec3::new(2.0, 2.0, 2.0))
            .len()
    };
    let one = mesh.split_between(&lower, &left).unwrap().mesh;
    assert_eq!(line(&one), 3);
    let two = one.split_between(&lower, &right).unwrap().mesh;
    assert_eq!(line(&two), 6);
    let three = two.split_between(&left, &right).unwrap().mesh;
    assert_eq!(line(&three), 9);
    assert_eq!(three.check().unwrap().parts, 3);
}

/// A body inside another is cut out all around, its corners included.
#[test]
fn an_inclusion_is_cut_out() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(3.0), [3; 3], "rock").unwrap();
    let inner = chosen(&mesh, |c| (c - Vec3::repeat(1.5)).amax() < 0.1);
    let outer = chosen(&mesh, |c| (c - Vec3::repeat(1.5)).amax() > 0.1);
    let split = mesh.split_between(&outer, &inner).unwrap();
    assert_eq!((split.first.len(), split.copies.len()), (6, 8));
    assert_eq!(split.mesh.check().unwrap().parts, 2);
    assert!(split.mesh.nodes_of(inner[0]).iter().all(|&node| node >= 64));
}

/// Parts that overlap or do not touch are refused.
#[test]
fn senseless_cuts_are_refused() {
    let mesh = block();
    let (left, right) = (chosen(&mesh, |c| c.x < 1.0), chosen(&mesh, |c| c.x > 3.0));
    assert_eq!(
        mesh.split_between(&left, &right),
        Err(MeshError::NoCommonFacets)
    );
    let error = mesh.split_between(&left, &left).unwrap_err();
    assert_eq!(error, MeshError::SharedElement { element: 1 });
}
