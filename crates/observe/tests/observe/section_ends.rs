//! Sections on and beside the ends of a body, and between elements of several lengths.

use powerhouse_model::{Cadence, ElasticMedium, Mesh, Vec3};
use powerhouse_observe::SectionForces;

use super::beam::{Body, KERNELS, Kernel, cut_at};

const LENGTH: f64 = 6.0;
const LOAD: f64 = 1e5;

fn concrete() -> ElasticMedium {
    ElasticMedium::new(25.0e9, 0.2, 2500.0).unwrap()
}

/// A beam along x of six layers of elements between x = 0, where it is held, and 6 m.
fn beam(kernel: Kernel, map: impl Fn(Vec3) -> Vec3) -> (Body, Vec<u32>) {
    let (low, high) = (Vec3::new(0.0, -1.0, -0.5), Vec3::new(LENGTH, 1.0, 0.5));
    let mesh = kernel.mesh(low, high, [6, 1, 2]).map_positions(map);
    let mesh = mesh.unwrap().with_straight_edges();
    let body = Body::new(mesh, kernel, concrete());
    let held = (body.mesh).nodes_of_facets(body.mesh.facet_set("left").unwrap());
    (body, held)
}

/// Nodal forces of a load along z of so much per metre of x, by the share of each node in the layers of elements.
fn even_load(mesh: &Mesh) -> Vec<Vec3> {
    let mut layers: Vec<f64> = mesh.positions().iter().map(|p| p.x).collect();
    layers.sort_by(f64::total_cmp);
    layers.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let share = |p: &Vec3| {
        let layer = layers.iter().position(|x| (x - p.x).abs() < 1e-9).unwrap();
        let before = layers[layer.saturating_sub(1)];
        let after = layers[(layer + 1).min(layers.len() - 1)];
        let nodes = mesh
            .positions()
            .iter()
            .filter(|other| (other.x - p.x).abs() < 1e-9);
        0.5 * (after - before) / nodes.count() as f64
    };
    let positions = mesh.positions().iter();
    positions.map(|p| -LOAD * share(p) * Vec3::z()).collect()
}

/// The shear of an evenly loaded cantilever is the load beyond the section, exactly, and its moment is off by no more than its
/// interpolation inside an element: on both ends, beside them, inside, seen from both sides, and with layers of elements that grow
/// along the beam.
#[test]
fn an_even_load_is_right_up_to_the_ends() {
    for growth in [0.0, 0.8] {
        // The layers are 1 m long, or grow from 0.26 to 2.1 m.
        let map = |p: Vec3| {
            let x = p.x / LENGTH;
            Vec3::new(LENGTH * x * (1.0 - growth * (1.0 - x)), p.y, p.z)
        };
        for kernel in [Kernel::OnePoint, Kernel::Full, Kernel::Wedge, Kernel::Tet] {
            let (body, held) = beam(kernel, map);
            let displacement = body.deflection(&held, &even_load(&body.mesh));
            for x in [0.0, 0.1, 0.3, 1.0, 3.0, 5.1, 5.7, 6.0] {
                for side in [1.0, -1.0] {
                    let mut cut = cut_at(x);
                    cut.normal = side * Vec3::x();
                    let found = body.section(&cut, &displacement);
                    let left = LENGTH - x;
                    // Across is -z for a normal of x, and z for one of -x: the shear is positive from both sides.
                    let shear = found[1] / LOAD;
                    let error = (shear - left).abs();
                    let case = format!("{kernel:?} {growth} {x} {side}");
                    // With even layers to rounding; else to a twentieth of a length on either side.
                    let limit = if growth == 0.0 { 1e-6 } else { 0.1 };
                    assert!(error < limit, "{case}: shear {shear} for {left}");
                    let moment = -side * found[4] / LOAD;
                    let error = (moment - 0.5 * left * left).abs();
                    let length = if growth == 0.0 { 1.0 } else { 2.1 };
                    let limit = match x == 0.0 || x == LENGTH {
                        true if growth == 0.0 => 1e-6,
                        _ => 0.13 * length * length,
                    };
                    assert!(
                        error < limit,
                        "{case}: moment {moment} for {}",
                        0.5 * left * left
                    );
                }
            }
        }
    }
}

/// An end that is oblique to the sections, held and with a large reaction, does not enter the forces of sections beside it, which
/// are those of the loads at the other end to rounding; with every kernel, and ends that lean by up to 35 degrees.
#[test]
fn an_oblique_end_does_no_work() {
    for kernel in KERNELS {
        for lean in [0.05, -0.3, 0.7] {
            // The layers straighten out over the beam.
            let map = |p: Vec3| p + Vec3::new(lean * p.z * (1.0 - p.x / LENGTH), 0.0, 0.0);
            let (body, held) = beam(kernel, map);
            let loaded = (body.mesh).nodes_of_facets(body.mesh.facet_set("right").unwrap());
            let mut loads = vec![Vec3::zeros(); body.mesh.node_count()];
            for &node in &loaded {
                let height = body.mesh.positions()[node as usize].z;
                loads[node as usize] = 1e5 * Vec3::new(1.0 + height, 0.2, -0.3);
            }
            let displacement = body.deflection(&held, &loads);
            let total: Vec3 = loads.iter().sum();
            for x in [0.36, 0.5, 0.9, 1.4] {
                let found = body.section(&cut_at(x), &displacement);
                let positions = body.mesh.positions().iter();
                // The centroid of the section is on the axis of the beam.
                let moment: Vec3 = (positions.zip(&loads))
                    .map(|(p, load)| (p - Vec3::new(x, 0.0, 0.0)).cross(load))
                    .sum();
                // Normal x, along y, across -z.
                let expected = [total.x, -total.z, total.y, moment.x, -moment.y, -moment.z];
                for (column, (found, expected)) in found.iter().zip(expected).enumerate() {
                    let error = (found - expected).abs() / 1e5;
                    assert!(
                        error < 1e-4,
                        "{kernel:?} {lean} {x}, column {column}: {found} for {expected}"
                    );
                }
            }
        }
    }
}

/// A body of a single element between two ends shows the mean of its ends at both of them, and stays finite.
#[test]
fn a_single_element_between_two_ends_shows_its_mean() {
    let mesh = Kernel::Full.mesh(Vec3::zeros(), Vec3::new(1.0, 1.0, 1.0), [1, 2, 2]);
    let body = Body::new(mesh, Kernel::Full, concrete());
    let stretch = |p: &Vec3| Vec3::new(1e-4 * p.x, 0.0, 0.0);
    let displacement: Vec<Vec3> = body.mesh.positions().iter().map(stretch).collect();
    let force = body.section(&cut_at(0.5), &displacement)[0];
    assert!(force > 2e6);
    for x in [0.0, 0.2, 0.9, 1.0] {
        let found = body.section(&cut_at(x), &displacement)[0];
        assert!((found / force - 1.0).abs() < 1e-12, "{x}: {found}");
    }
}

/// A plane through a face at which the body ends is named, and one beside it or on it is not; its forces stay finite, even between two
/// faces that meet in the plane.
#[test]
fn a_plane_through_an_end_face_is_named() {
    for (lean, cuts) in [
        (0.0, [false, false, false]),
        (0.8, [true, true, false]),
        (-0.8, [true, true, false]),
    ] {
        let map = |p: Vec3| p + Vec3::new(lean * p.z * (1.0 - p.x / LENGTH), 0.0, 0.0);
        let (body, _) = beam(Kernel::Full, map);
        for (x, cuts) in [0.0, 0.2, 0.6].into_iter().zip(cuts) {
            for side in [1.0, -1.0] {
                let mut cut = cut_at(x);
                cut.normal = side * Vec3::x();
                let mut observer = SectionForces::new(Cadence::Steps(1)).unwrap();
                let geometry = observer.add_section(&body.mesh, &cut, body.elements());
                assert_eq!(geometry.unwrap().cuts_end, cuts, "{lean} {x} {side}");
            }
        }
    }
    let mesh = Kernel::Full.mesh(
        Vec3::new(0.0, 0.0, -0.5),
        Vec3::new(1.0, 1.0, 0.5),
        [1, 1, 1],
    );
    let mesh = mesh.map_positions(|p| p + Vec3::new(p.z, 0.0, 0.0));
    let body = Body::new(mesh.unwrap(), Kernel::Full, concrete());
    let stretch = |p: &Vec3| Vec3::new(1e-4 * p.x, 0.0, 0.0);
    let displacement: Vec<Vec3> = body.mesh.positions().iter().map(stretch).collect();
    let found = body.section(&cut_at(0.5), &displacement);
    assert!(found.iter().all(|force| force.is_finite()), "{found:?}");
}
