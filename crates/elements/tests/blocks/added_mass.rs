//! Added mass of water beside facets, against integrals in closed form.

use core::f64::consts::{PI, TAU};

use nalgebra::{Rotation3, Unit};
use powerhouse_elements::{FaceMass, WaterMass};
use powerhouse_model::{ElementKind, EngineError, Facet, Mat3, Mesh, ParameterError, Vec3};

use super::water::element;

const DENSITY: f64 = 1025.0;

fn westergaard(level: f64, depth: f64) -> WaterMass {
    WaterMass::Westergaard {
        density: DENSITY,
        level,
        depth,
    }
}

fn sum(mass: &FaceMass) -> Mat3 {
    mass.masses().iter().map(|node| node.mass).sum()
}

/// Horizontal width of a convex polygon at a height (m), given as pairs of a horizontal and a vertical coordinate in its plane.
fn width(face: &[[f64; 2]], height: f64) -> f64 {
    let mut across = Vec::new();
    for (i, &[a, z]) in face.iter().enumerate() {
        let [b, to] = face[(i + 1) % face.len()];
        if (z <= height) != (to <= height) {
            across.push(a + (b - a) * (height - z) / (to - z));
        }
    }
    match across[..] {
        [one, other] => (one - other).abs(),
        _ => 0.0,
    }
}

/// `integral of sqrt(depth) dA` over the part of a polygon below a level; between the heights of its corners the width is
/// linear.
fn root_integral(face: &[[f64; 2]], level: f64) -> f64 {
    let mut heights: Vec<f64> = face.iter().map(|corner| corner[1]).collect();
    heights.push(level);
    heights.retain(|height| *height <= level);
    heights.sort_by(f64::total_cmp);
    let part = |pair: &[f64]| {
        let [low, high] = [pair[0], pair[1]];
        if high - low < 1e-12 {
            return 0.0;
        }
        let at = |share: f64| width(face, low + share * (high - low));
        let slope = (at(0.75) - at(0.25)) / (0.5 * (high - low));
        let at_low = at(0.25) - 0.25 * slope * (high - low);
        // width = c - slope * depth, with c at the level.
        let c = at_low + slope * (level - low);
        let upper = |depth: f64| c / 1.5 * depth.powf(1.5) - slope / 2.5 * depth.powf(2.5);
        upper(level - low) - upper(level - high)
    };
    heights.windows(2).map(part).sum()
}

/// On a wall of any direction the mass is `7/12 rho H^2` per width, wherever the level cuts the facets, and all of it acts
/// along the normal.
#[test]
fn a_wall_has_seven_twelfths_of_the_square_of_the_depth() {
    for (turn, counts, level) in [
        (0.0, [1, 3, 20], 20.0),
        (0.7, [2, 2, 7], 17.3),
        (-2.1, [1, 1, 5], 11.0),
        (0.3, [1, 4, 3], 0.4),
    ] {
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 6.0, 20.0), counts, "wall");
        let turn = Rotation3::from_axis_angle(&Vec3::z_axis(), turn);
        let mesh = mesh.unwrap().map_positions(|x| turn * x).unwrap();
        for (side, normal) in [("left", -Vec3::x()), ("back", Vec3::y())] {
            let normal = turn * normal;
            let facets = mesh.facet_set(side).unwrap();
            let mass = FaceMass::new(&mesh, facets, &westergaard(level, level)).unwrap();
            let across = if side == "left" { 6.0 } else { 2.0 };
            let exact = 7.0 / 12.0 * DENSITY * level * level * across;
            assert!((mass.total() / exact - 1.0).abs() < 1e-12, "{side} {level}");
            assert!((mass.area() / (level * across) - 1.0).abs() < 1e-12);
            let error = sum(&mass) - normal * normal.transpose() * exact;
            assert!(error.amax() < 1e-12 * exact, "{error}");
            // The first moment: H y sqrt(y) over y is 2/5 H^3.
            let moment: f64 = (mass.masses().iter())
                .map(|node| node.mass.trace() * (level - mesh.positions()[node.node as usize].z))
                .sum();
            let exact = 0.875 * DENSITY * 0.4 * level.powi(3) * across;
            assert!(
                (moment / exact - 1.0).abs() < 1e-12,
                "{side} {level}: {moment}"
            );
        }
    }
}

/// On facets of any shape, vertical or inclined and turned, the mass is the integral over the part below the level, and each
/// node's matrix has the normal alone. `1e-5` of the mass of a facet is the error of the Gauss points where the level passes
/// a corner.
#[test]
fn facets_of_any_shape_have_the_mass_of_their_part_below_the_level() {
    let faces: [&[[f64; 2]]; 6] = [
        &[[0.0, 0.0], [2.0, 0.3], [0.4, 3.0]],
        &[[0.0, 3.0], [-1.0, 1.0], [2.0, 0.0]],
        &[[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]],
        &[[0.0, 0.0], [2.0, 1.0], [2.5, 3.0], [0.5, 2.0]],
        &[[0.0, 0.0], [3.0, 0.0], [1.0, 3.0], [0.5, 3.0]],
        &[[0.0, 0.0], [2.0, 0.7], [1.5, 3.0], [-0.5, 1.0]],
    ];
    for face in faces {
        for [lean, turn] in [[0.0, 0.0], [0.4, 0.3], [1.1, -0.7]] {
            let (sin, cos) = f64::sin_cos(turn);
            let place = |[a, b]: &[f64; 2]| {
                let x = Vec3::new(*a, b * f64::sin(lean), b * f64::cos(lean));
                Vec3::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z)
            };
            let corners: Vec<Vec3> = face.iter().map(place).collect();
            let mesh = element(&corners);
            let normal = (corners[1] - corners[0])
                .cross(&(corners[2] - corners[0]))
                .normalize();
            let vertical: Vec<[f64; 2]> = face.iter().map(|[a, b]| [*a, b * lean.cos()]).collect();
            let facets = mesh.facet_set("face").unwrap();
            for step in 1..=24 {
                let level = 0.137 * f64::from(step);
                let water = westergaard(level, 40.0);
                let mass = FaceMass::new(&mesh, facets, &water).unwrap();
                let factor = 0.875 * DENSITY * 40.0_f64.sqrt() / lean.cos();
                let exact = factor * root_integral(&vertical, level);
                let error = (mass.total() - exact) / exact;
                assert!(error.abs() < 1e-5, "{face:?} {lean} {level}: {error:e}");
                let error = sum(&mass) - normal * normal.transpose() * mass.total();
                assert!(error.amax() < 1e-12 * mass.total(), "{error}");
                for node in mass.masses() {
                    let across = node.mass - normal * normal.transpose() * node.mass.trace();
                    assert!(across.amax() < 1e-12 * mass.total());
                    assert!(node.mass.trace() > 0.0);
                }
            }
        }
    }
}

/// A table is integrated exactly, its rows within facets and at their edges, on bricks, tetrahedra and tetrahedra of second
/// order; a uniform one is the area times the mass.
#[test]
fn a_table_is_integrated_row_by_row() {
    let high = Vec3::new(1.0, 2.0, 6.0);
    let tets = || Mesh::box_of_tets(Vec3::zeros(), high, [1, 2, 4], "wall").unwrap();
    let meshes = [
        Mesh::box_of_hexes(Vec3::zeros(), high, [1, 2, 4], "wall").unwrap(),
        tets(),
        tets().with_midpoints().unwrap(),
    ];
    for mesh in meshes {
        let facets = mesh.boundary_facets();
        let on_side = |facet: &Facet| mesh.facet_geometry(*facet).normal().x > 0.9;
        let facets: Vec<Facet> = facets.into_iter().filter(on_side).collect();
        let table = |level: f64, depths: &[f64], masses: &[f64]| {
            let (depths, masses) = (depths.to_vec(), masses.to_vec());
            let water = WaterMass::Table {
                level,
                depths,
                masses,
            };
            FaceMass::new(&mesh, &facets, &water).unwrap()
        };
        let mass = table(5.2, &[0.0, 0.7, 3.0, 5.2], &[0.0, 900.0, 400.0, 1000.0]);
        let exact = 2.0 * (0.5 * 0.7 * 900.0 + 0.5 * 2.3 * 1300.0 + 0.5 * 2.2 * 1400.0);
        assert!(
            (mass.total() / exact - 1.0).abs() < 1e-12,
            "{}",
            mass.total()
        );
        assert!((mass.along_axes()[0] / exact - 1.0).abs() < 1e-12);
        assert!(mass.along_axes()[1..].iter().all(|across| *across < 1e-20));
        let mass = table(9.0, &[0.0, 20.0], &[750.0, 750.0]);
        assert!((mass.total() / (750.0 * 12.0) - 1.0).abs() < 1e-12);
        assert!((mass.area() / 12.0 - 1.0).abs() < 1e-12);
    }
}

/// Ring of bricks around an axis, from one radius to another; facet sets `inner` and `outer`.
fn ring(count: usize, [inner, outer]: [f64; 2], turn: &Rotation3<f64>) -> Mesh {
    let mut builder = Mesh::builder();
    let tag = |i: usize, j: usize, k: usize| (1 + i % count + count * (j + 2 * k)) as u64;
    for k in 0..2 {
        for (j, radius) in [inner, outer].into_iter().enumerate() {
            for i in 0..count {
                let (sin, cos) = (TAU * i as f64 / count as f64).sin_cos();
                let x = Vec3::new(radius * cos, radius * sin, 3.0 * k as f64);
                builder.node(tag(i, j, k), turn * x);
            }
        }
    }
    for i in 0..count {
        let c = [
            tag(i, 0, 0),
            tag(i, 1, 0),
            tag(i + 1, 1, 0),
            tag(i + 1, 0, 0),
            tag(i, 0, 1),
            tag(i, 1, 1),
            tag(i + 1, 1, 1),
            tag(i + 1, 0, 1),
        ];
        builder.element(i as u64 + 1, ElementKind::Hex8, &c, &["wall"]);
        builder.facet("inner", &[c[0], c[3], c[7], c[4]]);
        builder.facet("outer", &[c[1], c[2], c[6], c[5]]);
    }
    builder.build().unwrap()
}

/// The mass of a conduit of any direction that moves across its axis is that of its water, and along its axis there is none.
/// Facets that bulge into the water, of another diameter or of one plane are refused.
#[test]
fn a_conduit_has_the_mass_of_its_water() {
    let axis = Unit::new_normalize(Vec3::new(1.0, -0.3, 0.5));
    for (count, angle) in [(12, 0.0), (32, 1.1), (64, -0.4)] {
        let turn = Rotation3::from_axis_angle(&axis, angle);
        // The facets touch the circle with the diameter 5 m.
        let radius = 2.5 / (PI / count as f64).cos();
        let mesh = ring(count, [radius, 4.0], &turn);
        let water = |diameter: f64| WaterMass::Conduit {
            density: DENSITY,
            diameter,
        };
        let inner = mesh.facet_set("inner").unwrap();
        let mass = FaceMass::new(&mesh, inner, &water(5.0)).unwrap();
        // A regular polygon around a circle has the area of its perimeter times half the radius.
        let exact = DENSITY * count as f64 * 2.5 * 2.5 * (PI / count as f64).tan() * 3.0;
        let along = turn * Vec3::z();
        let expected = (Mat3::identity() - along * along.transpose()) * exact;
        let error = (sum(&mass) - expected).amax() / exact;
        assert!(error < 1e-12, "{count}: {error:e}");
        for (set, diameter, found) in [
            ("outer", 8.0, -8.0 * (PI / count as f64).cos()),
            ("inner", 6.3, 5.0),
            ("inner", 4.1, 5.0),
        ] {
            let facets = mesh.facet_set(set).unwrap();
            let error = FaceMass::new(&mesh, facets, &water(diameter)).unwrap_err();
            let EngineError::OtherDiameter { found: own, given } = error else {
                panic!("{error}");
            };
            assert!((own / found - 1.0).abs() < 1e-12, "{set} {own} {found}");
            assert_eq!(given, diameter);
        }
        let one = FaceMass::new(&mesh, &inner[..1], &water(5.0)).unwrap_err();
        assert!(matches!(one, EngineError::OtherDiameter { found, .. } if found == f64::INFINITY));
    }
}

/// Whatever has no meaning is refused with its value.
#[test]
fn a_mass_that_has_no_meaning_is_refused() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(1.0, 2.0, 6.0), [1, 2, 3], "wall");
    let mesh = mesh.unwrap();
    let refused = |facets: &[Facet], water: &WaterMass| {
        FaceMass::new(&mesh, facets, water).expect_err("it should be refused")
    };
    let side = mesh.facet_set("left").unwrap();
    let deep = refused(side, &westergaard(6.0, 5.5));
    let (depth, most) = (6.0, 5.5);
    let element = mesh.element_tags()[side[0].element as usize];
    assert_eq!(
        deep,
        EngineError::TooDeep {
            element,
            depth,
            most
        }
    );
    let dry = refused(side, &westergaard(0.0, 5.0));
    let (count, level) = (6, 0.0);
    assert_eq!(dry, EngineError::DryFacets { count, level });
    let inside = mesh.element_set("wall").unwrap();
    let all: Vec<Facet> = (inside.iter())
        .flat_map(|&element| (0..6).map(move |side| Facet { element, side }))
        .collect();
    let error = refused(&all, &westergaard(6.0, 6.0));
    assert!(matches!(error, EngineError::BothSides { .. }), "{error}");
    let parameter = |error: EngineError| match error {
        EngineError::Parameter(ParameterError { name, value, .. }) => (name, value),
        other => panic!("{other}"),
    };
    for (water, expected) in [
        (westergaard(f64::NAN, 6.0), "level"),
        (westergaard(6.0, 0.0), "depth"),
    ] {
        assert_eq!(parameter(refused(side, &water)).0, expected);
    }
    let (density, diameter) = (-1.0, 3.0);
    let conduit = WaterMass::Conduit { density, diameter };
    assert_eq!(parameter(refused(side, &conduit)), ("density", -1.0));
    let table = |depths: &[f64], masses: &[f64]| {
        let (level, depths, masses) = (6.0, depths.to_vec(), masses.to_vec());
        parameter(refused(
            side,
            &WaterMass::Table {
                level,
                depths,
                masses,
            },
        ))
    };
    assert_eq!(table(&[0.0], &[1.0]), ("number of depths", 1.0));
    assert_eq!(table(&[0.0, 6.0], &[1.0]), ("number of masses", 1.0));
    assert_eq!(table(&[0.5, 6.0], &[1.0, 2.0]), ("first depth", 0.5));
    assert_eq!(table(&[0.0, 3.0, 3.0], &[1.0; 3]), ("depth", 3.0));
    assert_eq!(table(&[0.0, 6.0], &[1.0, -2.0]), ("mass", -2.0));
}
