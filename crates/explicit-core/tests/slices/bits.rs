//! Bits of slices: slowness zero, threads, resumed runs.

use std::sync::Arc;

use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{
    BlockOptions, DelayedPairs, EnergyCheck, Mesh, ModelSpec, PeriodicPairs, RunOptions,
    StaticOptions, StepChoice, Support, TimeIntegrator, Vec3,
};
use powerhouse_wavefield::WaveKind;

use super::{pairs, rock, slowness, spec, wave};
use crate::support::{KeepAfter, bits_of_motion};

const ANGLES: [f64; 2] = [25.0, 50.0];

fn small() -> Mesh {
    let (low, high) = (Vec3::new(-60.0, -2.0, -60.0), Vec3::new(60.0, 2.0, 0.0));
    Mesh::box_of_hexes(low, high, [12, 1, 6], "rock").unwrap()
}

/// At slowness zero delayed pairs are periodic ones, to the bit.
#[test]
fn pairs_without_delay_are_periodic() {
    let mesh = small();
    let angles = [25.0, 0.0];
    let field = wave(WaveKind::SV, angles, (8.0, 0.2));
    let run_of = |spec: ModelSpec| {
        let mut model = spec.build().unwrap();
        for _ in 0..200 {
            Leapfrog.step(&mut model, 5e-4).unwrap();
        }
        bits_of_motion(&model)
    };
    let delayed = spec(
        &mesh,
        SolidKernel::Hex8Natural,
        &field,
        slowness(WaveKind::SV, angles),
    );
    let delayed = run_of(delayed.unwrap());
    let mut tied = spec(&mesh, SolidKernel::Hex8Natural, &field, 0.0).unwrap();
    tied.delayed = None;
    let pairs = pairs(&mesh);
    let tied = run_of(tied.periodic(PeriodicPairs { pairs }));
    assert!(delayed == tied);
    assert!(tied.iter().flatten().any(|bits| *bits != 0));
}

/// With a slowness that goes to zero the motion goes to that of the plain slice.
#[test]
fn a_small_delay_changes_little() {
    let mesh = small();
    let field = wave(WaveKind::SV, [25.0, 0.0], (8.0, 0.2));
    let moved = |slowness: f64| {
        let mut model = spec(&mesh, SolidKernel::Hex8Full, &field, slowness)
            .unwrap()
            .build()
            .unwrap();
        for _ in 0..600 {
            Leapfrog.step(&mut model, 5e-4).unwrap();
        }
        let all = 0..mesh.node_count() as u32;
        all.map(|node| model.displacement(node))
            .collect::<Vec<Vec3>>()
    };
    let plain = moved(0.0);
    let size = plain.iter().map(|u| u.norm()).fold(0.0, f64::max);
    let apart = |other: &[Vec3]| {
        let differences = plain.iter().zip(other).map(|(a, b)| (a - b).norm());
        differences.fold(0.0, f64::max) / size
    };
    let [first, second] = [1e-6, 1e-7].map(|s| apart(&moved(s)));
    assert!(
        first < 1e-2 && second < 0.2 * first && second > 0.0,
        "{first:e} {second:e}"
    );
}

/// Results do not depend on the number of threads.
#[test]
fn threads_change_no_bit_of_a_slice() {
    let mesh = small();
    let field = wave(WaveKind::P, [40.0, 60.0], (8.0, 0.2));
    let of = |threads: usize| {
        let slowness = slowness(WaveKind::P, [40.0, 60.0]);
        let spec = spec(&mesh, SolidKernel::Hex8Eas, &field, slowness).unwrap();
        let mut model = spec.threads(threads).block_size(17).build().unwrap();
        let options = RunOptions::steps(150).with_energy(EnergyCheck::every(20));
        let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        (bits_of_motion(&model), report.energies)
    };
    assert!(of(1) == of(3));
}

/// A resumed run ends with the same bits, energies included.
#[test]
fn a_resumed_slice_has_the_same_bits() {
    let mesh = small();
    let field = wave(WaveKind::SV, ANGLES, (8.0, 0.2));
    let build = || {
        let slowness = slowness(WaveKind::SV, ANGLES);
        let spec = spec(&mesh, SolidKernel::Hex8Full, &field, slowness).unwrap();
        spec.build().unwrap()
    };
    let options = || {
        let options = RunOptions::steps(140).with_energy(EnergyCheck::every(10));
        options.with_step(StepChoice::Fixed(1e-3))
    };
    let sink = KeepAfter::new(73);
    let mut whole = build();
    let kept = options().with_checkpoints(sink.clone());
    let first = run(&mut whole, &Leapfrog, &kept, &mut [], &mut |_| {}).unwrap();
    let saved = sink.saved();
    let mut rest = build();
    let resumed = options().with_resume(Arc::new(saved));
    let second = run(&mut rest, &Leapfrog, &resumed, &mut [], &mut |_| {}).unwrap();
    assert!(bits_of_motion(&whole) == bits_of_motion(&rest));
    assert_eq!(first.energies, second.energies);
    assert_eq!(
        first.energy_residual.to_bits(),
        second.energy_residual.to_bits()
    );
}

/// A slice that was brought into equilibrium under its weight stays still when it may move.
#[test]
fn a_slice_in_equilibrium_stays_still() {
    let mesh = small();
    let law = LinearElastic::new(rock());
    let build = |moves: bool| {
        let factory = SolidKernel::Hex8Natural.factory("rock", law, BlockOptions::default());
        let bottom = mesh.nodes_of_facets(mesh.facet_set("bottom").unwrap());
        let spec = Model::builder(&mesh)
            .elements("rock", factory)
            .gravity(Vec3::new(0.0, 0.0, -9.81), Box::new(|_: f64| 1.0))
            .support(Support::fixed(bottom));
        let (pairs, slowness) = (pairs(&mesh), 0.7 / rock().p_speed());
        if moves {
            spec.delayed(DelayedPairs {
                pairs,
                slowness,
                ..DelayedPairs::default()
            })
        } else {
            spec.periodic(PeriodicPairs { pairs })
        }
    };
    let mut resting = build(false).build().unwrap();
    let options = StaticOptions {
        tolerance: 1e-12,
        ..StaticOptions::default()
    };
    resting.equilibrate(&options, &mut |_| {}).unwrap();
    let state = resting.state();
    let settled = (state.displacement.iter().map(|u| u.norm())).fold(0.0, f64::max);
    let mut model = build(true).start(state.clone()).build().unwrap();
    for _ in 0..400 {
        Leapfrog.step(&mut model, 1e-3).unwrap();
    }
    let moved = (0..mesh.node_count() as u32)
        .map(|node| (model.displacement(node) - state.displacement[node as usize]).norm());
    let moved = moved.fold(0.0, f64::max);
    assert!(
        settled > 1e-5 && moved < 1e-8 * settled,
        "{moved:e} of {settled:e}"
    );
}
