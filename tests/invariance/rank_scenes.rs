//! Independence of the result files of whole scenes from the number of ranks that share their blocks.

use std::collections::BTreeMap;
use std::error::Error as StdError;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use powerhouse::engine::{
    CheckpointSink, Explicit, ExplicitOnRanks, ModelSpec, Progress, SavedRun,
};
use powerhouse::{
    EquilibratedBody, Error, FileScene, Registry, ResultFolder, RunHooks, RunNotes, Scene, TimeStep,
};
use powerhouse_model::{Engine, EngineModel, ModelError, Precision, ThreadRanks};
use powerhouse_observe::{Snapshot, SnapshotSink};
use powerhouse_test_support::{EVERYTHING, TestFolder};

/// An engine whose blocks have a given number of elements, so that small scenes have blocks for many ranks.
struct Divided<E>(E, usize);

impl<E: Engine> Engine for Divided<E> {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn build(&self, spec: ModelSpec) -> Result<Box<dyn EngineModel>, ModelError> {
        self.0.build(spec.block_size(self.1))
    }
    fn is_on_all(&self, own: bool) -> Result<bool, ModelError> {
        self.0.is_on_all(own)
    }
}

/// Receiver of the snapshots of a rank that sees none.
struct Blind;

impl SnapshotSink for Blind {
    fn take(&mut self, _snapshot: &Snapshot) -> Result<(), Box<dyn StdError + Send + Sync>> {
        Err("only rank 0 sees snapshots".into())
    }
}

/// Receiver of the first checkpoint of a run and of its body after the stages; it ends the run.
#[derive(Debug, Default)]
struct First(Mutex<Option<SavedRun>>);

impl CheckpointSink for First {
    fn is_due(&self, progress: &Progress) -> bool {
        progress.done >= 32
    }
    fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
        *self.0.lock().unwrap() = Some(saved);
        Err(ModelError::refused("test", "stopped"))
    }
}

/// A scene of the data by its text, with a duration (s) and a precision.
fn scene(text: &str, name: &str, duration: f64, precision: Precision) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/scenes");
    let scene = FileScene::from_toml(text, file.join(name), &Registry::default())
        .unwrap()
        .into_scene();
    let scene = scene.with_duration(duration).with_precision(precision);
    scene.with_step(TimeStep::OfStable(0.97))
}

/// Runs a scene and writes its results, if it leads, into a folder.
fn write(
    scene: Scene,
    engine: Arc<dyn Engine>,
    leads: bool,
    folder: &Path,
    hooks: impl FnOnce(RunHooks<'static>) -> RunHooks<'static>,
) -> Result<(), Error> {
    let simulation = scene.with_engine(engine).prepare()?;
    let folder = ResultFolder::new(folder);
    let hooks = hooks(if leads {
        RunHooks::default()
            .with_stages(folder.stages(&simulation)?)
            .with_snapshots(folder.snapshots(&simulation)?)
    } else {
        RunHooks::default().with_snapshots(Box::new(Blind))
    });
    let (title, mesh) = (simulation.title().to_owned(), simulation.mesh().clone());
    let results = simulation.run(hooks)?;
    if leads {
        let notes = RunNotes::default();
        folder.write((&title, &mesh), &results, &notes, None)?;
    }
    Ok(())
}

/// The bytes of all files in a folder by their names, those of the summary without wall times.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let mut bytes = std::fs::read(&path).unwrap();
            if path.extension().is_some_and(|e| e == "json") {
                let mut summary: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
                if let Some(summary) = summary.as_object_mut() {
                    summary.remove("wall_time");
                }
                bytes = summary.to_string().into_bytes();
            }
            let name = path.strip_prefix(folder).unwrap().to_path_buf();
            assert!(all.insert(name, bytes).is_none());
        }
    }
    all
}

/// Fails unless two runs have the same files.
fn compare(what: &str, found: &BTreeMap<PathBuf, Vec<u8>>, expected: &BTreeMap<PathBuf, Vec<u8>>) {
    let names = |files: &BTreeMap<PathBuf, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(found), names(expected), "{what}");
    for (name, bytes) in expected {
        assert!(found[name] == *bytes, "{what}: {}", name.display());
    }
}

/// A scene, with the size of its blocks.
struct Case {
    name: &'static str,
    text: String,
    duration: f64,
    precision: Precision,
    block_size: usize,
}

impl Case {
    fn scene(&self) -> Scene {
        scene(&self.text, self.name, self.duration, self.precision)
    }

    /// The files of a run on one rank without the machinery of ranks.
    fn alone(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let folder = TestFolder::new("ranks-alone");
        let engine = Arc::new(Divided(Explicit, self.block_size));
        write(self.scene(), engine, true, &folder, |hooks| hooks).unwrap();
        files(&folder)
    }

    /// Calls a function with the engine of every rank, and whether it is rank 0.
    fn on_ranks(&self, ranks: usize, work: impl Fn(Arc<dyn Engine>, bool) + Sync) {
        self.on_each_rank(ranks, |engine, rank| work(engine, rank == 0));
    }

    /// Calls a function with the engine and the number of every rank.
    fn on_each_rank(&self, ranks: usize, work: impl Fn(Arc<dyn Engine>, usize) + Sync) {
        let found = ThreadRanks::run(ranks, |ranks| {
            let engine = ExplicitOnRanks::new(Box::new(ranks));
            let rank = engine.rank();
            work(Arc::new(Divided(engine, self.block_size)), rank);
            Ok(())
        });
        for (rank, found) in found.into_iter().enumerate() {
            assert!(found.is_ok(), "{} on {ranks} ranks: rank {rank}", self.name);
        }
    }

    /// Fails unless runs on some numbers of ranks and threads write the files of a run on one rank.
    fn check(&self, ranks: &[usize], threads: &[usize]) {
        let expected = self.alone();
        assert!(expected.len() > 4, "{}", self.name);
        for &ranks in ranks {
            for &threads in threads {
                let folder = TestFolder::new("ranks");
                self.on_ranks(ranks, |engine, leads| {
                    let scene = self.scene().with_threads(threads);
                    write(scene, engine, leads, &folder, |hooks| hooks).unwrap();
                });
                let what = format!(
                    "{} in {:?} on {ranks} ranks of {threads} threads",
                    self.name, self.precision
                );
                compare(&what, &files(&folder), &expected);
            }
        }
    }
}

/// The scene with everything: the opening by dynamic relaxation in two increments, the lining by conjugate gradients, then
/// the motion with joint, bolts, sections, state variables, envelopes and snapshots.
fn everything() -> Case {
    Case {
        name: "everything.toml",
        // The first steps towards equilibrium have what the later ones have.
        text: EVERYTHING
            .replace(
                "increments = 2\n",
                "increments = 2\nmethod = \"dynamic-relaxation\"\n",
            )
            .replace("tolerance = 1e-6", "tolerance = 1e-2"),
        duration: 0.02,
        precision: Precision::F64,
        block_size: 24,
    }
}

/// Any number of ranks writes the same files, to the byte but for wall times.
#[test]
fn ranks_write_the_same_files() {
    everything().check(&[1, 2, 5], &[1]);
}

/// A run that is saved on one number of ranks goes on with another one, to the same files.
#[test]
fn a_run_goes_on_with_another_number_of_ranks() {
    let case = everything();
    let expected = case.alone();
    for (before, after) in [(4, 1), (1, 3)] {
        let folder = TestFolder::new("ranks-resumed");
        let first = Arc::new(First::default());
        let body: Mutex<Option<EquilibratedBody>> = Mutex::new(None);
        let body = Arc::new(body);
        case.on_ranks(before, |engine, leads| {
            let (first, body) = (first.clone(), body.clone());
            let stopped = write(case.scene(), engine, leads, &folder, |hooks| {
                if leads {
                    hooks
                        .with_checkpoints(first)
                        .with_stage_hook(move |now| *body.lock().unwrap() = Some(now.clone()))
                } else {
                    hooks
                }
            });
            assert!(stopped.is_err());
        });
        let saved = Arc::new(first.0.lock().unwrap().take().unwrap());
        assert!(saved.done >= 32, "{}", saved.done);
        let body = body.lock().unwrap().clone().unwrap();
        case.on_ranks(after, |engine, leads| {
            let hooks = |hooks: RunHooks<'static>| {
                hooks
                    .with_equilibrated_body(body.clone())
                    .with_resume(saved.clone())
            };
            write(case.scene(), engine, leads, &folder, hooks).unwrap();
        });
        compare(
            &format!("from {before} ranks to {after}"),
            &files(&folder),
            &expected,
        );
    }
}

/// A cancellation flag that is set on one rank, before the stages or between two of them, ends the run of all ranks in
/// the same stage.
#[test]
fn a_stop_of_one_rank_between_stages_is_one_of_all() {
    let case = everything();
    for (of_rank, ends, expected) in [(1, 0, "opening"), (0, 1, "lining"), (2, 1, "lining")] {
        let folder = TestFolder::new("ranks-stopped");
        let found = Mutex::new(Vec::new());
        case.on_each_rank(3, |engine, rank| {
            let stop = Arc::new(AtomicBool::new(rank == of_rank && ends == 0));
            let raised = stop.clone();
            let hooks = |hooks: RunHooks<'static>| {
                hooks.with_stop(stop).with_stage_hook(move |body| {
                    if rank == of_rank && body.stages().len() == ends {
                        raised.store(true, Ordering::Relaxed);
                    }
                })
            };
            let outcome = write(case.scene(), engine, rank == 0, &folder, hooks);
            found.lock().unwrap().push(outcome);
        });
        let found = found.into_inner().unwrap();
        assert_eq!(found.len(), 3);
        for outcome in found {
            let is_expected =
                matches!(&outcome, Err(Error::Interrupted { stage }) if stage == expected);
            assert!(is_expected, "{of_rank}, {ends}: {outcome:?}");
        }
    }
}

/// The same for scenes of the data, in every precision and for all numbers of ranks and threads; some minutes.
#[test]
#[ignore = "takes long: cargo test --release --test shelves ranks -- --ignored"]
fn ranks_write_the_same_files_of_all_scenes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/scenes");
    for (name, duration) in [
        ("cavern_staged.toml", 0.05),
        ("cavern_damage.toml", 0.05),
        ("cavern_joint.toml", 0.15),
    ] {
        for precision in [Precision::F64, Precision::Mixed, Precision::F32] {
            let text = std::fs::read_to_string(folder.join(name)).unwrap();
            let case = Case {
                name,
                text,
                duration,
                precision,
                // 16 ranks need as many blocks, also of what is left after the excavation.
                block_size: 128,
            };
            case.check(&[1, 2, 3, 4, 7, 16], &[1, 2]);
        }
    }
}
