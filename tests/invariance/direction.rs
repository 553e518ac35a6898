//! Independence of the motion from the direction of the axes.

use powerhouse::engine::{BuildModel, Leapfrog, run};
use powerhouse_boundary::ViscousSpring;
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::media;
use powerhouse_model::{Mat3, RunOptions, StepChoice, Vec3};
use powerhouse_tests::{Ground, oblique_waves};
use powerhouse_wavefield::WaveKind;

const SIZE: Vec3 = Vec3::new(100.0, 80.0, 60.0);
const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

/// Displacements of all nodes after 80 steps of waves under an azimuth (degrees), in a box that is
/// turned about its first corner by `turn` degrees.
fn displacements(kernel: SolidKernel, azimuth: f64, turn: f64) -> Vec<Vec3> {
    let rotation = vertical(turn);
    let ground = Ground::boxed(SIZE, [6, 5, 4], media::ROCK, kernel).mapped(|p| rotation * p);
    let waves = [
        (WaveKind::SV, 25.0),
        (WaveKind::P, 40.0),
        (WaveKind::SH, 10.0),
    ];
    // The corner that is hit first stays at the origin: the azimuth lies within the first quadrant
    // of the box, turned or not.
    let field = oblique_waves(media::ROCK, SIZE, &waves, azimuth, 0.1);
    let mut model = ground
        .with_boundary(&ViscousSpring::default(), &FACES, Some(&field))
        .build()
        .unwrap();
    let options = RunOptions::steps(80).with_step(StepChoice::Fixed(1.5e-3));
    run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    let nodes = 0..ground.mesh.node_count() as u32;
    nodes.map(|node| model.displacement(node)).collect()
}

fn vertical(degrees: f64) -> Mat3 {
    *nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), degrees.to_radians()).matrix()
}

/// The motion of a model that is rotated about the vertical together with its wave is the rotated motion:
/// kernel, oblique boundary and free field have no preferred direction.
#[test]
fn a_turned_model_moves_alike() {
    for kernel in SolidKernel::ALL {
        let straight = displacements(kernel, 20.0, 0.0);
        let scale = straight.iter().map(Vec3::norm).fold(0.0, f64::max);
        assert!(scale > 0.3, "the wave has not arrived: {scale}");
        let turned = displacements(kernel, 57.0, 37.0);
        let back = vertical(-37.0);
        for (a, b) in straight.iter().zip(&turned) {
            assert!(
                (a - back * b).norm() < 1e-11 * scale,
                "{}: {a} {b}",
                kernel.name()
            );
        }
    }
}
