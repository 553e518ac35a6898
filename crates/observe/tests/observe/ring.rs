//! Sections around linings.

use std::f64::consts::{FRAC_PI_2, TAU};

use powerhouse_model::{Cadence, Mesh, Vec3};
use powerhouse_observe::{ObserveError, RingSection, SectionForces, SectionGeometry, SectionRing};

/// Width of the linings (m).
const WIDTH: f64 = 2.0;

/// A closed ring about y of a mean radius and thickness (m), seen from a point at its axis, as two halves with common nodes.
fn ring_mesh(radius: f64, thickness: f64, centre: Vec3) -> Mesh {
    let mut builder = Mesh::builder();
    let around = 48;
    let tag = |i: usize, j: usize, k: usize| (4 * (k % around) + 2 * j + i + 1) as u64;
    for k in 0..around {
        let angle = TAU * k as f64 / around as f64;
        for j in 0..2 {
            for i in 0..2 {
                let r = radius + thickness * (i as f64 - 0.5);
                let at = Vec3::new(r * angle.sin(), WIDTH * j as f64, r * angle.cos());
                builder.node(tag(i, j, k), centre + at);
            }
        }
    }
    for k in 0..around {
        let [a, b] = [k, k + 1];
        let below = [(0, 0, a), (1, 0, a), (1, 1, a), (0, 1, a)];
        let above = [(0, 0, b), (1, 0, b), (1, 1, b), (0, 1, b)];
        let nodes: Vec<u64> = (below.iter().chain(&above))
            .map(|&(i, j, k)| tag(i, j, k))
            .collect();
        builder.element(
            k as u64 + 1,
            powerhouse_model::ElementKind::Hex8,
            &nodes,
            &["lining"],
        );
    }
    builder.build().unwrap()
}

fn sections(mesh: &Mesh, ring: &SectionRing) -> Vec<(RingSection, SectionGeometry)> {
    let all = mesh.element_set("lining").unwrap();
    let mut forces = SectionForces::new(Cadence::Steps(1)).unwrap();
    let found = ring.sections(mesh, all).unwrap().into_iter().map(|of| {
        let geometry = forces.add_section(mesh, &of.section, &of.elements);
        let geometry = geometry.unwrap().clone();
        (of, geometry)
    });
    found.collect()
}

/// Around a circular lining, seen from its axis or from beside it, every section is a single wall of its thickness and width,
/// normal to the circle, and across is towards the centre.
#[test]
fn sections_of_a_circle_are_normal_to_it() {
    let (radius, thickness) = (5.0, 0.5);
    let middle = Vec3::new(30.0, 0.0, -70.0);
    let mesh = ring_mesh(radius, thickness, middle);
    for (beside, rays) in [(Vec3::zeros(), 24), (Vec3::new(0.7, 1.0, -1.1), 36)] {
        let ring = SectionRing::new("lining", middle + beside, -3.0 * Vec3::y(), rays);
        let sections = sections(&mesh, &ring);
        assert_eq!(sections.len(), rays);
        for (index, (of, geometry)) in sections.iter().enumerate() {
            let angle = 360.0 * index as f64 / rays as f64;
            assert!((of.angle - angle).abs() < 1e-9, "{}", of.angle);
            assert_eq!(of.section.name, format!("lining-{angle:03.0}"));
            let [piece] = &geometry.pieces[..] else {
                panic!("{} in {} pieces", geometry.name, geometry.pieces.len());
            };
            // Chords of 7.5 degrees lie within 0.3 % of the circle.
            assert!(
                (piece.area / (thickness * WIDTH) - 1.0).abs() < 0.01,
                "{angle}"
            );
            assert!((geometry.depth / thickness - 1.0).abs() < 0.01);
            assert!((geometry.width / WIDTH - 1.0).abs() < 1e-9);
            let out = geometry.centroid - middle;
            let out = Vec3::new(out.x, 0.0, out.z);
            assert!((out.norm() / radius - 1.0).abs() < 0.005, "{angle}");
            assert!(out.normalize().dot(&geometry.across) < -0.99, "{angle}");
            // Turned about -y from upward: the first ray goes up, the next to negative x.
            let seen = geometry.centroid - ring.centre;
            let turned = (-seen.x).atan2(seen.z).rem_euclid(TAU).to_degrees();
            let off = (turned - angle + 180.0).rem_euclid(360.0) - 180.0;
            assert!(off.abs() < 2.0, "{turned} {angle}");
        }
    }
}

/// Of an arch on two walls without invert, with another lining behind it, rays cut the nearer wall, normal to it, and
/// downward rays nothing.
#[test]
fn nearest_walls_are_cut_normal_to_them() {
    let (radius, height, thickness) = (5.0, 8.0, 0.5);
    let arch = FRAC_PI_2 * 2.0 * radius;
    let length = arch + 2.0 * height;
    let straight = Mesh::box_of_hexes(
        Vec3::zeros(),
        Vec3::new(thickness, WIDTH, length),
        [1, 1, 120],
        "lining",
    )
    .unwrap();
    let mesh = straight
        .map_positions(|at| {
            let out = radius - 0.5 * thickness + at.x;
            let along = at.z - height;
            if along < 0.0 {
                return Vec3::new(out, at.y, along);
            }
            if along > arch {
                return Vec3::new(-out, at.y, arch - along);
            }
            let angle = along / radius;
            Vec3::new(out * angle.cos(), at.y, out * angle.sin())
        })
        .unwrap();
    let ring = SectionRing::new("hall", Vec3::new(0.0, 0.0, -2.0), Vec3::y(), 16);
    let sections = sections(&mesh, &ring);
    // The walls end 6 m below the centre, 5 m beside it: rays steeper than 39.8 degrees from downward meet none.
    let angles: Vec<f64> = sections.iter().map(|(of, _)| of.angle).collect();
    let expected: Vec<f64> = (0..16)
        .map(|ray| 22.5 * f64::from(ray))
        .filter(|angle| (angle - 180.0).abs() > 39.8)
        .collect();
    assert_eq!(angles, expected);
    for (of, geometry) in &sections {
        assert_eq!(geometry.pieces.len(), 1, "{}", of.angle);
        if geometry.centroid.z < -1.5 {
            // A wall: cut level, whatever the slope of the ray.
            assert!(geometry.normal.z.abs() > 0.999, "{}", of.angle);
            assert!((geometry.depth / thickness - 1.0).abs() < 1e-6);
        }
    }
}

/// Rings without a lining, an axis or a permitted number of rays are refused by name.
#[test]
fn rings_without_a_lining_are_refused() {
    let mesh = ring_mesh(5.0, 0.5, Vec3::zeros());
    let all = mesh.element_set("lining").unwrap();
    for (ring, reason) in [
        (
            SectionRing::new("a", Vec3::zeros(), Vec3::zeros(), 8),
            "axis",
        ),
        (
            SectionRing::new("a", Vec3::zeros(), Vec3::y(), 3),
            "4 to 360",
        ),
        (
            SectionRing::new("a", Vec3::zeros(), Vec3::y(), 361),
            "4 to 360",
        ),
    ] {
        let refused = ring.sections(&mesh, all).unwrap_err();
        assert!(matches!(&refused, ObserveError::Ring { ring, .. } if ring == "a"));
        assert!(refused.to_string().contains(reason), "{refused}");
    }
    let ring = SectionRing::new("a", Vec3::zeros(), Vec3::y(), 8);
    let refused = ring.sections(&mesh, &[]).unwrap_err();
    assert!(refused.to_string().contains("no ray"), "{refused}");
}
