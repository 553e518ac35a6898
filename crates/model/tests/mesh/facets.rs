use powerhouse_model::{Axis, ElementKind, Facet, Mat3, Mesh, Vec3};

use super::{GENERATORS, noise3, rough_block, volume};

/// Vector areas of a closed surface add up to nothing, and so do their moments, on distorted
/// meshes of every kind and around a void; the moments with x give the volume.
#[test]
fn a_closed_surface_has_no_resultant() {
    for (_, generator) in GENERATORS {
        let whole = rough_block(generator, 0.15);
        let void = whole.elements_in_box(&Vec3::new(1.0, 1.0, 1.0), &Vec3::new(3.0, 3.0, 2.0));
        let hollow = without(&whole, &void);
        for mesh in [&whole, &hollow] {
            let (mut resultant, mut moment, mut tensor) =
                (Vec3::zeros(), Vec3::zeros(), Mat3::zeros());
            for facet in mesh.boundary_facets() {
                let geometry = mesh.facet_geometry(facet);
                resultant += geometry.vector_area;
                for (&node, share) in geometry.nodes.iter().zip(&geometry.shares) {
                    let position = mesh.positions()[node as usize];
                    moment += position.cross(share);
                    tensor += position * share.transpose();
                }
            }
            let inside: f64 = (0..mesh.element_count() as u32)
                .map(|e| volume(mesh, e))
                .sum();
            assert!(resultant.norm() < 1e-12);
            assert!(moment.norm() < 1e-12);
            assert!((tensor - Mat3::identity() * inside).norm() < 1e-12 * inside);
        }
    }
}

/// The same mesh without some of its elements and without the nodes that they leave behind.
fn without(mesh: &Mesh, removed: &[u32]) -> Mesh {
    let kept: Vec<u32> = (0..mesh.element_count() as u32)
        .filter(|e| !removed.contains(e))
        .collect();
    assert!(!removed.is_empty() && !kept.is_empty());
    let mut builder = Mesh::builder();
    for node in mesh.nodes_of_elements(&kept) {
        builder.node(u64::from(node), mesh.positions()[node as usize]);
    }
    for element in kept {
        let nodes: Vec<u64> = mesh.nodes_of(element).iter().map(|&n| n.into()).collect();
        builder.element(element.into(), mesh.kind(element), &nodes, &["rock"]);
    }
    builder.build().unwrap()
}

/// Shares of a warped quadrilateral are the exact integrals, by a rule of higher order.
#[test]
fn shares_of_a_warped_facet_are_exact() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(1.0), [1, 1, 1], "rock").unwrap();
    let mesh = mesh
        .map_positions(|p| p + 0.2 * noise3((p.x + 2.0 * p.y + 4.0 * p.z) as u64))
        .unwrap();
    // Gauss points of three, on [-1, 1].
    let rule = [
        (-(0.6_f64.sqrt()), 5.0 / 9.0),
        (0.0, 8.0 / 9.0),
        (0.6_f64.sqrt(), 5.0 / 9.0),
    ];
    for side in 0..6 {
        let geometry = mesh.facet_geometry(Facet { element: 0, side });
        let x: Vec<Vec3> = geometry
            .nodes
            .iter()
            .map(|&n| mesh.positions()[n as usize])
            .collect();
        let mut exact = [Vec3::zeros(); 4];
        for (r, wr) in rule {
            for (s, ws) in rule {
                let by_r = 0.25 * ((1.0 - s) * (x[1] - x[0]) + (1.0 + s) * (x[2] - x[3]));
                let by_s = 0.25 * ((1.0 - r) * (x[3] - x[0]) + (1.0 + r) * (x[2] - x[1]));
                let shape = [
                    (1.0 - r) * (1.0 - s),
                    (1.0 + r) * (1.0 - s),
                    (1.0 + r) * (1.0 + s),
                    (1.0 - r) * (1.0 + s),
                ];
                for a in 0..4 {
                    exact[a] += by_r.cross(&by_s) * (0.25 * shape[a] * wr * ws);
                }
            }
        }
        let warp = (x[2] - x[0])
            .cross(&(x[3] - x[1]))
            .normalize()
            .dot(&(x[1] - x[0]));
        assert!(warp.abs() > 1e-3, "the facet is plane");
        for a in 0..4 {
            assert!((geometry.shares[a] - exact[a]).norm() < 1e-15);
        }
        // The vector area is half the cross product of the diagonals, warped or not.
        let diagonals = 0.5 * (x[2] - x[0]).cross(&(x[3] - x[1]));
        assert!((geometry.vector_area - diagonals).norm() < 1e-15);
    }
}

/// Tributary areas add up to the area of the face, also where the face is folded, and the normals
/// are those of the faces inside and bisect them on the fold.
#[test]
fn tributary_areas_add_up_to_the_area() {
    for (_, generator) in GENERATORS {
        let mesh = generator(Vec3::zeros(), Vec3::new(5.0, 4.0, 3.0), [5, 4, 3], "rock").unwrap();
        let top = mesh.tributary_areas(mesh.facet_set("top").unwrap());
        assert_eq!(top.len(), 30);
        assert!((top.iter().map(|t| t.area).sum::<f64>() - 20.0).abs() < 1e-13);
        assert!(top.iter().all(|t| (t.normal - Vec3::z()).norm() < 1e-15));
        let folded = [
            mesh.facet_set("top").unwrap(),
            mesh.facet_set("right").unwrap(),
        ]
        .concat();
        let folded = mesh.tributary_areas(&folded);
        assert!((folded.iter().map(|t| t.area).sum::<f64>() - 32.0).abs() < 1e-13);
        let bisector = (Vec3::x() + Vec3::z()).normalize();
        let edge = folded
            .iter()
            .find(|t| mesh.positions()[t.node as usize] == Vec3::new(5.0, 2.0, 3.0));
        let tilt = edge.unwrap().normal.dot(&bisector);
        assert!((tilt - 1.0).abs() < 0.02, "{tilt}");
    }
    // On a plane face of unequal quadrilaterals a node has as much surface as vector area.
    let tapered = rough_block(Mesh::box_of_hexes, 0.2).map_positions(|p| {
        let plane = if p.z < 0.5 { 0.0 } else { p.z };
        Vec3::new(p.x, p.y, plane)
    });
    let tapered = tapered.unwrap();
    for &facet in tapered.facet_set("bottom").unwrap() {
        let geometry = tapered.facet_geometry(facet);
        for (share, area) in geometry.shares.iter().zip(&geometry.areas) {
            assert!((share.norm() - area).abs() < 1e-15);
        }
    }
    // A face seen from both sides has area, but no direction.
    let mesh =
        Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 1.0, 1.0), [2, 1, 1], "rock").unwrap();
    let both = [
        Facet {
            element: 0,
            side: 3,
        },
        Facet {
            element: 1,
            side: 5,
        },
    ];
    for tributary in mesh.tributary_areas(&both) {
        assert_eq!(tributary.normal, Vec3::zeros());
        assert!((tributary.area - 0.5).abs() < 1e-15);
    }
}

/// Facets on a plane are the surface there, inner sides on the same plane are not.
#[test]
fn facets_on_a_plane_are_surface() {
    for (kind, generator) in GENERATORS {
        let mesh = generator(Vec3::zeros(), Vec3::new(5.0, 4.0, 3.0), [5, 4, 3], "rock").unwrap();
        assert!(mesh.facets_on_plane(Axis::Z, 1.0, 1e-9).is_empty());
        let right = mesh.facets_on_plane(Axis::X, 5.0, 1e-9);
        assert_eq!(right, mesh.facet_set("right").unwrap());
        let area: f64 = right.iter().map(|&f| mesh.facet_geometry(f).area()).sum();
        assert!((area - 12.0).abs() < 1e-13);
        let all = mesh.boundary_facets().len();
        let quads = 2 * (20 + 15 + 12);
        let expected = match kind {
            ElementKind::Tet4 => 2 * quads,
            ElementKind::Wedge6 => quads + 40,
            _ => quads,
        };
        assert_eq!(all, expected);
    }
}
