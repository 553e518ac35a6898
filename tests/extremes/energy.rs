//! The energy balance over long runs.

use powerhouse::engine::{BuildModel, Leapfrog, run};
use powerhouse_boundary::ViscousSpring;
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::media;
use powerhouse_model::{EnergyCheck, RunOptions, Vec3};
use powerhouse_tests::{Ground, oblique_waves};
use powerhouse_wavefield::WaveKind;

const SIZE: Vec3 = Vec3::new(40.0, 30.0, 30.0);
const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

/// In an elastic box of distorted elements under oblique P and SV waves through viscous springs, the energy
/// balance closes to 1e-9 of the input work over a hundred thousand steps, for every kernel.
#[test]
fn the_balance_of_a_box_under_oblique_waves_closes() {
    for kernel in SolidKernel::ALL {
        let bend = |a: f64, b: f64| 1.5 * (0.13 * a + 0.07 * b).sin();
        let mut ground = Ground::boxed(SIZE, [4, 3, 3], media::ROCK, kernel)
            .mapped(|p| p + Vec3::new(bend(p.y, p.z), bend(p.z, p.x), 0.0));
        ground.threads = Some(1);
        let waves = [(WaveKind::SV, 25.0), (WaveKind::P, 15.0)];
        let field = oblique_waves(media::ROCK, SIZE, &waves, 37.0, 0.4);
        let mut model = ground
            .with_boundary(&ViscousSpring::default(), &FACES, Some(&field))
            .build()
            .unwrap();
        let options = RunOptions::steps(100_000).with_energy(EnergyCheck::every(1_000));
        let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        let column = |name| {
            let mut columns = report.energies.iter();
            columns.find(|(column, _)| *column == name).unwrap().1
        };
        let input = column("loads").abs();
        assert!(column("dashpots") > 0.5 * input && input > 1.0);
        let residual = column("residual").abs() / input;
        assert!(residual < 1e-9, "{}: {residual:e}", kernel.name());
    }
}
