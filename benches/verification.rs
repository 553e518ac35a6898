//! Cost of problems with known solutions for different numerical options; the errors are in `docs/verification.md`.
//!
//! `cargo bench -p powerhouse-benches --bench verification`

use criterion::{Criterion, criterion_group, criterion_main};
use powerhouse::engine::{Precision, SolidKernel};
use powerhouse::wavefield::{RaisedCosinePulse, WaveKind};
use powerhouse_examples::block::{BlockWave, Choices};
use powerhouse_examples::cavity::{CavityModel, Incoming, pulse};
use powerhouse_examples::interface::computed;

/// The free field of an SV wave at 15 degrees in 16 bricks along an edge.
fn free_field(criterion: &mut Criterion) {
    let pulse = RaisedCosinePulse::new(1.0, 0.8).expect("the pulse is valid");
    let wave = BlockWave::new(WaveKind::SV, 15.0, pulse);
    let base = Choices {
        elements: 16,
        ..Choices::default()
    };
    let kernel = |kernel| Choices {
        kernel: Some(kernel),
        ..base.clone()
    };
    let precision = |precision| Choices {
        precision,
        ..base.clone()
    };
    let half = Choices {
        step: 0.5,
        ..base.clone()
    };
    let mut group = criterion.benchmark_group("free field");
    group.sample_size(10);
    for (name, choices) in [
        ("one point", base.clone()),
        ("2 x 2 x 2 points", kernel(SolidKernel::Hex8Full)),
        ("B-bar", kernel(SolidKernel::Hex8BBar)),
        ("mixed", precision(Precision::Mixed)),
        ("single", precision(Precision::F32)),
        ("half the stable step", half),
    ] {
        group.bench_function(name, |bench| {
            bench.iter(|| wave.run(&choices).expect("the scene runs"));
        });
    }
}

/// A cavity that scatters a P wave, for different element lengths.
fn scattering(criterion: &mut Criterion) {
    let wave = Incoming {
        kind: WaveKind::P,
        degrees: 0.0,
        signal: pulse().expect("the pulse is valid"),
        begin: 0.0,
        end: 20.0,
    };
    let mut group = criterion.benchmark_group("cavity");
    group.sample_size(10);
    for edge in [0.4, 0.2] {
        let model = CavityModel {
            edge,
            far: [0.4, 0.4],
            half_width: 10.0,
            height: 8.0,
            ..CavityModel::BEST
        };
        group.bench_function(format!("bricks of {edge} radii"), |bench| {
            bench.iter(|| model.motion(&wave).expect("the scene runs"));
        });
    }
}

/// A slipping interface, for different numbers of elements per wavelength.
fn interface(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("joint");
    group.sample_size(10);
    for bricks in [12, 20, 40] {
        group.bench_function(format!("{bricks} bricks per wavelength"), |bench| {
            bench.iter(|| computed(0.5, bricks).expect("the column moves"));
        });
    }
}

criterion_group!(benches, free_field, scattering, interface);
criterion_main!(benches);
