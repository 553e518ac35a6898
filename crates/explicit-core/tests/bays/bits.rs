//! Bits of bays, and what they refuse: threads, resumed runs, equilibrium under weight.

use std::sync::Arc;

use powerhouse_explicit_core::{BuildModel, Leapfrog, run};
use powerhouse_model::{
    Constraint, ConstraintWork, DelayedPairs, EnergyCheck, EngineError, Mesh, ModelError,
    PeriodicPairs, PredictedMotion, RunError, RunOptions, SavedState, StateError, StaticOptions,
    StepChoice, Support, TimeIntegrator, Vec3,
};

use super::laws::{Core, model, spec};
use super::{pairs, rock};
use crate::support::{KeepAfter, bits_of_motion};

const ANGLES: [f64; 2] = [25.0, 45.0];

fn small() -> Mesh {
    let (low, high) = (Vec3::new(-30.0, -7.5, -50.0), Vec3::new(30.0, 7.5, 0.0));
    Mesh::box_of_hexes(low, high, [12, 3, 10], "rock").unwrap()
}

/// Results do not depend on the number of threads.
#[test]
fn threads_change_no_bit_of_a_bay() {
    let mesh = small();
    for core in [Core::Rock, Core::Yielding] {
        let of = |threads: usize| {
            let spec = spec(&mesh, ANGLES, core).threads(threads).block_size(50);
            let mut model = spec.build().unwrap();
            let options = RunOptions::steps(200).with_energy(EnergyCheck::every(20));
            let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
            (bits_of_motion(&model), report.energies)
        };
        assert!(of(1) == of(3));
    }
}

/// A resumed run ends with the same bits, energies included, with linear elements alone and while a core yields.
#[test]
fn a_resumed_bay_has_the_same_bits() {
    let mesh = small();
    for core in [Core::Rock, Core::Yielding] {
        let options = || {
            let options = RunOptions::steps(420).with_energy(EnergyCheck::every(10));
            options.with_step(StepChoice::Fixed(7e-4))
        };
        let sink = KeepAfter::new(333);
        let mut whole = model(&mesh, ANGLES, core);
        let kept = options().with_checkpoints(sink.clone());
        let first = run(&mut whole, &Leapfrog, &kept, &mut [], &mut |_| {}).unwrap();
        let saved = sink.saved();
        let mut rest = model(&mesh, ANGLES, core);
        let resumed = options().with_resume(Arc::new(saved));
        let second = run(&mut rest, &Leapfrog, &resumed, &mut [], &mut |_| {}).unwrap();
        let plastic = first.energies.iter().find(|(name, _)| *name == "plastic");
        assert_eq!(plastic.unwrap().1 > 0.0, core == Core::Yielding);
        assert!(bits_of_motion(&whole) == bits_of_motion(&rest), "{core:?}");
        assert_eq!(first.energies, second.energies);
    }
}

/// A bay that was brought into equilibrium under its weight, with an excavated core, stays still when it may move.
#[test]
fn a_bay_in_equilibrium_stays_still() {
    let mesh = small();
    let core: Vec<u32> = (0..mesh.element_count() as u32)
        .filter(|element| {
            let x = mesh.centroid(*element);
            x.x.abs() < 10.0 && (-40.0..-20.0).contains(&x.z) && x.y > -2.5
        })
        .collect();
    let build = |moves: bool| {
        let bottom = mesh.nodes_of_facets(mesh.facet_set("bottom").unwrap());
        let mut spec = spec(&mesh, ANGLES, Core::Rock)
            .gravity(Vec3::new(0.0, 0.0, -9.81), Box::new(|_: f64| 1.0))
            .support(Support::fixed(bottom));
        spec.boundaries.clear();
        if !moves {
            spec.delayed = None;
            let pairs = pairs(&mesh);
            spec = spec.periodic(PeriodicPairs { pairs });
        }
        spec
    };
    let mut resting = build(false).build().unwrap();
    let options = StaticOptions {
        tolerance: 1e-12,
        ..StaticOptions::default()
    };
    resting.equilibrate(&options, &mut |_| {}).unwrap();
    let mut state = resting.state();
    state.remove(&core);
    let mut dug = build(false).start(state).build().unwrap();
    dug.equilibrate(&options, &mut |_| {}).unwrap();
    let state = dug.state();
    let settled = (state.displacement.iter().map(|u| u.norm())).fold(0.0, f64::max);
    let mut model = build(true).start(state.clone()).build().unwrap();
    for _ in 0..300 {
        Leapfrog.step(&mut model, 5e-4).unwrap();
    }
    let moved = (0..mesh.node_count() as u32)
        .map(|node| (model.displacement(node) - state.displacement[node as usize]).norm());
    let moved = moved.fold(0.0, f64::max);
    assert!(
        settled > 1e-5 && moved < 1e-8 * settled,
        "{moved:e} of {settled:e}"
    );
}

/// A constraint with a state that is not one of joints.
struct Memory;

impl Constraint for Memory {
    fn name(&self) -> &str {
        "memory"
    }
    fn nodes(&self) -> &[u32] {
        &[]
    }
    fn correct(&mut self, _motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        Ok(ConstraintWork::default())
    }
    fn saved(&self) -> Option<&dyn SavedState> {
        Some(self)
    }
}

impl SavedState for Memory {
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        Ok(Vec::new())
    }
    fn restore_state(&mut self, _saved: &[u8]) -> Result<(), StateError> {
        Ok(())
    }
}

/// Pairs that leave a node at an end without a partner, or are not those of the ends, and speeds that are too high are refused.
#[test]
fn pairs_and_speeds_that_make_no_bay_are_refused() {
    let mesh = small();
    let refused = |change: &dyn Fn(&mut DelayedPairs)| {
        let mut spec = spec(&mesh, ANGLES, Core::Yielding);
        if let Some(delayed) = &mut spec.delayed {
            change(delayed);
        }
        let error = spec.build().err().unwrap();
        match error {
            ModelError::Refused { source, .. } => *source.downcast::<EngineError>().unwrap(),
            other => panic!("{other}"),
        }
    };
    let without = refused(&|delayed| {
        delayed.pairs.pop();
    });
    assert!(matches!(without, EngineError::DelayedNode { count: 0, .. }));
    let twice = refused(&|delayed| delayed.pairs.push(delayed.pairs[0]));
    assert!(matches!(twice, EngineError::DelayedNode { count: 2, .. }));
    let crossed = refused(&|delayed| {
        let (a, b) = (delayed.pairs[0].1, delayed.pairs[1].1);
        (delayed.pairs[0].1, delayed.pairs[1].1) = (b, a);
    });
    assert!(matches!(crossed, EngineError::DelayedPair { .. }));
    let mut with_memory = spec(&mesh, ANGLES, Core::Rock);
    with_memory.constraints.push(Box::new(Memory));
    let refusal = with_memory.build().err().unwrap().to_string();
    assert!(refusal.contains("'memory'"), "{refusal}");
    // Elements that yield take 0.9 of the slowness of P waves, others 0.97.
    let fast = refused(&|delayed| delayed.slowness = 0.93 / rock().p_speed());
    assert!(matches!(fast, EngineError::DelayedMass { .. }), "{fast}");
    let mut elastic = spec(&mesh, ANGLES, Core::Rock);
    if let Some(delayed) = &mut elastic.delayed {
        delayed.slowness = 0.95 / rock().p_speed();
    }
    assert!(elastic.build().is_ok());
}
