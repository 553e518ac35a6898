//! Cost of a joint: isolated node pairs that slip, stick or open, without an engine and in whole steps of an engine.
//!
//! `cargo bench --bench joint`; the inverse of the throughput is the time per pair and step. In whole steps it is the
//! time of a split body with the joint, its law behind a pointer as in scenes, less that of the same body without it. The
//! cost of the split itself, an additional node for each pair with its forces and motion, is `steps/cut`: the split body
//! without a joint, less the continuous one.

use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use powerhouse::contact::{BondedCoulomb, Joint, JointSurface, SurfaceOptions};
use powerhouse::engine::{
    BlockOptions, BuildModel, Hex8OnePoint, Leapfrog, Model, RunOptions, SolidKernel, StepChoice,
    run,
};
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{
    Constraint, ContactLaw, JointPair, Mat3, Mesh, PredictedMotion, StepTime, Vec3,
};

const PAIRS: u32 = 20_000;

fn pairs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("joint");
    group.throughput(Throughput::Elements(u64::from(PAIRS)));
    let step = 1e-4;
    let count = 2 * PAIRS as usize;
    let inverse_mass = vec![Mat3::identity() / 700.0; count];
    let rest = vec![Vec3::zeros(); count];
    for (name, pull) in [
        ("stick", Vec3::new(1e-3, 0.0, -1e-2)),
        ("slide", Vec3::new(1e-1, 3e-2, -1e-2)),
        ("open", Vec3::new(0.0, 0.0, 1e-2)),
    ] {
        let all = (0..PAIRS).map(|pair| JointPair::new([2 * pair, 2 * pair + 1], Vec3::z(), 1.0));
        let law = BondedCoulomb::unbonded(0.6, 0.5).expect("a law");
        let mut joint = Joint::new("joint", all.collect(), law).expect("a joint");
        joint.prepare(step, &inverse_mass);
        let predicted = |node: usize| if node % 2 == 1 { pull } else { Vec3::zeros() };
        let predicted: Vec<Vec3> = (0..count).map(predicted).collect();
        let mut velocity = predicted.clone();
        group.bench_function(name, |bench| {
            bench.iter(|| {
                velocity.copy_from_slice(&predicted);
                let when = StepTime {
                    number: 0,
                    time: 0.0,
                    step,
                };
                let motion = PredictedMotion::new(when, &rest, &rest, &mut velocity, &inverse_mass);
                joint.correct(motion).expect("a solution")
            });
        });
    }
    group.finish();
}

/// Elements along each edge of two layers in contact.
const BRICKS: usize = 100;

/// Steps of a timed run.
const STEPS: u64 = 20;

/// Two layers of elements, and the same mesh split with the surfaces of the joint.
fn layers() -> (Mesh, Mesh, JointSurface) {
    let edge = BRICKS as f64;
    let size = Vec3::new(edge, edge, 2.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [BRICKS, BRICKS, 2], "rock");
    let mesh = mesh.expect("a mesh");
    let elements = 0..mesh.element_count() as u32;
    let (lower, upper): (Vec<u32>, Vec<u32>) = elements.partition(|&e| mesh.centroid(e).z < 1.0);
    let split = mesh.split_between(&lower, &upper).expect("two layers");
    let options = SurfaceOptions::within(1e-6).expect("options");
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
    (mesh, split.mesh, surface.expect("matching sides"))
}

type AnyJoint = Joint<Box<dyn ContactLaw>>;

/// A moving body, with or without a joint.
fn body(mesh: &Mesh, joint: Option<AnyJoint>) -> Model {
    let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::default());
    let law = LinearElastic::new(media::ROCK);
    let mut builder = Model::builder(mesh)
        .elements("rock", kernel.factory("rock", law, BlockOptions::default()))
        .threads(1);
    if let Some(joint) = joint {
        builder = builder.constraint(Box::new(joint));
    }
    let mut model = builder.build().expect("a model");
    let noise = |x: &Vec3, k: f64| (12.9898 * x.x + 78.233 * x.y + 37.719 * x.z + k).sin();
    let of = |x: &Vec3| Vec3::new(noise(x, 0.1), noise(x, 0.7), noise(x, 1.9)) * 1e-4;
    let velocity: Vec<Vec3> = mesh.positions().iter().map(of).collect();
    let rest = vec![Vec3::zeros(); velocity.len()];
    model.set_initial(&rest, &velocity).expect("a motion");
    model
}

/// Time per step of the first body less that of the second; both are timed alternately, under the same load of the
/// machine.
fn difference([first, second]: &mut [Model; 2], runs: u64) -> Duration {
    let options = RunOptions::steps(STEPS).with_step(StepChoice::Unchecked(1e-5));
    let taken = |model: &mut Model| {
        let start = Instant::now();
        run(model, &Leapfrog, &options, &mut [], &mut |_| {}).expect("steps");
        start.elapsed()
    };
    let mut sums = [Duration::ZERO; 2];
    for _ in 0..runs {
        sums[0] += taken(first);
        sums[1] += taken(second);
    }
    // Noise may make the difference of a few steps negative.
    (sums[0].saturating_sub(sums[1]) / STEPS as u32).max(Duration::from_nanos(runs))
}

fn steps(criterion: &mut Criterion) {
    let (whole, cut, surface) = layers();
    let friction = |value| -> Box<dyn ContactLaw> {
        Box::new(BondedCoulomb::unbonded(value, value).expect("a law"))
    };
    let joint = |value| {
        let pairs = surface.pairs.clone();
        Joint::new("joint", pairs, friction(value)).expect("a joint")
    };
    let pressed = |joint: AnyJoint| {
        let joint = joint.with_preload(|pair| pair.normal * -1e8);
        joint.expect("a pressure")
    };
    let apart = joint(0.5).with_gaps(|_| 1.0).expect("a gap");
    let mut group = criterion.benchmark_group("joint/steps");
    group.throughput(Throughput::Elements(surface.pairs.len() as u64));
    let mut measure = |name: &str, mut bodies: [Model; 2]| {
        group.bench_function(name, |bench| {
            bench.iter_custom(|runs| difference(&mut bodies, runs));
        });
    };
    for (name, joint) in [
        ("stick", pressed(joint(10.0))),
        ("slide", pressed(joint(1e-6))),
        ("open", apart),
    ] {
        measure(name, [body(&cut, Some(joint)), body(&cut, None)]);
    }
    measure("cut", [body(&cut, None), body(&whole, None)]);
    group.finish();
}

criterion_group!(benches, pairs, steps);
criterion_main!(benches);
