//! Parts of meshes.

use powerhouse_model::{Facet, Mesh, MeshError, Vec3};

use super::{GENERATORS, volume};

fn area(mesh: &Mesh, set: &str) -> f64 {
    let facets = mesh.facet_set(set).unwrap().iter();
    facets.map(|&facet| mesh.facet_geometry(facet).area()).sum()
}

/// A block of 5 x 4 x 3 m with half of its left side in a set of its own.
fn block(generator: super::Generator) -> Mesh {
    let mut mesh = generator(Vec3::zeros(), Vec3::new(5.0, 4.0, 3.0), [5, 4, 3], "rock").unwrap();
    let left = mesh.facet_set("left").unwrap().to_vec();
    let is_low = |facet: &&Facet| mesh.facet_geometry(**facet).centroid.z < 1.5;
    let low = left.iter().filter(is_low).copied().collect();
    mesh.set_facet_set("left low", low).unwrap();
    let corner = mesh.nodes_in_box(&Vec3::zeros(), &Vec3::zeros());
    mesh.set_node_set("corner", corner).unwrap();
    mesh
}

/// What lies in a box keeps its numbers and places; sides that are cut off stand where it ends, those that
/// are not stay, and what held a part of a side that went is empty.
#[test]
fn what_lies_in_a_box_has_the_faces_of_the_whole() {
    for (kind, generator) in GENERATORS {
        let mesh = block(generator);
        let (low, high) = (
            Vec3::new(1.0, -1.0, 1.0),
            Vec3::new(4.0, 9.0, f64::INFINITY),
        );
        let part = mesh.within(&low, &high).unwrap();
        assert_eq!(
            part.bounding_box(),
            (Vec3::new(1.0, 0.0, 1.0), Vec3::new(4.0, 4.0, 3.0))
        );
        let sum: f64 = (0..part.element_count() as u32)
            .map(|e| volume(&part, e))
            .sum();
        assert!((sum - 24.0).abs() < 1e-12, "{kind:?} {sum}");
        for (set, expected) in [
            ("left", 8.0),
            ("right", 8.0),
            ("front", 6.0),
            ("back", 6.0),
            ("bottom", 12.0),
            ("top", 12.0),
            ("left low", 0.0),
        ] {
            assert!(
                (area(&part, set) - expected).abs() < 1e-12,
                "{kind:?} {set}"
            );
        }
        for &facet in part.facet_set("left").unwrap() {
            let geometry = part.facet_geometry(facet);
            assert_eq!((geometry.centroid.x, geometry.normal().x), (1.0, -1.0));
        }
        assert!(part.node_set("corner").unwrap().is_empty());
        assert_eq!(
            part.element_set("rock").unwrap().len(),
            part.element_count()
        );
        for (tag, position) in part.node_tags().iter().zip(part.positions()) {
            let of_whole = mesh.node_tags().iter().position(|other| other == tag);
            assert_eq!(*position, mesh.positions()[of_whole.unwrap()]);
        }
        assert!(part.check().is_ok());
        // A box around everything leaves everything as it is.
        let whole = mesh
            .within(&Vec3::repeat(-9.0), &Vec3::repeat(9.0))
            .unwrap();
        assert_eq!(whole.facet_sets(), mesh.facet_sets());
        assert_eq!(whole.element_sets(), mesh.element_sets());
    }
}

/// Layers that are not plane end in steps, all of which belong to the side that was cut off there.
#[test]
fn a_side_may_have_steps() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(8.0, 1.0, 4.0), [8, 1, 4], "rock");
    // Columns lean: those of the upper rows stand farther out.
    let leaning = mesh.unwrap().map_positions(|p| {
        let inside = p.x * (8.0 - p.x) / 16.0;
        Vec3::new(p.x + 0.3 * inside * p.z, p.y, p.z)
    });
    let leaning = leaning.unwrap();
    let (low, high) = (Vec3::new(2.5, -1.0, -1.0), Vec3::new(6.0, 2.0, 9.0));
    let part = leaning.within(&low, &high).unwrap();
    let right = part.facet_set("right").unwrap();
    let middle = |facet: &Facet| part.facet_geometry(*facet).centroid.x;
    assert!(right.iter().all(|facet| middle(facet) > 4.5));
    let left = part.facet_set("left").unwrap();
    assert!(left.iter().all(|facet| middle(facet) < 4.0));
    let steps = right
        .iter()
        .filter(|&&facet| part.facet_geometry(facet).normal().z.abs() > 0.9);
    assert!(steps.count() > 0);
    // All of the surface has a name still.
    let sides = ["left", "right", "front", "back", "bottom", "top"];
    let named = sides.iter().map(|side| part.facet_set(side).unwrap().len());
    assert_eq!(named.sum::<usize>(), part.boundary_facets().len());
}

/// A box beside the mesh is refused with its bounds.
#[test]
fn an_empty_box_is_refused() {
    let mesh = block(Mesh::box_of_hexes);
    let refused = mesh.within(&Vec3::repeat(9.0), &Vec3::repeat(10.0));
    let Err(MeshError::NothingWithin { low, high }) = refused else {
        panic!("{refused:?}");
    };
    assert_eq!((low, high), ([9.0; 3], [10.0; 3]));
    assert!(mesh.within(&Vec3::repeat(2.0), &Vec3::repeat(1.0)).is_err());
    assert!(matches!(mesh.of_elements(&[]), Err(MeshError::Empty)));
    let beyond = mesh.of_elements(&[3, 999]);
    assert!(matches!(
        beyond,
        Err(MeshError::SetOutOfRange { number: 999, .. })
    ));
    let any_order = mesh.of_elements(&[7, 3, 3]).unwrap();
    assert_eq!(any_order.element_set("rock").unwrap(), [0, 1]);
}
