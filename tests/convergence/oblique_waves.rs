//! Simultaneous oblique P and SV waves in a distorted block of rock under a free surface: an exact solution in
//! every element, which verifies kernel, integrator, boundary and free field together.
//!
//! ```text
//!            free surface
//!        +------------------+
//!        |  .   /  .   \    |   every other face: viscous springs with the full free field;
//!        |    ./      .     |   inside, no element is a parallelepiped
//!        | .      .      .  |
//!        +------------------+
//!          /      /
//!         P 25   SV 15 degrees, azimuth 37
//! ```

use powerhouse::engine::BuildModel;
use powerhouse_boundary::ViscousSpring;
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::media;
use powerhouse_model::{Precision, Vec3};
use powerhouse_tests::{Ground, field_misfit, oblique_waves};
use powerhouse_wavefield::WaveKind;

const SIZE: f64 = 120.0;
const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

/// A pseudo-random number from -1 to 1 from a node's position.
fn scatter(p: &Vec3, seed: f64) -> f64 {
    let x = (p.x * 12.9898 + p.y * 78.233 + p.z * 37.719 + seed).sin() * 43758.547;
    2.0 * (x - x.floor()) - 1.0
}

/// A smooth distortion of the whole block, the same on every mesh, and an irregular one of the
/// inner nodes by a tenth of the element size. The top stays flat.
fn distorted(p: Vec3, element: f64) -> Vec3 {
    let wave = |a: f64, b: f64| 0.03 * SIZE * (6.0 * a / SIZE).sin() * (5.0 * b / SIZE).cos();
    let below = (p.z / SIZE * core::f64::consts::PI).sin();
    let smooth = Vec3::new(wave(p.y, p.z), wave(p.z, p.x), below * wave(p.x, p.y));
    let inside = p
        .iter()
        .all(|&x| x > 0.1 * element && x < SIZE - 0.1 * element);
    let irregular = Vec3::new(scatter(&p, 0.0), scatter(&p, 1.0), scatter(&p, 2.0));
    p + smooth
        + if inside {
            0.1 * element * irregular
        } else {
            Vec3::zeros()
        }
}

fn error(kernel: SolidKernel, precision: Precision, cells: usize) -> f64 {
    let element = SIZE / cells as f64;
    let size = Vec3::repeat(SIZE);
    let mut ground =
        Ground::boxed(size, [cells; 3], media::ROCK, kernel).mapped(|p| distorted(p, element));
    ground.options.precision = precision;
    let waves = [(WaveKind::P, 25.0), (WaveKind::SV, 15.0)];
    let field = oblique_waves(media::ROCK, size, &waves, 37.0, 0.16);
    let mut model = ground
        .with_boundary(&ViscousSpring::default(), &FACES, Some(&field))
        .build()
        .unwrap();
    field_misfit(&mut model, &field, 0.4)
}

/// Second order in the element size: the slope between the two finest of four meshes is 2 +- 0.15.
fn assert_second_order(kernel: SolidKernel) {
    let cells = [8, 12, 18, 27];
    let errors = cells.map(|cells| error(kernel, Precision::F64, cells));
    let slope = |i: usize| (errors[i] / errors[i + 1]).ln() / 1.5_f64.ln();
    println!(
        "{}: errors {errors:.3?}, slopes {:.2} {:.2} {:.2}",
        kernel.name(),
        slope(0),
        slope(1),
        slope(2)
    );
    assert!(
        (slope(2) - 2.0).abs() < 0.15,
        "{}: {errors:?}",
        kernel.name()
    );
    for precision in [Precision::Mixed, Precision::F32] {
        let error = error(kernel, precision, cells[2]);
        println!("{}: {precision:?} {error:.3e}", kernel.name());
    }
}

/// The one-point brick with hourglass control converges at second order on distorted elements.
#[test]
fn one_point_bricks_converge() {
    assert_second_order(SolidKernel::Hex8OnePoint(Default::default()));
}

/// The fully integrated brick converges at second order.
#[test]
fn full_bricks_converge() {
    assert_second_order(SolidKernel::Hex8Full);
}

/// The brick with averaged dilatation (B-bar) converges at second order.
#[test]
fn bbar_bricks_converge() {
    assert_second_order(SolidKernel::Hex8BBar);
}

/// The wedge converges at second order.
#[test]
fn wedges_converge() {
    assert_second_order(SolidKernel::Wedge6);
}

/// The tetrahedron converges at second order.
#[test]
fn tetrahedra_converge() {
    assert_second_order(SolidKernel::Tet4);
}
