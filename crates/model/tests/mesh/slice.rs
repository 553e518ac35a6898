//! Slices of meshes that are the same all along an axis.

use powerhouse_model::{Axis, Facet, Mesh, MeshError, Vec3};

use super::GENERATORS;

/// A block of 5 x 4 x 3 m whose nodes are moved across y only, the same in every slice, with its
/// front divided into two sets.
fn bent(generator: super::Generator) -> Mesh {
    let block = generator(Vec3::zeros(), Vec3::new(5.0, 4.0, 3.0), [5, 4, 3], "rock").unwrap();
    let mut mesh = block
        .map_positions(|p| Vec3::new(p.x + 0.1 * (p.x * p.z).sin(), p.y, p.z + 0.05 * p.x.cos()))
        .unwrap();
    let front = mesh.facet_set("front").unwrap().to_vec();
    let is_left = |facet: &Facet| mesh.facet_geometry(*facet).centroid.x < 2.5;
    let (left, right): (Vec<Facet>, Vec<Facet>) = front.iter().partition(|f| is_left(f));
    mesh.set_facet_set("front left", left).unwrap();
    mesh.set_facet_set("front right", right).unwrap();
    mesh
}

/// A slice is one layer with the numbers and sets of the whole, its sides bear the names of the
/// ends, set by set, and volumes are in the ratio of thickness to extent.
#[test]
fn a_slice_is_a_layer_with_the_names_of_the_whole() {
    // Tetrahedra fill cells between two planes too.
    for (kind, generator) in GENERATORS {
        let mesh = bent(generator);
        for at in [0.0, 1.5, 3.999] {
            let slice = mesh.plane_slice(Axis::Y, at).unwrap();
            let (low, high) = slice.bounding_box();
            assert_eq!((low.y, high.y), (at.floor(), at.floor() + 1.0));
            assert_eq!(4 * slice.element_count(), mesh.element_count(), "{kind:?}");
            assert_eq!(
                slice.element_set("rock").unwrap().len(),
                slice.element_count()
            );
            for (tag, position) in slice.node_tags().iter().zip(slice.positions()) {
                let of_whole = mesh.node_tags().iter().position(|other| other == tag);
                assert_eq!(*position, mesh.positions()[of_whole.unwrap()]);
            }
            for set in ["front", "back", "front left", "front right"] {
                let area = |mesh: &Mesh| -> f64 {
                    let facets = mesh.facet_set(set).unwrap().iter();
                    facets.map(|&f| mesh.facet_geometry(f).area()).sum()
                };
                assert!((area(&slice) - area(&mesh)).abs() < 1e-9, "{kind:?} {set}");
                let plane = if set == "back" { high.y } else { low.y };
                for &facet in slice.facet_set(set).unwrap() {
                    let centroid = slice.facet_geometry(facet).centroid;
                    assert!((centroid.y - plane).abs() < 1e-9, "{kind:?} {set}");
                }
            }
            // What runs along the axis keeps its share.
            let part = slice.facet_set("top").unwrap().len();
            assert_eq!(4 * part, mesh.facet_set("top").unwrap().len());
            assert!(slice.check().is_ok());
        }
    }
}

/// A plane outside the mesh, and a mesh that changes along the axis, are refused.
#[test]
fn a_mesh_that_changes_has_no_slice() {
    let size = Vec3::new(5.0, 4.0, 3.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [5, 4, 3], "rock").unwrap();
    for at in [-0.1, 4.0, 4.1, f64::NAN] {
        let refused = mesh.plane_slice(Axis::Y, at);
        assert!(matches!(refused, Err(MeshError::NoSlice { .. })), "{at}");
    }
    // A wedge-shaped box: layers are not plane.
    let fan = mesh
        .clone()
        .map_positions(|p| Vec3::new(p.x, p.y * (1.0 + 0.1 * p.x), p.z));
    let refused = fan.unwrap().plane_slice(Axis::Y, 1.2);
    assert!(matches!(refused, Err(MeshError::NotExtruded { .. })));
    // Plane layers, each smaller than the one before.
    let horn = mesh.map_positions(|p| Vec3::new(p.x * (1.0 - 0.1 * p.y), p.y, p.z));
    let refused = horn.unwrap().plane_slice(Axis::Y, 1.5);
    assert!(
        matches!(refused, Err(MeshError::NotExtruded { share, .. }) if (share - 1.0).abs() > 0.01)
    );
}
