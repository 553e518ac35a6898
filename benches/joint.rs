//! The cost of a joint: isolated pairs that slide, stick or open, without an engine around them.
//!
//! `cargo bench --bench joint`; the inverse of the throughput is the time per pair and step.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use powerhouse::contact::{BondedCoulomb, Joint};
use powerhouse::model::{Constraint, JointPair, Mat3, PredictedMotion, Vec3};

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
                let when = (0, 0.0, step);
                let motion = PredictedMotion::new(when, &rest, &rest, &mut velocity, &inverse_mass);
                joint.correct(motion).expect("a solution")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, pairs);
criterion_main!(benches);
