//! Pairs from the facets of a mesh.

use powerhouse_contact::{ContactError, JointSurface, SurfaceOptions};
use powerhouse_model::{JointPair, Mesh, Vec3};

fn options() -> SurfaceOptions {
    SurfaceOptions::within(1e-6).unwrap()
}

fn chosen(mesh: &Mesh, condition: impl Fn(Vec3) -> bool) -> Vec<u32> {
    (0..mesh.element_count() as u32)
        .filter(|&e| condition(mesh.centroid(e)))
        .collect()
}

/// The surface between two parts of a mesh, cut open.
fn cut(mesh: &Mesh, first: impl Fn(Vec3) -> bool) -> (Mesh, JointSurface) {
    let (first, second) = (chosen(mesh, &first), chosen(mesh, |c| !first(c)));
    let split = mesh.split_between(&first, &second).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options());
    (split.mesh, surface.unwrap())
}

/// A plane cut gives each node one pair, with the plane's normal and its share of the area.
#[test]
fn a_plane_joint_has_one_pair_per_node() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 2.0, 3.0), [2, 2, 3], "rock");
    let (mesh, surface) = cut(&mesh.unwrap(), |c| c.z < 1.0);
    assert_eq!((surface.pairs.len(), surface.facets.len()), (9, 4));
    assert!((surface.area() - 4.0).abs() < 1e-14);
    assert_eq!(surface.worst_gap, 0.0);
    for pair in &surface.pairs {
        assert!((pair.normal - Vec3::z()).norm() < 1e-15);
        let [a, b] = pair.nodes.map(|node| mesh.positions()[node as usize]);
        assert_eq!(a, b);
        let edges = [a.x, a.y].iter().filter(|&&x| x == 0.0 || x == 2.0).count();
        assert!((pair.area - 0.5_f64.powi(edges as i32)).abs() < 1e-15);
    }
    let corners = surface
        .facets
        .iter()
        .flat_map(|facet| facet.nodes.iter().zip(&facet.pairs));
    for (node, pair) in corners {
        assert_eq!(surface.pairs[pair.unwrap() as usize].nodes[0], *node);
    }
}

/// A plane cut through tetrahedra with midpoints gives each node one pair, whose area is a twelfth of that of its facets at
/// corners and a quarter at midpoints, and whose neighbours are half an edge away.
#[test]
fn midpoints_have_their_pairs() {
    let mesh = Mesh::box_of_tets(Vec3::zeros(), Vec3::new(2.0, 2.0, 3.0), [2, 2, 3], "rock");
    let (mesh, surface) = cut(&mesh.unwrap().with_midpoints().unwrap(), |c| c.z < 1.0);
    assert_eq!((surface.pairs.len(), surface.facets.len()), (25, 8));
    assert!((surface.area() - 4.0).abs() < 1e-14);
    assert!((surface.shortest_edge(&mesh) - 0.5).abs() < 1e-15);
    for pair in &surface.pairs {
        assert!((pair.normal - Vec3::z()).norm() < 1e-15);
        let [a, b] = pair.nodes.map(|node| mesh.positions()[node as usize]);
        assert_eq!(a, b);
        let is_corner = [a.x, a.y].iter().all(|x| x.fract() == 0.0);
        let facets = surface
            .facets
            .iter()
            .filter(|facet| facet.nodes.contains(&pair.nodes[0]));
        let share = if is_corner { 12.0 } else { 4.0 };
        assert!((pair.area - 0.5 * facets.count() as f64 / share).abs() < 1e-15);
        assert!((0.5..0.75).contains(&pair.spacing), "{}", pair.spacing);
    }
}

/// A cube inside another has, on its edges and corners, one pair for each of its faces that meet
/// there: 6 faces of 9 nodes. With an angle of 90 degrees it has one for each node.
#[test]
fn edges_and_corners_have_a_pair_for_each_patch() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(4.0), [4; 3], "rock").unwrap();
    let inside = |c: Vec3| (c - Vec3::repeat(2.0)).amax() < 1.0;
    let (_, surface) = cut(&mesh, |c| !inside(c));
    assert_eq!(surface.pairs.len(), 6 * 9);
    assert!((surface.area() - 24.0).abs() < 1e-13);
    for pair in &surface.pairs {
        assert!((pair.normal.amax() - 1.0).abs() < 1e-15);
    }
    let (first, second) = (chosen(&mesh, |c| !inside(c)), chosen(&mesh, inside));
    let split = mesh.split_between(&first, &second).unwrap();
    let smooth = SurfaceOptions::new(1e-6, core::f64::consts::FRAC_PI_2).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &smooth).unwrap();
    assert_eq!(surface.pairs.len(), 26);
    assert!((surface.area() - 24.0).abs() < 1e-13);
}

/// On a cylinder of 24 facets normals are averaged: radial to the rounding of the mesh, out of the
/// first side, and areas add up to the facets'.
#[test]
fn a_curved_joint_has_radial_normals() {
    let flat = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(1.0, 24.0, 1.0), [2, 24, 1], "rock");
    let wrapped = flat.unwrap().map_positions(|p| {
        let angle = p.y / 24.0 * 1.8 * core::f64::consts::PI;
        Vec3::new(0.0, 0.0, p.z) + Vec3::new(angle.cos(), angle.sin(), 0.0) * (2.0 + p.x)
    });
    let (mesh, surface) = cut(&wrapped.unwrap(), |c| c.xy().norm() < 2.5);
    assert_eq!(surface.pairs.len(), 2 * 25);
    let half = 0.9 * core::f64::consts::PI / 24.0;
    let length = 24.0 * 2.0 * 2.5 * half.sin();
    assert!((surface.area() - length).abs() < 1e-12);
    for pair in &surface.pairs {
        let position = mesh.positions()[pair.nodes[0] as usize];
        let radial = Vec3::new(position.x, position.y, 0.0).normalize();
        // At both ends of the arc there is one facet alone, tilted by half the angle.
        let tilt = pair.normal.dot(&radial).clamp(-1.0, 1.0).acos();
        assert!(tilt < 1e-7 || (tilt - half).abs() < 1e-7, "{tilt}");
    }
}

/// Where the joint ends inside the body its last nodes are shared and have no pair.
#[test]
fn a_tip_has_no_pair() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(2.0), [2; 3], "rock").unwrap();
    let first = chosen(&mesh, |c| c.x < 1.0 && c.z < 1.0);
    let second = chosen(&mesh, |c| c.x > 1.0 && c.z < 1.0);
    let split = mesh.split_between(&first, &second).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options());
    let surface = surface.unwrap();
    assert_eq!(surface.pairs.len(), 3);
    let tips = surface
        .facets
        .iter()
        .flat_map(|facet| &facet.pairs)
        .filter(|p| p.is_none());
    assert_eq!(tips.count(), 4);
}

/// Sides that are meshed apart are matched within the tolerance; the worst gap is named, and what
/// does not match is refused with the facet that is farthest off.
#[test]
fn sides_meshed_apart_are_matched() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 2.0, 2.0), [2; 3], "rock").unwrap();
    let (below, above) = (chosen(&mesh, |c| c.z < 1.0), chosen(&mesh, |c| c.z > 1.0));
    let split = mesh.split_between(&below, &above).unwrap();
    let copies: Vec<u32> = split.copies.iter().map(|[_, copy]| *copy).collect();
    let moved = |by: f64| {
        let mut index = 0;
        let shift = |p: Vec3| {
            let copy = copies.contains(&index);
            index += 1;
            if copy && p.x == 2.0 && p.y == 2.0 {
                p + Vec3::x() * by
            } else {
                p
            }
        };
        let shift = std::cell::RefCell::new(shift);
        split
            .mesh
            .clone()
            .map_positions(|p| (shift.borrow_mut())(p))
            .unwrap()
    };
    let between =
        |mesh: &Mesh| JointSurface::between(mesh, &split.first, &split.second, &options());
    let near = moved(1e-7);
    let surface = between(&near).unwrap();
    assert!((surface.worst_gap - 1e-7).abs() < 1e-15);
    let worst = split
        .copies
        .iter()
        .find(|[node, _]| mesh.positions()[*node as usize] == Vec3::new(2.0, 2.0, 1.0));
    let tags = worst.unwrap().map(|node| near.node_tags()[node as usize]);
    assert_eq!(surface.worst_nodes, tags);

    let error = between(&moved(0.1)).unwrap_err();
    assert!(
        matches!(error, ContactError::Unmatched { element: 4, nearest: 8, distance, .. }
            if (distance - 0.025).abs() < 1e-12),
        "{error}"
    );
    let part = JointSurface::between(&split.mesh, &split.first[..3], &split.second, &options());
    assert!(matches!(
        part,
        Err(ContactError::Unmatched { element: 8, .. })
    ));
    assert_eq!(
        JointSurface::between(&split.mesh, &[], &split.second, &options()),
        Err(ContactError::Empty)
    );
}

/// Where the ends of a joint move as one, one pair has the area of both ends; what faces elsewhere at
/// the same nodes stays a pair of its own.
#[test]
fn pairs_that_move_as_one_are_one() {
    let size = Vec3::new(3.0, 2.0, 3.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [3, 2, 3], "rock");
    // A bench: its floor, and its wall at x = 1.
    let (mesh, surface) = cut(&mesh.unwrap(), |c| c.z < 1.0 || c.x < 1.0);
    let position = |node: u32| mesh.positions()[node as usize];
    let before = surface.clone();
    // The far face goes with the near one, side by side: here cut nodes of a side keep their order.
    let lead = |node: u32| {
        let at = position(node);
        if at.y < 2.0 {
            return node;
        }
        let near = Vec3::new(at.x, 0.0, at.z);
        let of_side = |n: &u32| {
            let pairs = before.pairs.iter();
            let sides = pairs.flat_map(|pair| pair.nodes.into_iter().enumerate());
            sides
                .filter(|(_, other)| other == n)
                .map(|(side, _)| side)
                .next()
        };
        let nodes = 0..mesh.node_count() as u32;
        let mut same = nodes.filter(|&n| (position(n) - near).norm() < 1e-9);
        same.find(|n| of_side(n) == of_side(&node)).unwrap()
    };
    let united = surface.united(lead);
    assert!((united.area() - before.area()).abs() < 1e-12);
    let plain = |pairs: &[JointPair], y: f64| {
        let at = |pair: &&JointPair| (position(pair.nodes[0]).y - y).abs() < 1e-9;
        pairs.iter().filter(at).count()
    };
    assert_eq!(plain(&united.pairs, 2.0), 0);
    assert_eq!(plain(&united.pairs, 0.0), plain(&before.pairs, 0.0));
    assert!(united.pairs.is_sorted_by_key(|pair| pair.nodes));
    for pair in &united.pairs {
        let axis = pair.normal.iamax();
        assert!(axis != 1 && (pair.normal[axis].abs() - 1.0).abs() < 1e-12);
        // No pair is on the far face, and inner ones and the near ones now have whole widths in y.
        let at = position(pair.nodes[0]);
        // The wall goes up from z = 1 to 3, the floor from x = 1 to 3.
        let along = if axis == 0 { at.z } else { at.x };
        let half = (along - 1.0).abs() < 1e-9 || (along - 3.0).abs() < 1e-9;
        let expected = if half { 0.5 } else { 1.0 };
        assert!((pair.area - expected).abs() < 1e-12, "{pair:?}");
    }
    for (facet, old) in united.facets.iter().zip(&before.facets) {
        for (pair, was) in facet.pairs.iter().zip(&old.pairs) {
            let pair = &united.pairs[pair.unwrap() as usize];
            let was = &before.pairs[was.unwrap() as usize];
            assert_eq!(pair.nodes, was.nodes.map(lead));
            assert!(pair.normal.dot(&was.normal) > 0.99);
        }
    }
}

/// On a joint of facets at an angle to each other normals times projected areas add up to the vector areas
/// of the facets, so that a uniform pressure is in balance, and areas to their areas.
#[test]
fn projected_areas_add_up_to_the_vector_area() {
    for (rise, direction) in [(0.3, 0), (0.15, 1), (0.0, 0)] {
        let counts = [4, 4, 2];
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 4.0, 2.0), counts, "rock");
        let vaulted = |p: Vec3| {
            let place = p[direction];
            p + Vec3::z() * (rise * place * (4.0 - place) * p.z * (2.0 - p.z))
        };
        let mesh = mesh.unwrap().map_positions(vaulted).unwrap();
        let low: Vec<u32> = (0..16).collect();
        let high: Vec<u32> = (16..32).collect();
        let split = mesh.split_between(&low, &high).unwrap();
        let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options());
        let surface = surface.unwrap();
        let facets = split
            .first
            .iter()
            .map(|&facet| split.mesh.facet_geometry(facet));
        let (mut sum, mut area) = (Vec3::zeros(), 0.0);
        for facet in facets {
            sum += facet.vector_area;
            area += facet.vector_area.norm();
        }
        let pairs = surface.pairs.iter();
        let found: Vec3 = pairs.map(|pair| pair.normal * pair.projected_area).sum();
        assert!((found - sum).norm() < 1e-12 * area, "{found} {sum}");
        assert!((surface.area() - area).abs() < 1e-12 * area);
        let least = surface
            .pairs
            .iter()
            .map(|pair| pair.projected_area / pair.area);
        let least = least.fold(f64::INFINITY, f64::min);
        assert_eq!(least < 1.0, rise > 0.0, "{least}");
    }
}

/// Facets of which a side is absent are left out: beside an excavated room on either side, and where nothing is left.
#[test]
fn facets_need_both_sides() {
    // Two slabs of 4 by 3 bricks, one on the other.
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 3.0, 2.0), [4, 3, 2], "rock");
    let (mesh, surface) = cut(&mesh.unwrap(), |c| c.z < 1.0);
    let count = |is_present: &dyn Fn(Vec3) -> bool| {
        let elements = 0..mesh.element_count() as u32;
        let present: Vec<bool> = elements.map(|e| is_present(mesh.centroid(e))).collect();
        surface.present_facets(&mesh, &present).len()
    };
    assert_eq!(count(&|_| true), 12);
    // A row of three on the first side, a brick inside on the second, each side as a whole.
    assert_eq!(count(&|at| at.z > 1.0 || at.x > 1.0), 9);
    let brick = Vec3::new(1.5, 1.5, 1.5);
    assert_eq!(count(&|at| (at - brick).norm() > 0.1), 11);
    assert_eq!(count(&|at| at.z < 1.0), 0);
    assert_eq!(count(&|at| at.z > 1.0), 0);
}
