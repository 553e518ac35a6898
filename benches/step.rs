//! Cost of a whole step, forces and update, without input: 132,651 elastic hexahedra, all equal (with a shared geometry) or
//! all different.
//!
//! `cargo bench --bench step`; the inverse of the throughput is the time per element.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use powerhouse::engine::{
    BlockOptions, BuildModel, Hex8OnePoint, Leapfrog, Model, Precision, SolidKernel,
};
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{Mesh, TimeIntegrator, Vec3};

const CELLS: usize = 51;

fn equal_bricks() -> Mesh {
    let size = CELLS as f64;
    Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(size), [CELLS; 3], "rock")
        .expect("the mesh of the benchmark is valid")
}

fn distorted_bricks() -> Mesh {
    let shift = |a: f64, b: f64| 0.15 * (1.7 * a).sin() * (1.3 * b).cos();
    equal_bricks()
        .map_positions(|x| x + Vec3::new(shift(x.y, x.z), shift(x.z, x.x), shift(x.x, x.y)))
        .expect("the mesh of the benchmark is valid")
}

fn model(mesh: &Mesh, kernel: SolidKernel, precision: Precision, threads: usize) -> Model {
    let mut options = BlockOptions::default();
    options.precision = precision;
    let law = LinearElastic::new(media::ROCK);
    let mut model = Model::builder(mesh)
        .elements("rock", kernel.factory("rock", law, options))
        .threads(threads)
        .build()
        .expect("the model of the benchmark is valid");
    // Any motion other than zero, which might be faster.
    let noise = |x: &Vec3, k: f64| (12.9898 * x.x + 78.233 * x.y + 37.719 * x.z + k).sin();
    let motion = |scale: f64| -> Vec<Vec3> {
        let of = |x: &Vec3| Vec3::new(noise(x, 0.1), noise(x, 0.7), noise(x, 1.9)) * scale;
        mesh.positions().iter().map(of).collect()
    };
    model
        .set_initial(&motion(1e-6), &motion(1e-4))
        .expect("the motion fits the mesh");
    model
}

fn steps(criterion: &mut Criterion) {
    let one_point = SolidKernel::Hex8OnePoint(Hex8OnePoint::default());
    for (shapes, mesh) in [("equal", equal_bricks()), ("distorted", distorted_bricks())] {
        let mut group = criterion.benchmark_group(format!("step/{shapes}"));
        group.sample_size(20);
        group.throughput(Throughput::Elements(mesh.element_count() as u64));
        for threads in [1, 2] {
            for (kernel, precision, name) in [
                (one_point, Precision::F64, "f64"),
                (one_point, Precision::Mixed, "mixed"),
                (one_point, Precision::F32, "f32"),
                (SolidKernel::Hex8Natural, Precision::F64, "f64"),
                (SolidKernel::Hex8Natural, Precision::Mixed, "mixed"),
                (SolidKernel::Hex8Full, Precision::F64, "f64"),
            ] {
                let mut model = model(&mesh, kernel, precision, threads);
                let step = 0.3 / media::ROCK.p_speed();
                let name = format!("{}/{name}/{threads} threads", kernel.name());
                group.bench_function(name, |bench| {
                    bench.iter(|| Leapfrog.step(&mut model, step).expect("a stable step"));
                });
            }
        }
        group.finish();
    }
}

criterion_group!(benches, steps);
criterion_main!(benches);
