//! A bay of a half-space without a structure moves as the free field.

use powerhouse_boundary::ViscousSpring;
use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{
    AbsorbingBoundary, BlockOptions, BoundarySite, DelayedPairs, FieldMotion, IncidentField,
    TimeIntegrator, Vec3,
};
use powerhouse_wavefield::WaveKind::{self, P, SH, SV};

use super::{bent, pairs, rock, slowness, wave};

/// Error of the motion of all nodes over all time against the wave, as a share of its norm, in a distorted bay of 200 x 30 x 100 m with
/// elements of 10 m, under a Ricker pulse of 8 Hz.
fn error(kind: WaveKind, angles: [f64; 2], kernel: SolidKernel) -> f64 {
    let mesh = bent(Vec3::new(100.0, 15.0, 50.0), [20, 3, 10], 0.12, 7);
    let field = wave(kind, angles, (8.0, 0.25));
    let s = slowness(kind, angles);
    let faces = ["left", "right", "bottom"].map(|face| (face, mesh.facet_set(face).unwrap()));
    let site = BoundarySite::from_mesh(&mesh, &faces, |_| rock(), Vec3::zeros(), Some(&field));
    let parts = ViscousSpring::default()
        .build(&site.with_slowness(s))
        .unwrap();
    let law = LinearElastic::new(rock());
    let mut model = Model::builder(&mesh)
        .elements("rock", kernel.factory("rock", law, BlockOptions::default()))
        .boundary(parts)
        .delayed(DelayedPairs {
            pairs: pairs(&mesh),
            slowness: s,
            ..DelayedPairs::default()
        })
        .build()
        .unwrap();
    let points: Vec<Vec3> = (mesh.positions().iter())
        .map(|x| Vec3::new(x.x, 0.0, x.z))
        .collect();
    let sampler = field.prepare(&points).unwrap();
    let step = 0.7 * model.stable_step(&Leapfrog).unwrap().step;
    let (mut missed, mut all) = (0.0, 0.0);
    let mut motion = vec![FieldMotion::default(); points.len()];
    let mut count = 0;
    while model.time() < 0.5 {
        Leapfrog.step(&mut model, step).unwrap();
        count += 1;
        if count % 8 != 0 {
            continue;
        }
        motion.fill(FieldMotion::default());
        sampler.add_motion(model.time(), &mut motion);
        for (node, exact) in (0..).zip(&motion) {
            missed += (model.displacement(node) - exact.displacement).norm_squared();
            all += exact.displacement.norm_squared();
        }
    }
    (missed / all).sqrt()
}

/// At slownesses up to 0.89 of that of P waves a bay errs by less than with periodic pairs under waves across y.
#[test]
fn a_bay_moves_as_the_free_field_at_any_azimuth() {
    // Across y the pairs are periodic.
    let plain = error(SV, [20.0, 0.0], SolidKernel::Hex8Full);
    for (kind, incidence, azimuth) in [
        (SV, 20.0, 45.0),
        (SV, 20.0, 90.0),
        (SV, 30.0, 90.0),
        (P, 60.0, 45.0),
        (SH, 30.0, -90.0),
    ] {
        for kernel in [SolidKernel::Hex8Full, SolidKernel::ONE_POINT] {
            let found = error(kind, [incidence, azimuth], kernel);
            println!("{kind} at {incidence} and {azimuth} degrees: {found:.3e}, {plain:.3e}");
            assert!(
                found < plain,
                "{kind} {incidence} {azimuth} {kernel:?}: {found}"
            );
        }
    }
}
