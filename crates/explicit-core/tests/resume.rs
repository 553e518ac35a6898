//! Parts of a program's own in a resumed run, with and without a memory, and states that are refused.

use std::sync::{Arc, Mutex};

use crate::support::{Links, StopAfter, chain};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_model::{
    Cadence, Constraint, ConstraintWork, ElementKind, EnergyCheck, Fields, Flow, ModelError,
    NodalLoad, Observer, PredictedMotion, RunError, RunOptions, SavedRun, StateError, StepChoice,
    StepView, Support, Vec3,
};

/// A pull that grows whenever it is evaluated.
struct Growing {
    calls: u32,
}
impl NodalLoad for Growing {
    fn name(&self) -> &str {
        "growing"
    }
    fn nodes(&self) -> &[u32] {
        &[20]
    }
    fn add_forces(&mut self, _time: f64, forces: &mut [Vec3]) {
        self.calls += 1;
        forces[0].x += 1e3 * f64::from(self.calls);
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        Ok(self.calls.to_le_bytes().into())
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        let bytes = saved.try_into().map_err(|_| StateError::Missing)?;
        self.calls = u32::from_le_bytes(bytes);
        Ok(())
    }
}

/// Brakes a node, without a memory.
struct Brake;
impl Constraint for Brake {
    fn name(&self) -> &str {
        "brake"
    }
    fn nodes(&self) -> &[u32] {
        &[10]
    }
    fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        motion.velocity[0] *= 0.9;
        Ok(ConstraintWork::default())
    }
}

/// Sums what it observes, with a memory or without.
struct Sum {
    sum: f64,
    keeps: bool,
    shown: Arc<Mutex<f64>>,
}
impl Observer for Sum {
    fn name(&self) -> &str {
        "sum"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(3)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        self.sum += view.displacement(15).x;
        *self.shown.lock().unwrap() = self.sum;
        Ok(Flow::Continue)
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        if self.keeps {
            Ok(self.sum.to_le_bytes().into())
        } else {
            Ok(Vec::new())
        }
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        if !self.keeps {
            return StateError::expect_none(saved);
        }
        self.sum = f64::from_le_bytes(saved.try_into().map_err(|_| StateError::Missing)?);
        Ok(())
    }
}

fn bar(block_size: usize) -> Model {
    let mesh = chain(20, 1.0);
    let links = Links::new("bar", ElementKind::Bar2, 9e9, 1.0, 2750.0).damped(3.0, 0.0);
    Model::builder(&mesh)
        .elements("bar", links.boxed())
        .support(Support::fixed(vec![0]))
        .load(Box::new(Growing { calls: 0 }))
        .constraint(Box::new(Brake))
        .block_size(block_size)
        .build()
        .unwrap()
}

fn options() -> RunOptions {
    RunOptions::steps(40)
        .with_step(StepChoice::Fixed(1e-4))
        .with_energy(EnergyCheck::every(5).with_limit(1e9))
}

/// Runs a bar; returns the outcome, the bits of the motion at its end, and the sums of its observers.
fn go(mut model: Model, keeps: &[bool], options: &RunOptions) -> (Result<f64, RunError>, Vec<u64>) {
    let shown: Vec<Arc<Mutex<f64>>> = keeps.iter().map(|_| Arc::default()).collect();
    let mut observers: Vec<Box<dyn Observer>> = Vec::new();
    for (keeps, shown) in keeps.iter().zip(&shown) {
        let shown = shown.clone();
        let keeps = *keeps;
        observers.push(Box::new(Sum {
            sum: 0.0,
            keeps,
            shown,
        }));
    }
    let outcome = run(&mut model, &Leapfrog, options, &mut observers, &mut |_| {});
    let mut bits: Vec<u64> = (0..21)
        .flat_map(|node| [model.displacement(node).x, model.velocity(node).x])
        .map(f64::to_bits)
        .collect();
    bits.extend(shown.iter().map(|shown| shown.lock().unwrap().to_bits()));
    (outcome.map(|report| report.energy_residual), bits)
}

fn saved_after(step: u64, keeps: &[bool]) -> SavedRun {
    let sink = StopAfter::new(step);
    let (ended, _) = go(bar(5), keeps, &options().with_checkpoints(sink.clone()));
    assert!(matches!(ended, Err(RunError::Observer { .. })), "{ended:?}");
    sink.saved()
}

/// A load and an observer with a memory go on where they were, a constraint and blocks without one need nothing; an
/// observer without a memory sees the rest of the run alone.
#[test]
fn parts_of_a_programs_own_take_part() {
    let (whole, expected) = go(bar(5), &[true, false], &options());
    for step in [1, 2, 17, 39] {
        let saved = saved_after(step, &[true, false]);
        assert_eq!(saved.done, step);
        let resumed = options().with_resume(Arc::new(saved));
        let (residual, found) = go(bar(5), &[true, false], &resumed);
        let last = expected.len() - 1;
        assert_eq!(found[..last], expected[..last], "after step {step}");
        if step > 3 {
            assert_ne!(found[last], expected[last], "after step {step}");
        }
        assert_eq!(
            residual.unwrap().to_bits(),
            whole.as_ref().unwrap().to_bits()
        );
    }
}

/// States of a run with other blocks, another step, other observers or another energy balance are refused by name, and so
/// is one in which a part is missing or damaged.
#[test]
fn states_of_another_run_are_refused() {
    let saved = saved_after(12, &[true]);
    let refused = |model: Model, keeps: &[bool], options: RunOptions, saved: SavedRun| {
        let (outcome, _) = go(model, keeps, &options.with_resume(Arc::new(saved)));
        outcome.unwrap_err().to_string()
    };
    let same = || (bar(5), [true], options());
    let (model, keeps, plain) = same();
    assert!(
        go(model, &keeps, &plain.with_resume(Arc::new(saved.clone())))
            .0
            .is_ok()
    );

    let text = refused(bar(7), &[true], options(), saved.clone());
    assert!(text.contains("fingerprint of the blocks"), "{text}");
    let other_step = options().with_step(StepChoice::Fixed(0.9e-4));
    let text = refused(bar(5), &[true], other_step, saved.clone());
    assert!(text.contains("time step"), "{text}");
    for keeps in [&[false][..], &[true, true], &[]] {
        let text = refused(bar(5), keeps, options(), saved.clone());
        assert!(text.contains("observer"), "{text}");
    }
    let mut unbalanced = options();
    unbalanced.energy = None;
    let text = refused(bar(5), &[true], unbalanced, saved.clone());
    assert!(text.contains("energy balance"), "{text}");
    for index in 0..saved.sections.len() {
        let name = saved.sections[index].name.clone();
        let mut without = saved.clone();
        without.sections.remove(index);
        let text = refused(bar(5), &[true], options(), without);
        assert!(
            text.contains(&name) || name.contains("block"),
            "{name}: {text}"
        );
        let mut cut = saved.clone();
        if cut.sections[index].bytes.pop().is_some() {
            let text = refused(bar(5), &[true], options(), cut);
            assert!(text.contains(&name), "{name}: {text}");
        }
    }
}
