//! The same bits, however the work is divided.

use powerhouse_boundary::ViscousSpring;
use powerhouse_explicit_core::{LaneWidth, Leapfrog, Precision, RunOptions, SolidKernel, run};
use powerhouse_material_damage::media;
use powerhouse_model::Vec3;
use powerhouse_tests::{Ground, oblique_waves};
use powerhouse_wavefield::WaveKind;

const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

/// The bits of every node's displacement and velocity after 60 steps of an oblique wave through a
/// box with an absorbing boundary. The box is large enough for several blocks and loads, and its
/// cells fill no lane evenly.
fn bits(precision: Precision, lanes: LaneWidth, threads: usize) -> Vec<u64> {
    let size = Vec3::new(150.0, 130.0, 110.0);
    let kernel = SolidKernel::Hex8OnePoint(Default::default());
    let mut ground = Ground::boxed(size, [15, 13, 11], media::ROCK, kernel)
        .mapped(|p| p + 2.0 * Vec3::new((p.y * 0.1).sin(), (p.x * 0.09).cos(), 0.0));
    ground.options.precision = precision;
    ground.options.lanes = lanes;
    ground.threads = Some(threads);
    let waves = [(WaveKind::SV, 30.0), (WaveKind::P, 10.0)];
    let field = oblique_waves(media::ROCK, size, &waves, 37.0, 0.1);
    let mut model = ground
        .with_boundary(&ViscousSpring::default(), &FACES, Some(&field))
        .part_size(512)
        .build()
        .unwrap();
    let options = RunOptions::steps(60);
    run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    let nodes = 0..ground.mesh.node_count() as u32;
    let moved = nodes
        .clone()
        .any(|node| model.displacement(node).norm() > 0.1);
    assert!(moved, "the wave has not arrived");
    nodes
        .flat_map(|node| [model.displacement(node), model.velocity(node)])
        .flat_map(|v| [v.x, v.y, v.z])
        .map(f64::to_bits)
        .collect()
}

/// One, two and four threads give the same bits, in every precision.
#[test]
fn threads_do_not_change_a_bit() {
    for precision in [Precision::F64, Precision::Mixed, Precision::F32] {
        let one = bits(precision, LaneWidth::Native, 1);
        for threads in [2, 4] {
            assert!(
                one == bits(precision, LaneWidth::Native, threads),
                "{precision:?} {threads}"
            );
        }
    }
}

/// One element at a time gives the same bits as a register full of them, in every precision.
#[test]
fn lanes_do_not_change_a_bit() {
    for precision in [Precision::F64, Precision::Mixed, Precision::F32] {
        let native = bits(precision, LaneWidth::Native, 2);
        assert!(
            native == bits(precision, LaneWidth::One, 2),
            "{precision:?}"
        );
    }
}
