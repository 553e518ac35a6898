//! What observers are shown, and how runs end.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use crate::support::{Links, chain};
use powerhouse_elements::{NodalForce, SolidKernel};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_model::{
    BlockOptions, Cadence, ConstitutiveLaw, ElasticMedium, ElementKind, Ended, EnergyCheck, Fields,
    Flow, HistoryVariable, Lane, LawInput, Mesh, ModelError, Observer, ParameterError, RunError,
    RunOptions, StepChoice, StepView, Stress, Support, Vec3,
};

const YOUNG: f64 = 9.0e9;
const DENSITY: f64 = 2750.0;

/// A bar of 20 elements of 1 m, held at the left, pulled at the right.
fn bar() -> Model {
    let mesh = chain(20, 1.0);
    let links = Links::new("bar", ElementKind::Bar2, YOUNG, 1.0, DENSITY);
    let force = NodalForce::new(
        vec![20],
        Vec3::new(1e4, 0.0, 0.0),
        Box::new(|t: f64| t * 1e3),
    );
    Model::builder(&mesh)
        .elements("bar", links.boxed())
        .support(Support::fixed(vec![0]))
        .load(Box::new(force))
        .build()
        .unwrap()
}

/// What an observer saw: step number and a value.
type Seen = Arc<Mutex<Vec<(u64, f64)>>>;

/// Notes what a function reads from each step it is shown.
struct Notes {
    cadence: Cadence,
    fields: Fields,
    read: fn(&dyn StepView) -> f64,
    /// Stops the run, or fails it, at a step.
    stop_at: Option<u64>,
    fail_at: Option<u64>,
    seen: Seen,
    finished: Arc<AtomicU32>,
}

impl Notes {
    fn new(cadence: Cadence, read: fn(&dyn StepView) -> f64) -> Self {
        Self {
            cadence,
            fields: Fields::default(),
            read,
            stop_at: None,
            fail_at: None,
            seen: Seen::default(),
            finished: Arc::default(),
        }
    }
}

impl Observer for Notes {
    fn name(&self) -> &str {
        "notes"
    }
    fn fields(&self) -> Fields {
        self.fields
    }
    fn cadence(&self) -> Cadence {
        self.cadence
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let row = (view.number(), (self.read)(view));
        self.seen.lock().unwrap().push(row);
        if self.fail_at == Some(view.number()) {
            ParameterError::check("row", f64::NAN, 0.0, 1.0)?;
        }
        Ok(if self.stop_at == Some(view.number()) {
            Flow::Stop
        } else {
            Flow::Continue
        })
    }
    fn finish(&mut self) -> Result<(), ModelError> {
        self.finished.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }
}

fn numbers(seen: &Seen) -> Vec<u64> {
    seen.lock().unwrap().iter().map(|row| row.0).collect()
}

fn options(steps: u64) -> RunOptions {
    RunOptions::steps(steps).with_step(StepChoice::Fixed(1e-4))
}

/// Cadences are kept, the last step is shown whatever the cadence, and a run that goes on shows
/// every state once.
#[test]
fn cadences_and_the_last_step() {
    let mut model = bar();
    let every = Notes::new(Cadence::Steps(4), |view| view.time());
    let timed = Notes::new(Cadence::Seconds(2.5e-4), |view| view.time());
    let (seen, seen_timed) = (every.seen.clone(), timed.seen.clone());
    let mut observers: Vec<Box<dyn Observer>> = vec![Box::new(every), Box::new(timed)];
    run(
        &mut model,
        &Leapfrog,
        &options(10),
        &mut observers,
        &mut |_| {},
    )
    .unwrap();
    assert_eq!(numbers(&seen), [0, 4, 8, 9]);
    assert_eq!(numbers(&seen_timed), [0, 3, 5, 8, 9]);
    run(
        &mut model,
        &Leapfrog,
        &options(3),
        &mut observers,
        &mut |_| {},
    )
    .unwrap();
    assert_eq!(numbers(&seen), [0, 4, 8, 9, 12]);
}

/// A run of some seconds shows the first state at or past its end, and reports its progress.
#[test]
fn a_run_of_seconds_shows_its_end() {
    let mut model = bar();
    let notes = Notes::new(Cadence::Steps(1), |view| view.time());
    let seen = notes.seen.clone();
    let mut calls = Vec::new();
    let options = RunOptions::seconds(1.05e-3).with_step(StepChoice::Fixed(1e-4));
    let report = run(
        &mut model,
        &Leapfrog,
        &options,
        &mut [Box::new(notes)],
        &mut |p| {
            calls.push((p.done, p.planned));
        },
    );
    let report = report.unwrap();
    assert_eq!((report.steps, report.ended), (12, Ended::Completed));
    let last = seen.lock().unwrap().last().unwrap().1;
    assert!((last - 1.1e-3).abs() < 1e-12);
    assert_eq!(calls, (1..=12).map(|done| (done, 12)).collect::<Vec<_>>());
}

/// An observer that has seen enough ends the run at its step, which is then shown to all; each is
/// finished once.
#[test]
fn an_observer_ends_the_run() {
    let mut model = bar();
    let mut stops = Notes::new(Cadence::Steps(1), |view| view.time());
    stops.stop_at = Some(6);
    let rare = Notes::new(Cadence::Steps(100), |view| view.time());
    let (seen, finished) = (rare.seen.clone(), rare.finished.clone());
    let mut observers: Vec<Box<dyn Observer>> = vec![Box::new(rare), Box::new(stops)];
    let report = run(
        &mut model,
        &Leapfrog,
        &options(50),
        &mut observers,
        &mut |_| {},
    )
    .unwrap();
    assert_eq!(
        (report.steps, report.ended),
        (7, Ended::Observer("notes".into()))
    );
    assert_eq!(numbers(&seen), [0, 6]);
    assert_eq!(finished.load(Ordering::Relaxed), 1);
}

/// A flag raised from outside ends the run after one more step, shown to all; an observer that
/// fails ends it with its name, and the observers are finished all the same.
#[test]
fn a_run_is_stopped_from_outside_or_fails() {
    let stop = Arc::new(AtomicBool::new(false));
    let raise = stop.clone();
    let mut model = bar();
    let rare = Notes::new(Cadence::Steps(100), |view| view.time());
    let seen = rare.seen.clone();
    let with_stop = options(50).with_stop(stop);
    let report = run(
        &mut model,
        &Leapfrog,
        &with_stop,
        &mut [Box::new(rare)],
        &mut |p| {
            raise.store(p.done == 20, Ordering::Relaxed);
        },
    );
    let report = report.unwrap();
    assert_eq!((report.steps, report.ended), (21, Ended::Stopped));
    assert_eq!(numbers(&seen), [0, 20]);

    let mut fails = Notes::new(Cadence::Steps(1), |view| view.time());
    fails.fail_at = Some(3);
    let finished = fails.finished.clone();
    let failed = run(
        &mut bar(),
        &Leapfrog,
        &options(50),
        &mut [Box::new(fails)],
        &mut |_| {},
    );
    assert!(matches!(failed, Err(RunError::Observer { name, step: 3, .. }) if name == "notes"));
    assert_eq!(finished.load(Ordering::Relaxed), 1);
}

/// The view gives displacement, mean velocity and acceleration of one and the same time: they are
/// the central differences of the displacements, at plain, loaded and supported nodes.
#[test]
fn the_view_is_consistent_in_time() {
    type Read = fn(&dyn StepView) -> f64;
    let plain: [Read; 3] = [
        |view| view.displacement(19).x,
        |view| view.velocity(19).x,
        |view| view.acceleration(19).x,
    ];
    let loaded: [Read; 3] = [
        |view| view.displacement(20).x,
        |view| view.velocity(20).x,
        |view| view.acceleration(20).x,
    ];
    let supported: [Read; 3] = [
        |view| view.displacement(0).x,
        |view| view.velocity(0).x,
        |view| view.acceleration(0).x,
    ];
    for reads in [plain, loaded, supported] {
        let notes = reads.map(|read| Notes::new(Cadence::Steps(1), read));
        let [u, v, a] = [0, 1, 2].map(|i| notes[i].seen.clone());
        let mut observers: Vec<Box<dyn Observer>> = Vec::new();
        for note in notes {
            observers.push(Box::new(note));
        }
        run(
            &mut bar(),
            &Leapfrog,
            &options(40),
            &mut observers,
            &mut |_| {},
        )
        .unwrap();
        let values = |seen: &Seen| {
            seen.lock()
                .unwrap()
                .iter()
                .map(|row| row.1)
                .collect::<Vec<_>>()
        };
        let (u, v, a) = (values(&u), values(&v), values(&a));
        let dt = 1e-4;
        let scale = u.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for i in 1..u.len() - 1 {
            assert!((v[i] - (u[i + 1] - u[i - 1]) / (2.0 * dt)).abs() <= 1e-11 * scale / dt);
            assert!(
                (a[i] - (u[i + 1] - 2.0 * u[i] + u[i - 1]) / (dt * dt)).abs()
                    <= 1e-10 * scale / dt / dt
            );
        }
    }
}

/// Stresses are those of the displacement shown, energies those of the ledger, which is kept
/// because an observer wants it.
#[test]
fn stresses_and_energies_are_shown() {
    let mut stress = Notes::new(Cadence::Steps(1), |view| {
        let strain = (view.displacement(12).x - view.displacement(11).x) / 1.0;
        view.stress(11).0[0] - YOUNG * strain
    });
    stress.fields.stress = true;
    let mut energy = Notes::new(Cadence::Steps(5), |view| {
        let of = |name| view.energies().iter().find(|(n, _)| *n == name).unwrap().1;
        (of("kinetic") + of("time step") + of("elastic") - of("loads")) / of("elastic").max(1e-300)
    });
    energy.fields.energy = true;
    let (stresses, balances) = (stress.seen.clone(), energy.seen.clone());
    let mut observers: Vec<Box<dyn Observer>> = vec![Box::new(stress), Box::new(energy)];
    let report = run(
        &mut bar(),
        &Leapfrog,
        &options(60),
        &mut observers,
        &mut |_| {},
    )
    .unwrap();
    assert!(
        stresses
            .lock()
            .unwrap()
            .iter()
            .all(|row| row.1.abs() < 1e-6)
    );
    let balances = balances.lock().unwrap();
    assert!(balances.len() == 13 && balances.iter().all(|row| row.1.abs() < 1e-12));
    assert!(report.energy_residual < 1e-13);
    assert!(
        report
            .energies
            .iter()
            .any(|(name, joule)| *name == "loads" && *joule > 0.0)
    );
}

/// A softening law that counts its evaluations.
#[derive(Clone)]
struct Counted(ElasticMedium, Arc<AtomicUsize>);

impl ConstitutiveLaw for Counted {
    fn name(&self) -> &str {
        "counted"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &'static [HistoryVariable] {
        const { &[HistoryVariable::amount("largest_strain", "1")] }
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
        self.1.fetch_add(1, Ordering::Relaxed);
        let any = input.strain.0[0];
        new[0] = input.history[0].max(input.strain.0[2].abs());
        let (lambda, shear) = (any.constant(self.0.lambda()), any.constant(self.0.shear()));
        let kept = any.constant(1e-4) / (new[0] + any.constant(1e-4));
        Stress::elastic(lambda, shear, &input.strain) * kept
    }
}

/// Observers of stresses and the energy balance, in every step, some or none, change neither the number of evaluations of a law
/// nor the motion; stresses that are seen are those of the forces.
#[test]
fn what_is_shown_costs_no_evaluation_of_the_law() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 2.0, 3.0), [2, 2, 3], "rock");
    let mesh = mesh.unwrap();
    let medium = ElasticMedium::new(YOUNG, 0.25, DENSITY).unwrap();
    let at = |height: f64| -> Vec<u32> {
        let nodes = (0..).zip(mesh.positions());
        let here = nodes.filter(|(_, x)| x.z == height);
        here.map(|(node, _)| node).collect()
    };
    let go = |every: Option<u64>| {
        let evaluations = Arc::new(AtomicUsize::new(0));
        let law = Counted(medium, evaluations.clone());
        let load = NodalForce::new(
            at(3.0),
            Vec3::new(0.0, 2e4, 3e5),
            Box::new(|t: f64| t * 1e3),
        );
        let part = SolidKernel::Hex8Full.factory("rock", law, BlockOptions::default());
        let mut model = Model::builder(&mesh)
            .elements("rock", part)
            .support(Support::fixed(at(0.0)))
            .load(Box::new(load))
            .build()
            .unwrap();
        // The balance of a run is read in its last step in any case.
        let options = RunOptions::steps(40)
            .with_step(StepChoice::Unchecked(5e-5))
            .with_energy(EnergyCheck::every(every.unwrap_or(100)));
        let mut observers: Vec<Box<dyn Observer>> = Vec::new();
        let mut seen = Seen::default();
        if let Some(every) = every {
            for _ in 0..2 {
                let mut notes = Notes::new(Cadence::Steps(every), |view| view.stress(0).0[2]);
                notes.fields = Fields::default().with_stress(true);
                seen = notes.seen.clone();
                observers.push(Box::new(notes));
            }
        }
        evaluations.store(0, Ordering::Relaxed);
        run(&mut model, &Leapfrog, &options, &mut observers, &mut |_| {}).unwrap();
        let motion: Vec<Vec3> = (0..mesh.node_count() as u32)
            .map(|node| model.displacement(node))
            .collect();
        let seen = seen.lock().unwrap().clone();
        (evaluations.load(Ordering::Relaxed), motion, seen)
    };
    let (none, motion, _) = go(None);
    assert!(none.is_multiple_of(40), "{none} evaluations");
    let (always, of_always, seen) = go(Some(1));
    let (some, of_some, _) = go(Some(7));
    assert_eq!([always, some], [none; 2]);
    assert_eq!([&of_always, &of_some], [&motion; 2]);
    assert_eq!(seen.len(), 40);
    assert!(seen[39].1 > seen[10].1 && seen[10].1 > 0.0, "{seen:?}");
}
