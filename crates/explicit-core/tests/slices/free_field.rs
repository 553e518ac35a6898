//! A slice of a half-space without a structure moves as the free field.

use powerhouse_boundary::ViscousSpring;
use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::Leapfrog;
use powerhouse_model::{
    AbsorbingBoundary, BoundarySite, FieldMotion, IncidentField, Mesh, TimeIntegrator, Vec3,
};
use powerhouse_wavefield::WaveKind::{self, P, SH, SV};

use super::{built, middle, pairs, rock, slowness, spec, wave};

/// Error of the motion of all nodes over all time against the wave, as a share of its norm, in a box of 400 x 200 m with
/// elements of a size (m), under a Ricker pulse of 4 Hz.
fn error(kind: WaveKind, angles: [f64; 2], size: f64, kernel: SolidKernel) -> f64 {
    let counts = [(400.0 / size) as usize, 1, (200.0 / size) as usize];
    let half = 0.05 * size;
    let (low, high) = (
        Vec3::new(-200.0, -half, -200.0),
        Vec3::new(200.0, half, 0.0),
    );
    let mesh = Mesh::box_of_hexes(low, high, counts, "rock").unwrap();
    let field = wave(kind, angles, (4.0, 0.55));
    let mut model = built(spec(&mesh, kernel, &field, slowness(kind, angles)).unwrap());
    let pairs = pairs(&mesh);
    let points: Vec<Vec3> = pairs
        .iter()
        .map(|&(a, _)| {
            let x = mesh.positions()[a as usize];
            Vec3::new(x.x, 0.0, x.z)
        })
        .collect();
    let sampler = field.prepare(&points).unwrap();
    // A part of the stable step: the error is that of the mesh.
    let step = 0.6 * model.stable_step(&Leapfrog).unwrap().step;
    let (mut missed, mut all) = (0.0, 0.0);
    let mut motion = vec![FieldMotion::default(); points.len()];
    let mut count = 0;
    while model.time() < 1.1 {
        Leapfrog.step(&mut model, step).unwrap();
        count += 1;
        if count % 4 != 0 {
            continue;
        }
        motion.fill(FieldMotion::default());
        sampler.add_motion(model.time(), &mut motion);
        for (found, exact) in middle(&model, &pairs).iter().zip(&motion) {
            missed += (found - exact.displacement).norm_squared();
            all += exact.displacement.norm_squared();
        }
    }
    (missed / all).sqrt()
}

/// Wave, incidence, azimuth, and the errors of another implementation with elements of 10 m and of 5 m: 29 and 57 elements
/// per wavelength of S waves at 4 Hz.
const TABLE: [(WaveKind, f64, f64, f64, f64); 9] = [
    (SV, 20.0, 45.0, 1.13e-2, 2.8e-3),
    (SV, 20.0, 90.0, 3.2e-3, 8.0e-4),
    (SV, 30.0, 90.0, 9.9e-3, 2.5e-3),
    (SV, 33.0, 90.0, 9.8e-3, 2.5e-3),
    (P, 30.0, 90.0, 5.3e-3, 1.3e-3),
    (P, 60.0, 45.0, 5.5e-3, 1.4e-3),
    (P, 80.0, 90.0, 3.3e-3, 8.4e-4),
    (SH, 30.0, 45.0, 1.4e-2, 3.6e-3),
    (SH, 30.0, 90.0, 1.2e-2, 3.1e-3),
];

/// With 29 elements per wavelength the motion is that of the wave within 1.2 times the error of the other implementation,
/// at slownesses up to 0.985 of that of P waves.
#[test]
fn a_slice_moves_as_the_free_field_at_any_azimuth() {
    for (kind, incidence, azimuth, coarse, _) in TABLE {
        let found = error(kind, [incidence, azimuth], 10.0, SolidKernel::Hex8Full);
        let case = format!("{kind} at {incidence} and {azimuth} degrees: {found:.3e}");
        assert!(found < 1.2 * coarse, "{case}");
    }
}

/// Errors fall with the square of the element size; with 57 elements per wavelength they are within 1.2 times those of the
/// table. Two minutes: `cargo test -p powerhouse-explicit-core --test explicit-core -- --ignored slices`.
#[test]
#[ignore = "two minutes"]
fn errors_of_the_free_field_fall_with_the_square_of_the_size() {
    for (kind, incidence, azimuth, _, fine) in TABLE {
        let size = |size| error(kind, [incidence, azimuth], size, SolidKernel::Hex8Full);
        let [found, halved] = [10.0, 5.0].map(size);
        let order = (found / halved).log2();
        println!("{kind} {incidence} {azimuth}: {found:.3e} {halved:.3e} order {order:.2}");
        assert!(
            halved < 1.2 * fine,
            "{kind} {incidence} {azimuth}: {halved:.3e}"
        );
        assert!(
            (1.9..2.1).contains(&order),
            "{kind} {incidence} {azimuth}: {order:.2}"
        );
    }
}

/// The kernels of one point, with bending and with enhanced strains err no more than full integration does.
#[test]
fn all_kernels_of_bricks_move_as_the_free_field() {
    let angles = [30.0, 90.0];
    for kernel in [
        SolidKernel::Hex8Natural,
        SolidKernel::Hex8Eas,
        SolidKernel::ONE_POINT,
    ] {
        let found = error(SV, angles, 20.0, kernel);
        assert!(found < 1.2 * 4.0 * 9.9e-3, "{kernel:?}: {found:.3e}");
    }
}

/// The two nodes of a pair on an absorbing face have one load, in the middle between them: the force of the field on both.
#[test]
fn a_pair_of_nodes_is_loaded_once_with_the_force_on_both() {
    let (low, high) = (Vec3::new(-20.0, -3.0, -30.0), Vec3::new(20.0, 1.0, 0.0));
    let mesh = Mesh::box_of_hexes(low, high, [4, 1, 3], "rock").unwrap();
    let angles = [25.0, 60.0];
    let field = wave(SV, angles, (8.0, 0.1));
    let faces = ["left", "right", "bottom"].map(|face| (face, mesh.facet_set(face).unwrap()));
    let site = BoundarySite::from_mesh(&mesh, &faces, |_| rock(), Vec3::zeros(), Some(&field));
    let site = site.with_slowness(slowness(SV, angles));
    let mut parts = ViscousSpring::default().build(&site).unwrap();
    let time = 0.11;
    let mut found = vec![Vec3::zeros(); mesh.node_count()];
    let mut count = 0;
    for load in &mut parts.loads {
        let nodes = load.nodes().to_vec();
        let mut forces = vec![Vec3::zeros(); nodes.len()];
        load.add_forces(time, &mut forces);
        count += nodes.len();
        for (node, force) in nodes.iter().zip(forces) {
            found[*node as usize] += force;
        }
    }
    assert_eq!(2 * count, site.nodes.len());
    let mut largest: f64 = 0.0;
    for (own, plain) in site.nodes.iter().zip(&parts.impedance) {
        let place = own.position;
        let middle = Vec3::new(place.x, -1.0, place.z);
        let partners = site.nodes.iter().filter(|other| {
            let apart = other.position - place;
            apart.x == 0.0 && apart.z == 0.0
        });
        let both: Vec3 = partners.map(|other| found[other.node as usize]).sum();
        let mut motion = [FieldMotion::default()];
        let sampler = field.prepare(&[middle]).unwrap();
        sampler.add_motion(time, &mut motion);
        let areas = own.faces.iter().map(|share| share.normal * share.area);
        let area: Vec3 = areas.sum();
        let one = plain.spring * motion[0].displacement
            + (plain.dashpot + plain.gyroscopic) * motion[0].velocity
            + motion[0].stress.traction(&area);
        largest = largest.max(one.norm());
        assert!((both - one * 2.0).norm() < 1e-12 * largest, "{place:?}");
    }
    assert!(largest > 1e3, "{largest}");
}
