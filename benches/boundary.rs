//! Cost of the input: nodal forces of the free field at the nodes of five faces of a box, per node, with
//! the incident wave and its two reflections.
//!
//! `cargo bench --bench boundary`; the inverse of the throughput is the time per node.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use powerhouse::boundary::ViscousSpring;
use powerhouse::material::media;
use powerhouse::model::{AbsorbingBoundary, BoundarySite, Facet, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, BaselineCorrection, EndDisplacement, PlaneWave, PlaneWaveParameters, TimeHistory,
    WaveKind,
};

const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

/// A record of 20 s, as a digitised accelerogram is.
fn record() -> powerhouse::wavefield::RecordSignal {
    let acceleration = (0..1000)
        .map(|i| f64::from(i) * 0.02)
        .map(|t| (6.0 * t).sin() * (1.1 * t).cos() * (-0.1 * t).exp())
        .collect();
    TimeHistory::new(0.02, acceleration)
        .and_then(|history| history.corrected(BaselineCorrection::VelocityPolynomial { order: 5 }))
        .and_then(|(history, _)| history.into_signal(EndDisplacement::Zero))
        .expect("the record of the benchmark is valid")
}

fn input(criterion: &mut Criterion) {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(200.0), [40; 3], "rock")
        .expect("the mesh of the benchmark is valid");
    let facets: Vec<(&str, &[Facet])> = FACES
        .iter()
        .map(|&face| (face, mesh.facet_set(face).expect("a box has this face")))
        .collect();
    let signal = Arc::new(record());
    let mut group = criterion.benchmark_group("boundary input");
    for (name, incidence) in [
        ("below critical, 30 degrees", 30.0),
        ("past critical, 45 degrees", 45.0),
    ] {
        let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, media::ROCK, 200.0);
        parameters.incidence = Angle::from_degrees(incidence);
        let wave = PlaneWave::new(parameters, signal.clone()).expect("the wave is valid");
        let centre = Vec3::new(100.0, 100.0, 200.0);
        let site = BoundarySite::from_mesh(&mesh, &facets, |_| media::ROCK, centre, Some(&wave));
        let mut loads = ViscousSpring::default()
            .build(&site)
            .expect("the boundary is valid")
            .loads;
        let nodes: usize = loads.iter().map(|load| load.nodes().len()).sum();
        let mut forces = vec![Vec3::zeros(); nodes];
        group.throughput(Throughput::Elements(nodes as u64));
        let mut time = 0.0;
        group.bench_function(name, |bench| {
            bench.iter(|| {
                time = if time < 20.0 { time + 1e-4 } else { 0.0 };
                for load in &mut loads {
                    let count = load.nodes().len();
                    load.add_forces(time, black_box(&mut forces[..count]));
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, input);
criterion_main!(benches);
