use core::f64::consts::PI;

use powerhouse_model::{Cadence, ElasticMedium, Mesh, NodalView, Observer, Precision, Quad, Vec3};
use powerhouse_observe::{
    CrossSection, ObserveError, SectionForces, SectionGeometry, SectionPiece,
};

use super::beam::{Body, KERNELS, Kernel, cut_at, one_point};
use super::{Fields, noise};

fn concrete(poisson: f64) -> ElasticMedium {
    ElasticMedium::new(25.0e9, poisson, 2500.0).unwrap()
}

fn jitter(mesh: Mesh, amount: f64) -> Mesh {
    let shift = |p: &Vec3| {
        let seed = (100.0 * p.x + 1000.0 * p.y + 10_000.0 * p.z + 50_000.0).round() as u64;
        amount * Vec3::new(noise(3 * seed), noise(3 * seed + 1), noise(3 * seed + 2))
    };
    let moved = mesh.map_positions(|p| p + shift(&p)).unwrap();
    moved.with_straight_edges()
}

/// The first six columns for a force and a moment about the centroid.
fn in_axes(geometry: &SectionGeometry, force: &Vec3, moment: &Vec3) -> [f64; 6] {
    let (n, t, b) = (&geometry.normal, &geometry.across, &geometry.along);
    [
        force.dot(n),
        force.dot(t),
        force.dot(b),
        moment.dot(n),
        -moment.dot(b),
        moment.dot(t),
    ]
}

/// Largest deviation of the first six columns over the largest force, and over the largest moment.
fn deviation(found: &[f64], expected: &[f64; 6]) -> (f64, f64) {
    let worst = |range: core::ops::Range<usize>| {
        let scale = range.clone().fold(0.0_f64, |m, i| m.max(expected[i].abs()));
        range.fold(0.0_f64, |m, i| m.max((found[i] - expected[i]).abs())) / scale
    };
    (worst(0..3), worst(3..6))
}

/// A cantilever of solids under known end loads (axial, two shears, torsion, two moments) shows at
/// every cut what balances them, well within 0.5 %: with every kernel, one element thick and
/// finer, distorted, and wherever and however obliquely the plane lies.
#[test]
fn a_cantilever_shows_its_end_loads() {
    for kernel in KERNELS {
        for cells in [[6, 1, 1], [6, 2, 3]] {
            let (low, high) = (Vec3::new(0.0, -1.0, -0.5), Vec3::new(6.0, 1.0, 0.5));
            let mesh = jitter(kernel.mesh(low, high, cells), 0.06);
            let body = Body::new(mesh, kernel, concrete(0.2));
            let held = body
                .mesh
                .nodes_of_facets(body.mesh.facet_set("left").unwrap());
            let loaded = body
                .mesh
                .nodes_of_facets(body.mesh.facet_set("right").unwrap());
            let mut loads = vec![Vec3::zeros(); body.mesh.node_count()];
            for &node in &loaded {
                let p = body.mesh.positions()[node as usize];
                let linear = Vec3::new(2.0 * p.y - 3.0 * p.z, 1.5 * p.z, -p.y);
                loads[node as usize] = 1e5 * (Vec3::new(1.0, -0.3, 0.2) + linear);
            }
            let displacement = body.deflection(&held, &loads);
            // At element sides, inside elements, oblique by 30 degrees.
            let tilted = Vec3::new(3.0_f64.sqrt(), 0.6, -0.8);
            for (x, normal) in [
                (2.0, Vec3::x()),
                (3.3, Vec3::x()),
                (5.0, -Vec3::x()),
                (3.0, tilted),
            ] {
                let cut = CrossSection {
                    normal,
                    ..cut_at(x)
                };
                let mut observer = SectionForces::new(Cadence::Steps(1)).unwrap();
                let geometry = observer
                    .add_section(&body.mesh, &cut, body.elements())
                    .unwrap()
                    .clone();
                let found = body.observed(observer, &displacement);
                // The loads stand on the positive side, or, seen from the other side, pull back.
                let sign = normal.x.signum();
                let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
                for &node in &loaded {
                    let arm = body.mesh.positions()[node as usize] - geometry.centroid;
                    force += sign * loads[node as usize];
                    moment += sign * arm.cross(&loads[node as usize]);
                }
                let expected = in_axes(&geometry, &force, &moment);
                let (forces, moments) = deviation(&found, &expected);
                assert!(
                    forces < 1e-6 && moments < 1e-6,
                    "{kernel:?} {cells:?} {x}: {forces:e} {moments:e}"
                );
                for (per_metre, total) in [(6, 0), (7, 1), (8, 4)] {
                    assert_eq!(found[per_metre], found[total] / geometry.width);
                }
            }
        }
    }
}

/// Under an even load `q` along its length the shear at any cut is `q` times what is left of the
/// length, exactly, and the moment is off by no more than its interpolation inside an element,
/// `q h^2 / 8`: loads in the element that the plane meets are shared out.
#[test]
fn an_even_load_is_shared_out_at_the_cut() {
    let (length, cells, load) = (6.0, 6, 1e5);
    let (low, high) = (Vec3::new(0.0, -1.0, -0.5), Vec3::new(length, 1.0, 0.5));
    for kernel in [Kernel::OnePoint, Kernel::Full] {
        let mesh = kernel.mesh(low, high, [cells, 1, 1]);
        let body = Body::new(mesh, kernel, concrete(0.2));
        let held = body
            .mesh
            .nodes_of_facets(body.mesh.facet_set("left").unwrap());
        // Each layer of four nodes carries the load of one element length, the end ones of half.
        let h = length / cells as f64;
        let loads: Vec<Vec3> = body
            .mesh
            .positions()
            .iter()
            .map(|p| {
                let end = p.x == 0.0 || p.x == length;
                -0.25 * load * h * if end { 0.5 } else { 1.0 } * Vec3::z()
            })
            .collect();
        let displacement = body.deflection(&held, &loads);
        for x in [1.0, 2.25, 3.5, 4.1, 5.0] {
            let found = body.section(&cut_at(x), &displacement);
            let left = length - x;
            // Across is -z; the load bends the beam down: tension above.
            assert!(
                (found[1] - load * left).abs() < 1e-6 * load,
                "{kernel:?} {x} {}",
                found[1]
            );
            let moment = -found[4];
            let expected = 0.5 * load * left * left;
            assert!(
                (moment - expected).abs() <= 0.126 * load * h * h,
                "{kernel:?} {x} {moment} {expected}"
            );
        }
    }
}

/// A plane on either end of the elements, such as the foot of a pillar, shows the whole force, and so
/// does one within half an element of it.
#[test]
fn a_plane_may_lie_on_an_end() {
    let (low, high) = (Vec3::zeros(), Vec3::new(3.0, 1.0, 1.0));
    let body = Body::new(
        Kernel::Full.mesh(low, high, [3, 2, 2]),
        Kernel::Full,
        concrete(0.0),
    );
    let stretched: Vec<Vec3> = body
        .mesh
        .positions()
        .iter()
        .map(|p| Vec3::new(1e-4 * p.x, 0.0, 0.0))
        .collect();
    let force = body.medium.young * 1e-4;
    for x in [0.0, 0.2, 1.0, 2.8, 3.0] {
        for sign in [1.0, -1.0] {
            let cut = CrossSection {
                normal: sign * Vec3::x(),
                ..cut_at(x)
            };
            let found = body.section(&cut, &stretched);
            assert!(
                (found[0] / force - 1.0).abs() < 1e-12,
                "{x} {sign} {}",
                found[0]
            );
        }
    }
}

/// Relative error of the moment (and the shear) of a field given at the nodes, in the middle of
/// an element, at `n` elements over the depth.
fn bending_error(
    kernel: Kernel,
    n: usize,
    medium: ElasticMedium,
    field: impl Fn(&Vec3) -> Vec3,
    (shear, moment): (f64, f64),
) -> (f64, f64) {
    let (low, high) = (Vec3::new(0.0, -0.1, -0.5), Vec3::new(4.0, 0.1, 0.5));
    let body = Body::new(kernel.mesh(low, high, [4 * n, 1, n]), kernel, medium);
    let displacement: Vec<Vec3> = body.mesh.positions().iter().map(field).collect();
    let found = body.section(&cut_at(1.5 + 0.3 / n as f64), &displacement);
    // Across is -z.
    (
        (-found[1] - shear).abs() / shear.abs().max(1.0),
        (-found[4] - moment).abs() / moment.abs(),
    )
}

/// The exact field of a beam in pure bending gives M = E kappa I, with an error that falls with the
/// square of the element size and is below 0.5 % at twenty elements over the depth.
#[test]
fn pure_bending_converges_to_its_closed_form() {
    let (curvature, poisson) = (1e-4, 0.2);
    let medium = concrete(poisson);
    let field = |p: &Vec3| {
        Vec3::new(
            curvature * p.x * p.z,
            -poisson * curvature * p.y * p.z,
            -0.5 * curvature * (p.x * p.x + poisson * (p.z * p.z - p.y * p.y)),
        )
    };
    let moment = medium.young * curvature * 0.2 / 12.0;
    for kernel in [Kernel::OnePoint, Kernel::Full, Kernel::BBar, Kernel::Wedge] {
        let error = |n| bending_error(kernel, n, medium, field, (0.0, moment)).1;
        let (coarse, fine) = (error(10), error(20));
        let slope = (coarse / fine).log2();
        assert!(fine < 5e-3, "{kernel:?} {fine}");
        assert!(
            (slope - 2.0).abs() < 0.15,
            "{kernel:?} {slope} {coarse} {fine}"
        );
    }
}

/// The exact field of a cantilever of rectangular section under a transverse load at its end
/// (Timoshenko and Goodier, Theory of Elasticity, 1970, article 21; Poisson's ratio 0, for which plane
/// stress is exact in space) gives Q = P and M = P (L - x) at the cut.
#[test]
fn a_bent_cantilever_converges_to_its_closed_form() {
    let medium = concrete(0.0);
    let (load, length, height, width) = (1e5, 4.0, 1.0, 0.2);
    let inertia = width * f64::powi(height, 3) / 12.0;
    let flexibility = load / (6.0 * medium.young * inertia);
    // Loaded by P along z at x = L, held at x = 0.
    let field = |p: &Vec3| {
        Vec3::new(
            -flexibility
                * p.z
                * ((6.0 * length - 3.0 * p.x) * p.x + 2.0 * (p.z * p.z - 0.25 * height * height)),
            0.0,
            flexibility * (height * height * p.x + (3.0 * length - p.x) * p.x * p.x),
        )
    };
    for kernel in [Kernel::OnePoint, Kernel::Full, Kernel::BBar] {
        let error = |n: usize| {
            let x = 1.5 + 0.3 / n as f64;
            // Tension below, where z < 0.
            let moment = -load * (length - x);
            bending_error(kernel, n, medium, field, (load, moment))
        };
        let (coarse, fine) = (error(10), error(20));
        assert!(fine.0 < 5e-3 && fine.1 < 5e-3, "{kernel:?} {fine:?}");
        let slope = (coarse.1 / fine.1).log2();
        assert!(
            (slope - 2.0).abs() < 0.15,
            "{kernel:?} {slope} {coarse:?} {fine:?}"
        );
    }
}

/// Half a ring, radius 10 m, `n` elements of one layer.
fn arch(n: usize, thickness: f64) -> Mesh {
    let low = Vec3::new(0.0, 0.0, 10.0 - 0.5 * thickness);
    let high = Vec3::new(1.0, 3.0, 10.0 + 0.5 * thickness);
    let mesh = Mesh::box_of_hexes(low, high, [n, 3, 1], "beam").unwrap();
    mesh.map_positions(|p| {
        let (sin, cos) = (PI * p.x).sin_cos();
        Vec3::new(-p.z * cos, p.y, p.z * sin)
    })
    .unwrap()
}

/// A lining that shrinks evenly by `c` carries the hoop force E c ln(outer / inner) per metre and next to
/// no moment; a box takes one of the two legs that a plane meets; width, depth and centroid are those of
/// the leg.
#[test]
fn a_lining_of_one_element_shows_its_hoop_force() {
    let medium = concrete(0.0);
    let thickness = 0.5;
    let body = Body::new(arch(36, thickness), Kernel::OnePoint, medium);
    let shrink = |p: &Vec3| -1e-3 * Vec3::new(p.x, 0.0, p.z).normalize();
    let displacement: Vec<Vec3> = body.mesh.positions().iter().map(shrink).collect();
    let hoop = -medium.young * 1e-3 * (10.25_f64 / 9.75).ln();
    let mut legs = CrossSection {
        name: "legs".into(),
        point: Vec3::new(0.0, 0.0, 5.0),
        normal: Vec3::z(),
        along: Vec3::y(),
        within: None,
    };
    let both = body.section(&legs, &displacement);
    let everywhere = Vec3::repeat(100.0);
    legs.within = Some((-everywhere, Vec3::new(0.0, 100.0, 100.0)));
    let left = body.section(&legs, &displacement);
    assert!((left[0] / both[0] - 0.5).abs() < 1e-9);
    let mut observer = SectionForces::new(Cadence::Steps(1)).unwrap();
    let geometry = observer
        .add_section(&body.mesh, &legs, body.elements())
        .unwrap();
    assert!((geometry.width - 3.0).abs() < 1e-12);
    // The plane meets the leg at 30 degrees to its axis, on chords.
    let slant = thickness / (PI / 6.0).cos();
    assert!(
        (geometry.depth / slant - 1.0).abs() < 0.01,
        "{}",
        geometry.depth
    );
    assert!((geometry.area / (3.0 * geometry.depth) - 1.0).abs() < 1e-12);
    let leg = -(100.0_f64 - 25.0).sqrt();
    assert!((geometry.centroid - Vec3::new(leg, 1.5, 5.0)).norm() < 0.02);

    // Between two sides of elements, on which all nodes of the crown lie.
    let crown = CrossSection {
        name: "crown".into(),
        point: Vec3::zeros(),
        normal: Vec3::x(),
        along: Vec3::y(),
        within: None,
    };
    let found = body.section(&crown, &displacement);
    assert!((found[6] / hoop - 1.0).abs() < 5e-3, "{} {hoop}", found[6]);
    assert!(found[8].abs() < 5e-3 * hoop.abs() * thickness);
    assert!(found[7].abs() < 1e-9 * hoop.abs());
}

/// A rigid motion makes no section forces, in single precision too, and a reference displacement of the
/// elements takes its own away.
#[test]
fn only_strain_since_the_reference_counts() {
    let (low, high) = (Vec3::new(0.0, -1.0, -0.5), Vec3::new(4.0, 1.0, 0.5));
    let mesh = jitter(Kernel::OnePoint.mesh(low, high, [4, 2, 1]), 0.06);
    let medium = concrete(0.2);
    let bent: Vec<Vec3> = (mesh.positions().iter())
        .map(|p| 1e-4 * Vec3::new(p.x * p.z, 0.0, -0.5 * p.x * p.x))
        .collect();
    let far: Vec<Vec3> = (bent.iter())
        .map(|u| u + Vec3::new(10.0, -20.0, 30.0))
        .collect();
    let plain = Body::new(mesh.clone(), Kernel::OnePoint, medium).section(&cut_at(1.6), &bent);
    let scale = plain[4].abs();
    assert!(scale > 1e4);
    for precision in [Precision::F64, Precision::Mixed, Precision::F32] {
        let mut body = Body::of(mesh.clone(), &*one_point(medium, precision), medium);
        let close = if precision == Precision::F64 {
            1e-9
        } else {
            1e-5
        };
        let moved = body.section(&cut_at(1.6), &far);
        for (moved, plain) in moved.iter().zip(&plain) {
            assert!(
                (moved - plain).abs() < close * scale,
                "{precision:?} {moved} {plain}"
            );
        }
        let nodes: Vec<Quad<f64>> = bent.iter().map(Quad::from_vector).collect();
        (body.block).set_reference_displacement(NodalView::F64(&nodes));
        let found = body.section(&cut_at(1.6), &far);
        assert!(found.iter().all(|work| work.abs() < close * scale));
    }
}

/// An engine that does not provide the forces of elements is refused with the section's name.
#[test]
fn cuts_need_the_forces_of_elements() {
    let mesh = Kernel::Full.mesh(Vec3::zeros(), Vec3::repeat(2.0), [2, 2, 2]);
    let mut observer = SectionForces::new(Cadence::Steps(1)).unwrap();
    let elements = mesh.element_set("beam").unwrap();
    observer.add_section(&mesh, &cut_at(0.5), elements).unwrap();
    let refused = observer.observe(&Fields::at_rest(mesh.node_count()));
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("'cut'"), "{refused}");
}

/// Area and centroid of a cut are those of the solid, for every kind of element and any direction.
#[test]
fn a_section_has_its_area_and_centroid() {
    let (low, high) = (Vec3::new(0.0, -1.0, -0.5), Vec3::new(6.0, 1.0, 0.5));
    for kernel in [Kernel::Full, Kernel::Wedge, Kernel::Tet] {
        let body = Body::new(kernel.mesh(low, high, [6, 3, 2]), kernel, concrete(0.2));
        // On sides of elements, inside them, tilted about y by atan(0.5), and on the end's side.
        for (x, tilt) in [(2.0, 0.0), (2.3, 0.0), (2.3, 0.5), (2.0, 0.5)] {
            let cut = CrossSection {
                normal: Vec3::new(1.0, 0.0, tilt),
                ..cut_at(x)
            };
            let mut observer = SectionForces::new(Cadence::Steps(1)).unwrap();
            let geometry = observer
                .add_section(&body.mesh, &cut, body.elements())
                .unwrap();
            let slant = f64::hypot(1.0, tilt);
            assert!(
                (geometry.area - 2.0 * slant).abs() < 1e-12,
                "{kernel:?} {x} {tilt}"
            );
            assert!((geometry.centroid - Vec3::new(x, 0.0, 0.0)).norm() < 1e-12);
            assert!((geometry.width - 2.0).abs() < 1e-12);
            assert!((geometry.depth - slant).abs() < 1e-12);
            let (n, t, b) = (&geometry.normal, &geometry.across, &geometry.along);
            assert!((n.cross(t) - b).norm() < 1e-15);
        }
    }
}

/// Cuts that mean nothing are refused by name.
#[test]
fn impossible_cuts_are_refused() {
    let mesh = Kernel::Full.mesh(Vec3::zeros(), Vec3::repeat(2.0), [2, 2, 2]);
    let body = Body::new(mesh, Kernel::Full, concrete(0.2));
    let mut observer = SectionForces::new(Cadence::Steps(1)).unwrap();
    let mut refused = |cut: CrossSection| {
        observer
            .add_section(&body.mesh, &cut, body.elements())
            .err()
    };
    let cut = || cut_at(0.5);
    let flat = CrossSection {
        normal: Vec3::zeros(),
        ..cut()
    };
    assert!(matches!(
        refused(flat),
        Some(ObserveError::NoDirection { what: "normal", .. })
    ));
    for along in [Vec3::zeros(), Vec3::x(), Vec3::repeat(f64::NAN)] {
        let parallel = CrossSection { along, ..cut() };
        assert!(matches!(
            refused(parallel),
            Some(ObserveError::NoDirection { what: "along", .. })
        ));
    }
    for x in [-1.0, 2.5, f64::NAN] {
        assert!(
            matches!(refused(cut_at(x)), Some(ObserveError::EmptySection { section, outside: false }) if section == "cut")
        );
    }
    let boxed = CrossSection {
        within: Some((Vec3::repeat(5.0), Vec3::repeat(6.0))),
        ..cut()
    };
    let refusal = refused(boxed);
    assert!(matches!(
        refusal,
        Some(ObserveError::EmptySection { outside: true, .. })
    ));
    // What is to blame has its name.
    assert!(refusal.is_some_and(|error| error.to_string().contains("`half_extent`")));
    assert!(refused(cut()).is_none());
    assert!(
        matches!(refused(cut()), Some(ObserveError::NameTwice { name }) if name == "cut.axial")
    );
    assert_eq!(observer.geometries().count(), 1);
    assert!(SectionForces::new(Cadence::Steps(0)).is_err());
}

/// A ring of radius 10 m and 0.5 m thick, 3 m long, of `n` elements around with two across its thickness; it is closed
/// by nodes that coincide. Its axis y is turned about a unit vector by an angle.
fn ring(kernel: Kernel, n: usize, turn: impl Fn(&Vec3) -> Vec3) -> Mesh {
    let (low, high) = (Vec3::new(0.0, 0.0, 9.75), Vec3::new(2.0, 3.0, 10.25));
    let mesh = kernel.mesh(low, high, [n, 3, 2]);
    let around = |p: Vec3| {
        let (sin, cos) = (PI * p.x).sin_cos();
        turn(&Vec3::new(-p.z * cos, p.y, p.z * sin))
    };
    mesh.map_positions(around).unwrap().with_straight_edges()
}

/// Rotation about a unit vector (formula of Rodrigues).
fn turned(p: &Vec3, axis: &Vec3, angle: f64) -> Vec3 {
    let (sin, cos) = angle.sin_cos();
    p * cos + axis.cross(p) * sin + axis * (axis.dot(p) * (1.0 - cos))
}

/// A plane that contains the axis of a ring, or a chord of it, cuts two pieces that do not touch, each with its own
/// area, centroid and extents; a plane across the axis, one that only grazes the crown, and a box around one leg give
/// one piece: with every kernel, wherever the ring's axis points.
#[test]
fn pieces_that_do_not_touch_are_counted() {
    for kernel in KERNELS {
        for (about, angle) in [
            (Vec3::y(), 0.0),
            (Vec3::new(1.0, 2.0, -0.5).normalize(), 0.7),
            (Vec3::new(-0.2, 0.1, 1.0).normalize(), 2.3),
        ] {
            let turn = |p: &Vec3| turned(p, &about, angle);
            let mesh = ring(kernel, 24, turn);
            let elements: Vec<u32> = (0..mesh.element_count() as u32).collect();
            let geometry = |point: Vec3, normal: Vec3, along: Vec3, half: Option<f64>| {
                let cut = CrossSection {
                    name: "cut".into(),
                    point: turn(&point),
                    normal: turn(&normal),
                    along: turn(&along),
                    within: half.map(|half| {
                        let half = Vec3::repeat(half);
                        (turn(&point) - half, turn(&point) + half)
                    }),
                };
                let mut observer = SectionForces::new(Cadence::Steps(1)).unwrap();
                observer
                    .add_section(&mesh, &cut, &elements)
                    .unwrap()
                    .clone()
            };
            let middle = Vec3::new(0.0, 1.5, 0.0);
            // The last plane passes the coincident nodes.
            for inclination in [0.3, 1.1, 2.9, 0.0] {
                let (sin, cos) = f64::sin_cos(inclination);
                let (out, normal) = (Vec3::new(cos, 0.0, sin), Vec3::new(-sin, 0.0, cos));
                for offset in [0.0, 5.0] {
                    let point = middle + offset * normal;
                    let found = geometry(point, normal, Vec3::y(), None);
                    let what = format!("{kernel:?} {about} {inclination} {offset}");
                    let [first, second] = &found.pieces[..] else {
                        panic!("{what}: {:?}", found.pieces)
                    };
                    let count = first.elements.len() + second.elements.len();
                    assert_eq!(count, found.elements, "{what}");
                    let area = first.area + second.area;
                    assert!((area / found.area - 1.0).abs() < 1e-9, "{what}");
                    let leg = f64::sqrt(100.0 - offset * offset);
                    for sign in [1.0, -1.0] {
                        let expected = turn(&(point + sign * leg * out));
                        let near = |piece: &&SectionPiece| (piece.centroid - expected).norm() < 0.2;
                        let piece = found.pieces.iter().find(near).unwrap();
                        assert!((piece.width - 3.0).abs() < 1e-9, "{what}: {piece:?}");
                        let slant = 0.5 * 10.0 / leg;
                        assert!((piece.depth / slant - 1.0).abs() < 0.1, "{what}: {piece:?}");
                        assert!(
                            (piece.area / (3.0 * piece.depth) - 1.0).abs() < 0.02,
                            "{what}"
                        );
                    }
                    let one = geometry(point + leg * out, normal, Vec3::y(), Some(4.0));
                    assert_eq!(one.pieces.len(), 1, "{what}");
                    assert_eq!(one.pieces[0].elements.len(), one.elements, "{what}");
                }
                let grazing = geometry(middle + 9.9 * normal, normal, Vec3::y(), None);
                assert_eq!(grazing.pieces.len(), 1, "{kernel:?} {inclination}");
            }
            let across = geometry(middle, Vec3::y(), Vec3::x(), None);
            assert_eq!(across.pieces.len(), 1, "{kernel:?}");
            assert_eq!(across.pieces[0].area, across.area);
        }
    }
}

/// Two sides of a joint touch, although they share no node; elements with others between them do not.
#[test]
fn two_sides_of_a_joint_are_one_piece() {
    for kernel in KERNELS {
        let mesh = kernel.mesh(Vec3::zeros(), Vec3::new(4.0, 2.0, 2.0), [4, 2, 2]);
        let every = 0..mesh.element_count() as u32;
        let (left, right): (Vec<u32>, Vec<u32>) = every.partition(|&e| mesh.centroid(e).x < 2.0);
        let split = mesh.split_between(&left, &right).unwrap().mesh;
        let split = jitter(split, 0.05);
        assert!(split.node_count() > mesh.node_count());
        let pieces = |elements: &[u32]| {
            let cut = CrossSection {
                name: "cut".into(),
                point: Vec3::new(1.0, 1.0, 0.7),
                normal: Vec3::new(0.05, -0.1, 1.0),
                along: Vec3::x(),
                within: None,
            };
            let mut observer = SectionForces::new(Cadence::Steps(1)).unwrap();
            let geometry = observer.add_section(&split, &cut, elements).unwrap();
            geometry.pieces.len()
        };
        let all = [left, right].concat();
        assert_eq!(pieces(&all), 1, "{kernel:?}");
        let between = |e: &u32| (1.0..3.0).contains(&mesh.centroid(*e).x);
        let rest: Vec<u32> = all.into_iter().filter(|e| !between(e)).collect();
        assert_eq!(pieces(&rest), 2, "{kernel:?}");
    }
}
