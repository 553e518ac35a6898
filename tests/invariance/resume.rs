//! A run that is stopped after any step and resumed in a newly built model goes on with the same bits.

use std::collections::hash_map::DefaultHasher;
use std::error::Error as StdError;
use std::hash::{Hash, Hasher};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use powerhouse::engine::{CheckpointSink, Progress, SavedRun};
use powerhouse::{EquilibratedBody, Error, FileScene, Registry, Results, RunHooks, Scene};
use powerhouse_model::{Bond, ContactState, ModelError, StateError};
use powerhouse_observe::{Snapshot, SnapshotSink};
use powerhouse_test_support::EVERYTHING;

/// Number of steps of a run.
const STEPS: u64 = 200;

/// Receiver of snapshots with a state of its own: the sum of all displacements that it has seen.
#[derive(Default)]
struct Sums(f64);

impl SnapshotSink for Sums {
    fn take(&mut self, snapshot: &Snapshot) -> Result<(), Box<dyn StdError + Send + Sync>> {
        self.0 += snapshot.displacement.iter().map(|u| u.norm()).sum::<f64>();
        Ok(())
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        Ok(self.0.to_le_bytes().into())
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        let bytes = saved.try_into().map_err(|_| StateError::Missing)?;
        self.0 = f64::from_le_bytes(bytes);
        Ok(())
    }
}

/// What a receiver of states does with them.
#[derive(Debug)]
enum Takes {
    /// It keeps the hash of every one, by section, and the first one.
    All,
    /// It keeps the first one and ends the run.
    First,
}

#[derive(Debug)]
struct Taken {
    how: Takes,
    /// Steps from one state to the next, and those seen so far.
    every: u64,
    seen: AtomicU64,
    states: Mutex<(Vec<Hashes>, Option<SavedRun>)>,
}

/// Hash of each section of a state, with its name.
type Hashes = Vec<(String, u64)>;

fn hashes(saved: &SavedRun) -> Hashes {
    let sections = saved.sections.iter().map(|section| {
        let mut hasher = DefaultHasher::new();
        section.bytes.hash(&mut hasher);
        (section.name.clone(), hasher.finish())
    });
    let run = (saved.done, saved.time.to_bits(), saved.step.to_bits());
    let mut hasher = DefaultHasher::new();
    run.hash(&mut hasher);
    sections.chain([("head".into(), hasher.finish())]).collect()
}

impl Taken {
    fn new(how: Takes, every: u64) -> Arc<Self> {
        Arc::new(Self {
            how,
            every,
            seen: AtomicU64::new(0),
            states: Mutex::default(),
        })
    }
    fn first(&self) -> SavedRun {
        self.states.lock().unwrap().1.clone().unwrap()
    }
}

impl CheckpointSink for Taken {
    fn is_due(&self, _progress: &Progress) -> bool {
        (self.seen.fetch_add(1, Ordering::Relaxed) + 1).is_multiple_of(self.every)
    }
    fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
        let mut states = self.states.lock().unwrap();
        states.0.push(hashes(&saved));
        states.1.get_or_insert(saved);
        match self.how {
            Takes::All => Ok(()),
            Takes::First => Err(ModelError::refused("test", "stopped")),
        }
    }
}

/// A scene in a precision, of [`STEPS`] steps, with the body at the end of its stages.
struct Case {
    text: String,
    duration: f64,
    body: Option<EquilibratedBody>,
}

impl Case {
    fn new(precision: &str) -> Self {
        let mut case = Self {
            text: format!("precision = \"{precision}\"\n{EVERYTHING}"),
            duration: 1.0,
            body: None,
        };
        let mut simulation = case.scene(2).prepare().unwrap();
        case.duration = (STEPS as f64 - 1.5) * simulation.step().unwrap();
        case.body = simulation.equilibrate(None, None).unwrap();
        case
    }

    fn scene(&self, threads: usize) -> Scene {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/scenes/everything.toml");
        let scene =
            FileScene::from_toml(&self.text, file, &Registry::default()).map(FileScene::into_scene);
        let scene = scene.unwrap().with_duration(self.duration);
        scene.with_threads(threads).allow_magnitudes()
    }

    /// Runs on some threads with a receiver of states, from a saved one if there is one.
    fn run(
        &self,
        threads: usize,
        sink: Option<Arc<Taken>>,
        saved: Option<SavedRun>,
    ) -> Result<Results, Error> {
        let mut hooks = RunHooks::default().with_snapshots(Box::new(Sums::default()));
        hooks.equilibrated_body = self.body.clone();
        hooks.resume = saved.map(Arc::new);
        hooks.checkpoints = sink.map(|sink| sink as Arc<dyn CheckpointSink>);
        self.scene(threads).prepare().unwrap().run(hooks)
    }
}

/// All that a run recorded, but for wall times, as text with every digit.
fn recorded(results: &Results) -> String {
    let Results {
        tables,
        lists,
        envelope,
        state,
        joints,
        joint_outcomes,
        bolts,
        snapshots,
        run,
        ..
    } = results;
    format!(
        "{tables:?}\n{lists:?}\n{envelope:?}\n{state:?}\n{joints:?}\n{joint_outcomes:?}\n{bolts:?}\n{snapshots}\n{run:?}"
    )
}

/// A run with everything in it, stopped every so many steps and resumed in a newly built model with another number of
/// threads, has the states of the run without a stop after the same steps, section by section to the bit, and the same
/// results at the end.
fn check(precision: &str, every: u64) {
    let case = Case::new(precision);
    let all = Taken::new(Takes::All, 1);
    let whole = case.run(2, Some(all.clone()), None).unwrap();
    assert_eq!(whole.run.steps, STEPS);
    everything_happened(&whole);
    let expected = all.states.lock().unwrap().0.clone();
    assert_eq!(expected.len() as u64, STEPS - 1);
    let mut saved = all.first();
    let stops = expected.iter().enumerate().skip(every as usize);
    for (step, expected) in stops.step_by(every as usize) {
        let sink = Taken::new(Takes::First, every);
        let ended = case.run(
            1 + step / every as usize % 3,
            Some(sink.clone()),
            Some(saved),
        );
        assert!(matches!(ended, Err(Error::Failed { .. })), "{ended:?}");
        saved = sink.first();
        for (found, expected) in hashes(&saved).iter().zip(expected) {
            assert_eq!(found, expected, "{precision}: after step {step}");
        }
    }
    let resumed = case.run(3, None, Some(saved)).unwrap();
    assert_eq!(recorded(&resumed), recorded(&whole), "{precision}");
}

/// Rock has yielded, concrete is damaged, the joint has slid and opened, bolts have yielded, damping has dissipated.
fn everything_happened(results: &Results) {
    let state = results.state.as_ref().unwrap();
    for name in ["plastic", "damage"] {
        let mut peaks = state.peaks.iter();
        let some = |values: &[f64]| values.iter().any(|value| *value > 0.0);
        let reached =
            peaks.any(|(variable, field)| variable.name.contains(name) && some(&field.values));
        assert!(reached, "nothing {name}");
    }
    let records = &results.joints[0].records;
    assert!(
        records.iter().any(|record| record.friction > 0.0),
        "nothing slid"
    );
    assert!(
        records
            .iter()
            .any(|record| record.state.bond == Bond::Broken)
    );
    assert!(
        records
            .iter()
            .any(|record| record.state.contact != ContactState::Stick)
    );
    for column in ["plastic", "damage", "relaxation", "dashpots", "friction"] {
        let column = results.energies().column(column).unwrap();
        assert!(column.values.last().unwrap().abs() > 0.0, "{}", column.name);
    }
    assert!(results.snapshots > 2);
}

#[test]
fn a_resumed_run_has_the_same_bits() {
    for precision in ["f64", "mixed", "f32"] {
        check(precision, 31);
    }
}

/// The same after each step: `cargo test --release --test shelves resume -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn a_run_resumed_after_each_step_has_the_same_bits() {
    for precision in ["f64", "mixed", "f32"] {
        check(precision, 1);
    }
}
