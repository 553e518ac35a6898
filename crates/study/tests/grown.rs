//! Extension of meshes by extruded layers.

use powerhouse::model::{Facet, Mesh, Vec3};
use powerhouse_study::{StudyError, grown};

fn area(mesh: &Mesh, set: &str) -> f64 {
    let facets = mesh.facet_set(set).unwrap();
    facets.iter().map(|f| mesh.facet_geometry(*f).area()).sum()
}

/// A box of hexahedra or wedges that is extended on three sides is a valid box of the larger size: nodes and elements
/// keep their numbers, sets are continued, and every surface facet belongs to one set.
#[test]
fn an_extended_box_is_a_box() {
    let size = Vec3::new(4.0, 3.0, 2.0);
    // The first brick is the corner: two layers to the left, two down, and where both meet. The first
    // wedge has no side on the left.
    let bricks = Mesh::box_of_hexes(Vec3::zeros(), size, [4, 3, 2], "rock");
    let wedges = Mesh::box_of_wedges(Vec3::zeros(), size, [4, 3, 2], "rock");
    for (mesh, of_first) in [(bricks, 9), (wedges, 3)] {
        let mut mesh = mesh.unwrap();
        let all = ["left", "right", "bottom"].map(|f| mesh.facet_set(f).unwrap().to_vec());
        mesh.set_facet_set("absorbing", all.concat()).unwrap();
        mesh.set_element_set("first", vec![0]).unwrap();
        let mut wide = mesh.clone();
        for (face, layers) in [
            ("left", &[1.0, 2.0][..]),
            ("right", &[0.5][..]),
            ("bottom", &[1.5, 1.5][..]),
        ] {
            wide = grown(&wide, face, layers).unwrap();
        }
        assert_eq!(wide.positions()[..mesh.node_count()], *mesh.positions());
        assert_eq!(wide.node_tags()[..mesh.node_count()], *mesh.node_tags());
        for element in 0..mesh.element_count() as u32 {
            assert_eq!(wide.nodes_of(element), mesh.nodes_of(element));
        }
        let (low, high) = wide.bounding_box();
        assert_eq!(
            (low, high),
            (Vec3::new(-3.0, 0.0, -3.0), Vec3::new(4.5, 3.0, 2.0))
        );
        let quality = wide.check_connected().unwrap();
        assert!(quality.least_scaled_jacobian > 0.3, "{quality:?}");
        for (set, expected) in [
            ("left", 15.0),
            ("right", 15.0),
            ("front", 37.5),
            ("back", 37.5),
            ("bottom", 22.5),
            ("top", 22.5),
            ("absorbing", 52.5),
        ] {
            assert!(
                (area(&wide, set) - expected).abs() < 1e-12,
                "{set} {}",
                area(&wide, set)
            );
        }
        let mut named: Vec<Facet> = ["left", "right", "front", "back", "bottom", "top"]
            .iter()
            .flat_map(|set| wide.facet_set(set).unwrap().to_vec())
            .collect();
        named.sort_unstable();
        assert_eq!(named, wide.boundary_facets());
        assert_eq!(
            wide.element_set("rock").unwrap().len(),
            wide.element_count()
        );
        assert_eq!(wide.element_set("first").unwrap().len(), of_first);
    }
}

/// A face that is not plane, an unknown set and a zero thickness are errors.
#[test]
fn invalid_extensions_are_errors() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(2.0), [2; 3], "rock").unwrap();
    let bent = mesh
        .clone()
        .map_positions(|p| Vec3::new(p.x, p.y, p.z * (1.0 + 0.1 * p.x * p.y)));
    let refused = grown(&bent.unwrap(), "top", &[1.0]);
    assert!(matches!(refused, Err(StudyError::NotPlane { face }) if face == "top"));
    assert!(grown(&mesh, "roof", &[1.0]).is_err());
    for thickness in [0.0, -1.0, f64::NAN] {
        assert!(grown(&mesh, "top", &[thickness]).is_err());
    }
}

/// A mesh with nodes on the edges of its elements is not extended, and the error names an element.
#[test]
fn midpoints_are_not_extended() {
    let mesh = Mesh::box_of_tets(Vec3::zeros(), Vec3::repeat(2.0), [2; 3], "rock").unwrap();
    assert!(grown(&mesh, "right", &[1.0]).is_ok());
    let error = grown(&mesh.with_midpoints().unwrap(), "right", &[1.0]).unwrap_err();
    assert!(
        matches!(&error, StudyError::Midpoints { element, .. } if *element > 0),
        "{error}"
    );
}
