//! Stable step, energy and bits of slices in free motion.

use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{
    BlockOptions, BoundaryParts, DelayedPairs, EnergyCheck, Mat3, Mesh, NodalImpedance, RunError,
    RunOptions, StepChoice, Support, TimeIntegrator, Vec3,
};

use super::{pairs, rock};

/// A reproducible number in [-1, 1).
pub(crate) fn noise(seed: u64) -> f64 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A slice of 5 x 4 elements of edges around 1 m, distorted in its plane, of a thickness (m).
fn bent(distortion: f64, thickness: f64, seed: u64) -> Mesh {
    let size = Vec3::new(5.0, thickness, 4.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [5, 1, 4], "rock").unwrap();
    mesh.map_positions(|x| {
        let place = (x.x * 8.0 + x.z * 131.0).round() as u64;
        let inside = |x: f64, end: f64| f64::from(x > 0.01 && x < end - 0.01);
        let move_by = |c: u64| distortion * noise(1000 * seed + 10 * place + c);
        x + Vec3::new(
            move_by(1) * inside(x.x, 5.0),
            0.0,
            move_by(2) * inside(x.z, 4.0),
        )
    })
    .unwrap()
}

/// A free slice, or bay, at a ratio of its slowness to that of P waves.
pub(crate) fn free(mesh: &Mesh, kernel: SolidKernel, ratio: f64) -> Model {
    let law = LinearElastic::new(rock());
    Model::builder(mesh)
        .elements("rock", kernel.factory("rock", law, BlockOptions::default()))
        .delayed(DelayedPairs {
            pairs: pairs(mesh),
            slowness: ratio / rock().p_speed(),
            ..DelayedPairs::default()
        })
        .threads(1)
        .build()
        .unwrap()
}

/// Gives all pairs a random velocity (m/s).
fn shake(model: &mut Model, seed: u64) {
    let mesh = model.mesh();
    let mut velocity = vec![Vec3::zeros(); mesh.node_count()];
    for (index, (a, b)) in (0..).zip(pairs(mesh)) {
        let v = Vec3::from_fn(|c, _| noise(seed + 3 * index + c as u64));
        velocity[a as usize] = v;
        velocity[b as usize] = v;
    }
    let still = vec![Vec3::zeros(); velocity.len()];
    model.set_initial(&still, &velocity).unwrap();
}

/// Growth of the motion over a number of steps of a length (s).
pub(crate) fn growth(model: &mut Model, step: f64, steps: usize) -> f64 {
    let largest = |model: &Model| {
        let nodes = 0..model.mesh().node_count() as u32;
        nodes
            .map(|node| model.velocity(node).amax())
            .fold(0.0, f64::max)
    };
    let mut start: f64 = 0.0;
    for count in 0..steps {
        if Leapfrog.step(model, step).is_err() {
            return f64::INFINITY;
        }
        if count < 50 {
            start = start.max(largest(model));
        }
        if !largest(model).is_finite() || largest(model) > 1e6 * start {
            return f64::INFINITY;
        }
    }
    largest(model) / start
}

/// The step that is reported is between 0.95 and 1 of the one at which motion begins to grow: just below the reported
/// step over 0.98, its safety, nothing grows in 4000 steps, and 5 % above it motion grows without bound.
#[test]
fn the_stable_step_is_that_of_the_gyroscopic_operator() {
    let kernels = [
        SolidKernel::Hex8Full,
        SolidKernel::Hex8Natural,
        SolidKernel::Hex8Eas,
    ];
    // Thirty meshes, from waves across the axis to those that are nearly as slow along it as P waves.
    for case in 0..30 {
        let ratio = [0.95, -0.95][case % 2] * case as f64 / 29.0;
        let kernel = kernels[case % 3];
        let thickness = [0.1, 1.0, 0.4, 2.5][case % 4];
        let mesh = bent(0.05 * (case % 6) as f64, thickness, case as u64);
        let mut model = free(&mesh, kernel, ratio);
        let reported = model.stable_step(&Leapfrog).unwrap().step;
        shake(&mut model, 7 * case as u64);
        let below = growth(&mut model, reported, 4000);
        assert!(
            below < 30.0,
            "{kernel:?} at {ratio}: grew {below} at the reported step"
        );
        let mut model = free(&mesh, kernel, ratio);
        shake(&mut model, 7 * case as u64);
        let above = growth(&mut model, reported / 0.95, 4000);
        assert!(
            above > 1e3,
            "{kernel:?} at {ratio}: grew {above} at 1 / 0.95 of the reported step"
        );
    }
}

/// The step is below that of the plain slice, and above the bound by the slowest share of the mass.
#[test]
fn the_step_falls_with_the_slowness() {
    let mesh = bent(0.2, 0.3, 5);
    let step = |ratio: f64| {
        let mut model = free(&mesh, SolidKernel::Hex8Full, ratio);
        model.stable_step(&Leapfrog).unwrap().step
    };
    let plain = step(0.0);
    let mut last = plain;
    for (ratio, least) in [
        (0.2, 0.98),
        (0.4, 0.92),
        (0.6, 0.80),
        (0.8, 0.60),
        (0.9, 0.44),
        (0.98, 0.20),
    ] {
        let own = step(ratio);
        assert!(
            own < last && own > 0.98 * least * plain,
            "{ratio}: {} of {plain}",
            own / plain
        );
        last = own;
    }
}

/// Energy is conserved to rounding in a free linear slice, with dashpots, springs and a skew coupling on two of its sides too.
#[test]
fn the_energy_balance_closes_to_rounding() {
    for (case, kernel) in [
        SolidKernel::Hex8Full,
        SolidKernel::Hex8Natural,
        SolidKernel::Hex8Eas,
    ]
    .into_iter()
    .enumerate()
    {
        for held in [false, true] {
            let mesh = bent(0.25, 0.6, case as u64);
            let law = LinearElastic::new(rock());
            let mut spec = Model::builder(&mesh)
                .elements("rock", kernel.factory("rock", law, BlockOptions::default()))
                .delayed(DelayedPairs {
                    pairs: pairs(&mesh),
                    slowness: 0.85 / rock().p_speed(),
                    ..DelayedPairs::default()
                });
            if held {
                let nodes = mesh.nodes_of_facets(mesh.facet_set("right").unwrap());
                let normal = Vec3::new(1.0, 0.0, 0.4).normalize();
                let across = normal * Vec3::y().transpose();
                let impedance = nodes.iter().map(|&node| {
                    let dashpot = normal * normal.transpose() * 2e5 + Mat3::identity() * 1e5;
                    let spring = normal * normal.transpose() * 4e7 + Mat3::identity() * 1e7;
                    NodalImpedance::new(node, spring, dashpot)
                        .with_gyroscopic((across - across.transpose()) * 8e4)
                });
                spec = spec.boundary(BoundaryParts::default().with_impedance(impedance));
                let left = mesh.nodes_of_facets(mesh.facet_set("left").unwrap());
                spec = spec.support(Support::roller(left, Vec3::x()));
            }
            let mut model = spec.build().unwrap();
            shake(&mut model, 11);
            let options = RunOptions::steps(400).with_energy(EnergyCheck::every(10));
            let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
            let residual = report.energy_residual;
            assert!(residual < 1e-11, "{kernel:?}, held {held}: {residual:e}");
            let column = |name: &str| {
                let found = report.energies.iter().find(|(column, _)| *column == name);
                found.map_or(0.0, |(_, energy)| *energy)
            };
            assert!(column("delay").abs() > 1e-3 * column("kinetic"));
            assert_eq!(held, column("dashpots") > 0.0);
        }
    }
}

/// A step above the stable one is refused.
#[test]
fn a_step_above_the_stable_one_is_refused() {
    let mesh = bent(0.0, 0.5, 1);
    let mut model = free(&mesh, SolidKernel::Hex8Full, 0.9);
    let plain = free(&mesh, SolidKernel::Hex8Full, 0.0)
        .stable_step(&Leapfrog)
        .unwrap()
        .step;
    let options = RunOptions::steps(3).with_step(StepChoice::Fixed(plain));
    let refused = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap_err();
    assert!(
        matches!(refused, RunError::UnstableStep { .. }),
        "{refused}"
    );
}
