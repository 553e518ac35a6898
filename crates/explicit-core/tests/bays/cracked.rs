//! Bays some of whose elements lose their stiffness, anywhere along y: what is left moves as any other body does.

use powerhouse_elements::{AnyLaw, SolidKernel};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{BlockOptions, DelayedPairs, EnergyCheck, RunOptions, StepChoice, Vec3};

use super::free::shake;
use super::{bent, brittle, pairs, rock, yielding};
use crate::slices::{growth, noise};
use crate::support::energy_of;

/// What some elements are made of.
#[derive(Clone, Copy, Debug)]
enum Weak {
    /// Breaks from a strain (1) on.
    Brittle(f64),
    Yielding,
}

/// A free bay in which about a share of the elements is weak, whose P waves have a ratio to the speed of the motion along y.
fn model(weak: Weak, share: f64, ratio: f64) -> Model {
    let mesh = bent(Vec3::new(2.0, 1.0, 1.5), [4, 3, 3], 0.1, 5);
    let all = 0..mesh.element_count() as u32;
    let is_weak = |element: &u32| noise(1000 + u64::from(*element)) < 2.0 * share - 1.0;
    let (inside, outside): (Vec<u32>, Vec<u32>) = all.partition(is_weak);
    let law: AnyLaw = match weak {
        Weak::Brittle(strain) => brittle(strain),
        Weak::Yielding => yielding(),
    };
    let factory = |label: &str, law: AnyLaw| {
        SolidKernel::Hex8Full.factory(label, law, BlockOptions::default())
    };
    Model::builder(&mesh)
        .elements(outside, factory("rock", LinearElastic::new(rock()).into()))
        .elements(inside, factory("weak", law))
        .delayed(DelayedPairs {
            pairs: pairs(&mesh),
            slowness: ratio / rock().p_speed(),
            ..DelayedPairs::default()
        })
        .build()
        .unwrap()
}

/// A random motion breaks many elements; nothing grows in 3000 steps after that.
#[test]
fn nothing_grows_in_a_bay_with_cracks_anywhere() {
    for (share, ratio) in [(0.1, 0.3), (0.3, 0.6), (0.3, 0.7), (0.6, 0.7), (0.3, 0.85)] {
        for weak in [Weak::Brittle(1e-6), Weak::Yielding] {
            let mut model = model(weak, share, ratio);
            let step = model.stable_step(&Leapfrog).unwrap().step;
            shake(&mut model, 23);
            let growth = growth(&mut model, step, 3000);
            println!("{weak:?} {share} {ratio}: {growth:.2}");
            assert!(growth < 2.0, "{weak:?} {share} {ratio}: {growth}");
        }
    }
}

/// What cracks and flows takes the energy that the balance says.
#[test]
fn cracks_anywhere_keep_the_balance_of_energy() {
    for (weak, name) in [(Weak::Brittle(2e-4), "damage"), (Weak::Yielding, "plastic")] {
        for ratio in [0.4, 0.7] {
            let mut model = model(weak, 0.3, ratio);
            shake(&mut model, 31);
            let options = RunOptions::steps(2000)
                .with_step(StepChoice::Stable)
                .with_energy(EnergyCheck::every(10));
            let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
            let (residual, taken) = (report.energy_residual, energy_of(&report, name));
            println!("{weak:?} {ratio}: {residual:.1e}, {taken:.2e} J");
            assert!(taken > 1.0, "{weak:?} {ratio}: {taken:e}");
            assert!(residual < 1e-4, "{weak:?} {ratio}: {residual:e}");
        }
    }
}
