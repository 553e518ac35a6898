//! Cost of a field in layered ground: nodal forces at the nodes of five faces of a box with 61 heights, per
//! node and step, P and SV; and of the tables of one height.
//!
//! `cargo bench --bench layered`; the inverse of the throughput is the time per node.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use powerhouse::boundary::ViscousSpring;
use powerhouse::model::{AbsorbingBoundary, BoundarySite, ElasticMedium, Facet, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, Ground, GroundLayer, LayeredWave, LayeredWaveParameters, Ricker, RickerQuantity,
    WaveKind,
};

const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

fn medium(young: f64, density: f64) -> ElasticMedium {
    ElasticMedium::new(young, 0.4, density).expect("the medium of the benchmark is valid")
}

fn ground() -> Ground {
    let layers = vec![
        GroundLayer::new(-20.0, medium(0.2e9, 1800.0)),
        GroundLayer::new(-40.0, medium(0.9e9, 2000.0)),
    ];
    Ground::new(0.0, layers, medium(5e9, 2300.0)).expect("the ground of the benchmark is valid")
}

fn wave() -> LayeredWave {
    let mut parameters = LayeredWaveParameters::vertical(WaveKind::SV, ground(), -60.0);
    parameters.incidence = Angle::from_degrees(15.0);
    parameters.azimuth = Angle::from_degrees(30.0);
    let ricker = Ricker::new(RickerQuantity::Displacement, 0.01, 3.0, 0.6)
        .expect("the pulse of the benchmark is valid");
    LayeredWave::new(parameters, Arc::new(ricker)).expect("the wave of the benchmark is valid")
}

fn input(criterion: &mut Criterion) {
    let (low, high) = (Vec3::new(0.0, 0.0, -60.0), Vec3::new(60.0, 60.0, 0.0));
    let mesh = Mesh::box_of_hexes(low, high, [40, 40, 60], "ground")
        .expect("the mesh of the benchmark is valid");
    let facets: Vec<(&str, &[Facet])> = FACES
        .iter()
        .map(|&face| (face, mesh.facet_set(face).expect("a box has this face")))
        .collect();
    let medium = |element: u32| {
        let nodes = mesh.nodes_of(element).iter();
        let sum: f64 = nodes.map(|&node| mesh.positions()[node as usize].z).sum();
        ground().medium_at(sum / 8.0)
    };
    let wave = wave();
    let centre = Vec3::new(30.0, 30.0, 0.0);
    let site = BoundarySite::from_mesh(&mesh, &facets, medium, centre, Some(&wave));
    let mut loads = ViscousSpring::default()
        .build(&site)
        .expect("the boundary is valid")
        .loads;
    let nodes: usize = loads.iter().map(|load| load.nodes().len()).sum();
    println!("{nodes} nodes, {:?}", wave.report());
    let mut forces = vec![Vec3::zeros(); nodes];
    let mut group = criterion.benchmark_group("layered input");
    group.throughput(Throughput::Elements(nodes as u64));
    let mut time = 0.0;
    group.bench_function("SV 15 degrees, 61 heights", |bench| {
        bench.iter(|| {
            time = if time < 2.0 { time + 5e-4 } else { 0.0 };
            for load in &mut loads {
                let count = load.nodes().len();
                load.add_forces(time, black_box(&mut forces[..count]));
            }
        });
    });
    group.finish();
}

criterion_group!(benches, input);
criterion_main!(benches);
