use powerhouse_model::{ElementKind, Mesh, MeshError, Vec3};

use super::{GENERATORS, volume};

/// A generated box is sound, whole, of the stated volume, and its faces are where they are said to
/// be, with outward normals.
#[test]
fn boxes_are_sound() {
    let (low, high) = (Vec3::new(-80.0, 3.0, -150.0), Vec3::new(-50.0, 5.0, 0.0));
    for (kind, generator) in GENERATORS {
        let mesh = generator(low, high, [3, 2, 7], "rock").unwrap();
        let per_cell = match kind {
            ElementKind::Hex8 => 1,
            ElementKind::Wedge6 => 2,
            _ => 6,
        };
        assert_eq!(mesh.element_count(), 42 * per_cell);
        assert_eq!(mesh.element_set("rock").unwrap().len(), 42 * per_cell);
        assert_eq!(mesh.check_connected().unwrap().parts, 1);
        assert_eq!(mesh.bounding_box(), (low, high));
        let filled: f64 = (0..mesh.element_count() as u32)
            .map(|e| volume(&mesh, e))
            .sum();
        assert!((filled - 9000.0).abs() < 1e-9);
        let faces = [
            ("left", -Vec3::x(), 300.0),
            ("right", Vec3::x(), 300.0),
            ("front", -Vec3::y(), 4500.0),
            ("back", Vec3::y(), 4500.0),
            ("bottom", -Vec3::z(), 60.0),
            ("top", Vec3::z(), 60.0),
        ];
        let mut count = 0;
        for (name, normal, area) in faces {
            let facets = mesh.facet_set(name).unwrap();
            count += facets.len();
            let vectors = facets.iter().map(|&f| mesh.facet_geometry(f).vector_area);
            assert!((vectors.sum::<Vec3>() - normal * area).norm() < 1e-10);
            let end = if normal.sum() > 0.0 { high } else { low };
            for node in mesh.nodes_of_facets(facets) {
                assert_eq!((mesh.positions()[node as usize] - end).dot(&normal), 0.0);
            }
        }
        assert_eq!(count, mesh.boundary_facets().len());
    }
}

/// A box that cannot be is refused before any memory is allocated.
#[test]
fn impossible_boxes_are_refused() {
    let unit = Vec3::repeat(1.0);
    let make = |high: Vec3, cells| Mesh::box_of_hexes(Vec3::zeros(), high, cells, "rock");
    assert_eq!(make(unit, [1, 0, 1]), Err(MeshError::Empty));
    let flat = MeshError::NoExtent {
        axis: 'y',
        low: 0.0,
        high: 0.0,
    };
    assert_eq!(make(Vec3::new(1.0, 0.0, 1.0), [1, 1, 1]), Err(flat));
    assert!(matches!(
        make(unit * f64::NAN, [1, 1, 1]),
        Err(MeshError::NoExtent { axis: 'x', .. })
    ));
    assert!(matches!(
        make(unit, [usize::MAX, 3, 3]),
        Err(MeshError::TooLarge { .. })
    ));
    assert!(matches!(
        make(unit, [1000, 1000, 1000]),
        Err(MeshError::TooLarge { .. })
    ));
}

/// Moving the nodes keeps numbers and sets, and refuses positions that are not finite.
#[test]
fn mapped_positions_keep_sets() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(2.0), [2, 2, 2], "rock").unwrap();
    let moved = mesh.clone().map_positions(|p| 2.0 * p).unwrap();
    assert_eq!(moved.facet_sets(), mesh.facet_sets());
    assert_eq!(moved.element_sets(), mesh.element_sets());
    assert_eq!(moved.bounding_box().1, Vec3::repeat(4.0));
    let torn = mesh.map_positions(|p| Vec3::new(p.x, 1.0 / p.y, p.z));
    assert!(matches!(
        torn,
        Err(MeshError::CoordinateNotFinite {
            node: 1,
            axis: 'y',
            ..
        })
    ));
}

/// Selections by box are closed: what lies on the border belongs.
#[test]
fn selections_by_box_are_closed() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(4.0), [4, 4, 4], "rock").unwrap();
    let nodes = mesh.nodes_in_box(&Vec3::repeat(1.0), &Vec3::repeat(2.0));
    assert_eq!(nodes.len(), 8);
    let elements = mesh.elements_in_box(&Vec3::repeat(0.5), &Vec3::repeat(1.5));
    assert_eq!(elements.len(), 8);
    assert_eq!(mesh.nodes_of_elements(&elements).len(), 27);
    assert!(
        mesh.nodes_in_box(&Vec3::repeat(5.0), &Vec3::repeat(6.0))
            .is_empty()
    );
}
