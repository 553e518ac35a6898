//! Joints between unequal bodies in bays without waves: they neither feed a motion nor break the balance of energy.

use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{
    BlockOptions, DelayedPairs, ElasticMedium, EnergyCheck, PeriodicPairs, RunOptions, StepChoice,
    Vec3,
};

use super::free::shake;
use super::{bent, pairs, rock};
use crate::slices::growth;
use crate::support::energy_of;

/// Where the second body is.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// The upper half.
    Layer,
    /// All around the axis, from end to end.
    Core,
}

/// A bay of rock with a body of another one in it, whose P waves have a share of the speed of the motion along y (1).
fn model(shape: Shape, (ratio, stiff): (f64, f64), law: BondedCoulomb) -> Model {
    let whole = bent(Vec3::new(2.0, 1.0, 1.5), [4, 2, 4], 0.1, 7);
    let is_inside = |element: &u32| {
        let x = whole.centroid(*element) + Vec3::new(0.0, 0.0, 1.5);
        match shape {
            Shape::Layer => x.z > 0.0,
            Shape::Core => x.x.abs() < 1.0 && x.z.abs() < 1.1,
        }
    };
    let all = 0..whole.element_count() as u32;
    let (inside, outside): (Vec<u32>, Vec<u32>) = all.partition(is_inside);
    let split = whole.split_between(&outside, &inside).unwrap();
    let mesh = split.mesh;
    let options = SurfaceOptions::within(1e-6).unwrap();
    let surface = JointSurface::between(&mesh, &split.first, &split.second, &options).unwrap();
    let ends = PeriodicPairs {
        pairs: pairs(&mesh),
    };
    let leads = PeriodicPairs::leads([&ends]);
    let joined = surface.united(|node: u32| leads.get(&node).copied().unwrap_or(node));
    let other = ElasticMedium {
        young: rock().young * stiff,
        ..rock()
    };
    let fastest = rock().p_speed() * stiff.sqrt().max(1.0);
    let factory = |label: &str, medium| {
        SolidKernel::Hex8Full.factory(label, LinearElastic::new(medium), BlockOptions::default())
    };
    Model::builder(&mesh)
        .elements(outside, factory("rock", rock()))
        .elements(inside, factory("other", other))
        .constraint(Box::new(Joint::new("joint", joined.pairs, law).unwrap()))
        .delayed(DelayedPairs {
            pairs: ends.pairs,
            slowness: ratio / fastest,
            ..DelayedPairs::default()
        })
        .build()
        .unwrap()
}

/// A law of strengths (Pa) with friction.
fn law(strength: f64) -> BondedCoulomb {
    BondedCoulomb::new(BondedCoulombParameters {
        static_friction: 0.6,
        dynamic_friction: 0.5,
        cohesion: strength,
        tensile_strength: strength,
        cohesion_loss: true,
    })
    .unwrap()
}

const SHAPES: [Shape; 2] = [Shape::Layer, Shape::Core];

/// A random motion does not grow in 3000 steps across a bond, at the largest step and whatever the bodies and the speed of the motion along y are.
#[test]
fn a_bond_between_unequal_bodies_feeds_no_motion() {
    for shape in SHAPES {
        for case in [(0.3, 0.1), (0.7, 0.3), (0.7, 3.0), (0.9, 0.3)] {
            let mut model = model(shape, case, law(1e30));
            let step = model.stable_step(&Leapfrog).unwrap().step;
            shake(&mut model, 17);
            let growth = growth(&mut model, step, 3000);
            println!("{shape:?} {case:?}: {growth:.2}");
            assert!(growth < 2.0, "{shape:?} {case:?}: {growth}");
        }
    }
}

/// A bond keeps the energy of a random motion, and one that breaks, opens, closes and slides accounts for what it takes.
#[test]
fn joints_of_bays_keep_the_balance_of_energy() {
    for shape in SHAPES {
        for (strength, limit) in [(1e30, 1e-4), (3e6, 3e-3)] {
            let mut model = model(shape, (0.7, 0.3), law(strength));
            shake(&mut model, 5);
            let options = RunOptions::steps(2000)
                .with_step(StepChoice::Stable)
                .with_energy(EnergyCheck::every(5));
            let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
            let energy = |name: &str| energy_of(&report, name);
            let (residual, slid) = (report.energy_residual, energy("friction"));
            println!(
                "{shape:?} {strength:.0e}: {residual:.1e}, kinetic {:.2e}, friction {slid:.2e}, impact {:.2e}, not solved {:?}",
                energy("kinetic"),
                energy("impact"),
                report.unsolved
            );
            let unsolved = report.unsolved.map_or(0, |unsolved| unsolved.steps);
            assert!(unsolved <= if strength < 1e20 { 4 } else { 0 });
            assert!(residual < limit, "{shape:?} {strength:e}: {residual:e}");
            assert_eq!(slid > 0.0, strength < 1e20, "{slid:e}");
        }
    }
}
