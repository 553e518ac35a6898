//! Stable step and energy of bays in free motion.

use std::collections::BTreeMap;

use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{Leapfrog, Model, run};
use powerhouse_model::{EnergyCheck, RunOptions, Vec3};

use super::{bent, pairs};
use crate::slices::{free, growth, noise};

/// Gives all places a random velocity (m/s).
pub(super) fn shake(model: &mut Model, seed: u64) {
    let mesh = model.mesh();
    let of = |index: u64| Vec3::from_fn(|c, _| noise(seed + 3 * index + c as u64));
    let mut velocity: Vec<Vec3> = (0..mesh.node_count() as u64).map(of).collect();
    for (a, b) in pairs(mesh) {
        velocity[b as usize] = velocity[a as usize];
    }
    let mut of_place = BTreeMap::new();
    for (x, velocity) in mesh.positions().iter().zip(&mut velocity) {
        let place = [x.x, x.y, x.z].map(|x| (x * 1e6).round() as i64);
        *velocity = *of_place.entry(place).or_insert(*velocity);
    }
    let still = vec![Vec3::zeros(); velocity.len()];
    model.set_initial(&still, &velocity).unwrap();
}

/// Nothing grows in 3000 steps at the step that is reported, and motion grows without bound 7 % above it.
#[test]
fn the_stable_step_is_that_of_the_plain_leapfrog_with_less_inertia() {
    for (seed, ratio) in [(1, 0.2), (2, 0.4), (3, 0.6), (4, 0.8), (5, 0.9), (6, 0.95)] {
        for kernel in [SolidKernel::Hex8Full, SolidKernel::ONE_POINT] {
            let mesh = bent(Vec3::new(2.0, 1.0, 1.5), [4, 2, 3], 0.15, seed);
            let mut model = free(&mesh, kernel, ratio);
            let mut plain = free(&mesh, kernel, 0.0);
            let step = model.stable_step(&Leapfrog).unwrap().step;
            let of_plain = plain.stable_step(&Leapfrog).unwrap().step;
            shake(&mut model, 100 * seed);
            let stable = growth(&mut model, step, 3000);
            let mut model = free(&mesh, kernel, ratio);
            shake(&mut model, 100 * seed);
            let beyond = growth(&mut model, step / 0.98 * 1.05, 1000);
            let case = format!("{kernel:?} {ratio}: {stable} {beyond}");
            assert!(stable < 2.0 && beyond > 1e3, "{case}");
            // The inertia that is left bounds the step from below.
            let (bound, share) = ((1.0 - ratio * ratio).sqrt(), step / of_plain);
            assert!(
                share > 0.97 * bound && share < 1.05,
                "{case} {share} {bound}"
            );
        }
    }
}

/// Energy with that of the delay stays what it is.
#[test]
fn a_free_bay_keeps_its_energy() {
    let mesh = bent(Vec3::new(2.0, 1.0, 1.5), [4, 2, 3], 0.15, 3);
    for ratio in [0.3, 0.8] {
        let mut model = free(&mesh, SolidKernel::Hex8Full, ratio);
        shake(&mut model, 11);
        let options = RunOptions::steps(1000).with_energy(EnergyCheck::every(10));
        let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        let residual = report.energy_residual;
        assert!(residual < 1e-7, "{ratio}: {residual:e}");
        let delay = report.energies.iter().find(|(name, _)| *name == "delay");
        assert!(delay.is_some_and(|(_, energy)| *energy < 0.0), "{delay:?}");
    }
}
