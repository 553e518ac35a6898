//! One run of a trade study, with its cost and histories.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use powerhouse::engine::observe::HistoryTable;
use powerhouse::engine::{Ended, SavedRun};
use powerhouse::io::{TableColumn, read_table, write_summary, write_table};
use powerhouse::model::{CheckpointSink, ModelError, Progress};
use powerhouse::{
    CheckpointFiles, CheckpointInterval, CheckpointWriter, EquilibratedBody, FileScene,
    ResultFolder, RunHooks, SceneSpec, run_inputs,
};
use serde::{Deserialize, Serialize};

use super::plan::Design;
use super::{Trade, TradeWatch};
use crate::checkpoints::{RunCheckpoints, RunStart, is_of_state};
use crate::cost::CostModel;
use crate::json::read_json;
use crate::mark::Fingerprint;
use crate::sweep::of_stages;
use crate::variant::Variant;
use crate::{CheckpointEvent, StudyError, store};

const COST: &str = "cost.json";
const HISTORIES: &str = "histories.csv";
/// Wall time that an unfinished run has taken.
const SPENT: &str = "spent.json";

/// Cost of a whole run, measured over the window of a trade study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseCost {
    /// Length of the time step (s).
    pub step: f64,
    /// Mean wall time of a step (s).
    pub time_of_step: f64,
    /// Wall time before the first step (s): assembly of the model, stable step, construction stages (also where their
    /// result was reused).
    pub before: f64,
    /// Number of steps of the whole run.
    pub steps: u64,
    /// Predicted memory of the whole run (bytes).
    pub memory: u64,
}

impl CaseCost {
    /// Predicted wall time of the whole run (s).
    pub fn wall_time(&self) -> f64 {
        self.before + self.time_of_step * self.steps as f64
    }
}

/// Cost and histories of a finished run.
pub(super) struct TradeRun {
    pub(super) cost: CaseCost,
    pub(super) histories: Vec<TableColumn>,
}

/// Instants after the first and the last step, with the numbers of steps done.
#[derive(Clone, Copy, Debug, Default)]
struct StepTimes {
    first: Option<(Instant, u64)>,
    last: Option<(Instant, u64)>,
}

/// Wall time that a run has taken before it was interrupted or killed, beside its checkpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct SpentTime {
    /// Wall time of the completed stages (s).
    stages: f64,
    /// Wall time (s) of a number of time steps.
    stepping: f64,
    steps: u64,
}

impl SpentTime {
    /// Reads the time from the folder of a run; none for a run without it.
    fn read(folder: &Path) -> Self {
        let text = std::fs::read(folder.join(SPENT)).unwrap_or_default();
        serde_json::from_slice(&text).unwrap_or_default()
    }
    /// Writes the time to the folder of a run. A full disk ends no run: the cost is then that of the rest alone.
    fn write(&self, folder: &Path) {
        let _ = write_summary(&folder.join(SPENT), self);
    }
    /// The time with that of the steps of this process.
    fn with(mut self, clock: StepTimes) -> Self {
        if let (Some((first, one)), Some((last, all))) = (clock.first, clock.last) {
            self.stepping += (last - first).as_secs_f64();
            self.steps += all - one;
        }
        self
    }
}

/// Writer of checkpoints that also writes the time taken until then.
#[derive(Debug)]
struct TimedCheckpoints {
    writer: Arc<CheckpointWriter>,
    folder: PathBuf,
    clock: Arc<Mutex<StepTimes>>,
    spent: SpentTime,
}

impl CheckpointSink for TimedCheckpoints {
    fn is_due(&self, progress: &Progress) -> bool {
        self.writer.is_due(progress)
    }
    fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
        let spent = self.spent.with(*locked(&self.clock));
        spent.write(&self.folder);
        self.writer.take(saved)
    }
}

/// Removes the checkpoints of a run from its folder.
///
/// # Errors
/// A file that cannot be removed.
fn discard(folder: &Path) -> Result<(), StudyError> {
    // Files that a killed run was writing.
    ResultFolder::new(folder).remove_unfinished()?;
    let removed = CheckpointFiles::of(folder).remove();
    removed.map_err(powerhouse::Error::from)?;
    // Without a checkpoint it is not read.
    let _ = std::fs::remove_file(folder.join(SPENT));
    Ok(())
}

/// Common settings of the runs of a trade study, with the cache of equilibrated bodies.
pub(super) struct TradeRunner<'a> {
    pub(super) stop: Option<&'a Arc<AtomicBool>>,
    /// Duration of a run (s), and of the whole scene (s).
    pub(super) window: f64,
    pub(super) duration: f64,
    /// Wall time between two checkpoints of a run, in place of the scene's.
    pub(super) checkpoint_interval: Option<CheckpointInterval>,
    pub(super) bodies: BodyCache,
}

/// Cache of equilibrated bodies by the factors on which they depend: that of the reference and the last one, since
/// each is as large as a model.
#[derive(Default)]
pub(super) struct BodyCache(Vec<(String, StagingOutcome)>);

/// A body in static equilibrium and the wall time of its stages (s).
#[derive(Clone)]
struct StagingOutcome {
    body: EquilibratedBody,
    took: f64,
}

impl BodyCache {
    fn get(&self, name: &str) -> Option<&StagingOutcome> {
        let known = self.0.iter().find(|(other, _)| other == name);
        known.map(|(_, body)| body)
    }
    fn store(&mut self, name: &str, body: StagingOutcome) {
        self.0.truncate(1);
        self.0.push((name.to_owned(), body));
    }
}

impl TradeRunner<'_> {
    /// The results of an earlier run with the same fingerprint, if there are any.
    fn finished(
        &self,
        folder: &Path,
        fingerprint: &Fingerprint,
    ) -> Result<Option<TradeRun>, StudyError> {
        if !store::is_finished(folder, fingerprint) {
            return Ok(None);
        }
        let cost = read_json(&folder.join(COST))?;
        let histories = read_table(&folder.join(HISTORIES)).map_err(powerhouse::Error::from)?;
        Ok(Some(TradeRun { cost, histories }))
    }

    /// Runs a scene over the window, from the cached body with the key `body` if there is one, or from the checkpoint in
    /// its folder.
    fn run(
        &mut self,
        scene: FileScene,
        (folder, body): (&Path, &str),
        (watch, name): (&mut dyn TradeWatch, &str),
    ) -> Result<TradeRun, StudyError> {
        let started = Instant::now();
        let model = CostModel::of(&scene)?;
        let scene = scene.map(|scene| scene.with_duration(self.window));
        let files = CheckpointFiles::of(folder);
        let inputs = run_inputs(&scene);
        let start = RunStart::last(&files, &inputs);
        let kept = (self.checkpoint_interval, false);
        let mut checkpoints = RunCheckpoints::new(files, (&scene, inputs), start, kept);
        let spent = if checkpoints.is_resumed() {
            SpentTime::read(folder)
        } else {
            discard(folder)?;
            SpentTime::default()
        };
        checkpoints.report(|event| watch.checkpoint(name, event));
        let mut simulation = scene.prepare()?;
        let step = match checkpoints.step() {
            Some(step) => step,
            None => simulation.step()?,
        };
        let saved = checkpoints.take();
        let composed = started.elapsed().as_secs_f64();
        let spent = Arc::new(Mutex::new(spent));
        let equilibrated = match self.bodies.get(body) {
            Some(known) => {
                // Another study has no body in memory.
                locked(&spent).stages = known.took;
                locked(&spent).write(folder);
                checkpoints.writer().keep_stage(&known.body);
                Some(known.clone())
            }
            None => {
                let (started, before) = (Instant::now(), locked(&spent).stages);
                let keep = {
                    let (writer, spent) = (checkpoints.writer().clone(), spent.clone());
                    let folder = folder.to_path_buf();
                    move |body: &EquilibratedBody| {
                        let mut spent = locked(&spent);
                        spent.stages = before + started.elapsed().as_secs_f64();
                        spent.write(&folder);
                        writer.keep_stage(body);
                    }
                };
                let mut hooks = RunHooks::default().with_stage_hook(keep);
                hooks.stop = self.stop.cloned();
                hooks.completed_stages = saved.body;
                let found = simulation.equilibrate_with(hooks);
                let found = found.map_err(|error| of_stages(error.into()))?;
                let took = locked(&spent).stages;
                let found = found.map(|body| StagingOutcome { body, took });
                if let Some(found) = &found {
                    self.bodies.store(body, found.clone());
                }
                found
            }
        };
        // The cost includes the stages, even where their result came from the cache.
        let before = composed + equilibrated.as_ref().map_or(0.0, |found| found.took);
        let clock = Arc::new(Mutex::new(StepTimes::default()));
        let (times, mut hook) = (clock.clone(), watch.progress());
        let mut hooks = RunHooks::default().with_progress(move |progress| {
            let now = Some((Instant::now(), progress.done));
            let mut clock = locked(&times);
            clock.first = clock.first.or(now);
            clock.last = now;
            if let Some(hook) = &mut hook {
                hook(progress);
            }
        });
        hooks.stop = self.stop.cloned();
        hooks.equilibrated_body = equilibrated.map(|found| found.body);
        let spent = *locked(&spent);
        hooks.checkpoints = Some(Arc::new(TimedCheckpoints {
            writer: checkpoints.writer().clone(),
            folder: folder.to_path_buf(),
            clock: clock.clone(),
            spent,
        }));
        hooks.resume = saved.run;
        let done = hooks.resume.as_ref().map_or(0, |saved| saved.done);
        let results = simulation.run(hooks);
        checkpoints.finish(|event| watch.checkpoint(name, event));
        let results = results?;
        let stopped = self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed));
        if stopped && results.run.ended != Ended::Completed {
            return Err(StudyError::Interrupted);
        }
        let spent = spent.with(*locked(&clock));
        let time_of_step = match spent.steps {
            0 => results.wall_time.as_secs_f64() / (results.run.steps - done).max(1) as f64,
            steps => spent.stepping / steps as f64,
        };
        let steps = (self.duration / step).ceil() as u64 + 1;
        Ok(TradeRun {
            cost: CaseCost {
                step,
                time_of_step,
                before,
                steps,
                memory: model.memory(steps),
            },
            histories: columns(results.histories()),
        })
    }

    /// Writes the results of a run, its fingerprint last.
    fn store(
        &self,
        folder: &Path,
        fingerprint: &Fingerprint,
        finished: &TradeRun,
    ) -> Result<(), StudyError> {
        let files = [folder.join(COST), folder.join(HISTORIES)];
        let write = || -> Result<(), powerhouse::io::IoError> {
            write_summary(&files[0], &finished.cost)?;
            write_table(&files[1], &finished.histories)
        };
        std::fs::create_dir_all(folder).map_err(|source| StudyError::Read {
            file: folder.into(),
            source,
        })?;
        write().map_err(powerhouse::Error::from)?;
        store::finish(folder, fingerprint, &files)
    }
}

impl Trade {
    /// The results of a design, from an earlier run or a new one.
    pub(super) fn finish(
        &self,
        design: &Design,
        runner: &mut TradeRunner,
        watch: &mut dyn TradeWatch,
        name: &str,
    ) -> Result<TradeRun, StudyError> {
        let folder = self.level_indices(design, |_| true);
        let body = self.body_of(design);
        self.finish_spec(
            self.spec_of(design),
            (&folder, &body),
            runner,
            (watch, name),
        )
    }

    /// The results of a scene, from its folder or a new run; `body` is the key of its equilibrated body.
    pub(super) fn finish_spec(
        &self,
        spec: SceneSpec,
        (folder, body): (&str, &str),
        runner: &mut TradeRunner,
        (watch, name): (&mut dyn TradeWatch, &str),
    ) -> Result<TradeRun, StudyError> {
        let folder = self.folder.join(folder);
        let version = self.registry.version();
        let variant = Variant::with_files(spec, &self.inputs, Some(self.window), version)?;
        let fingerprint = variant.fingerprint();
        if let Some(finished) = runner.finished(&folder, fingerprint)? {
            // A study that was killed right after the end of the run has left its checkpoints.
            let _ = discard(&folder);
            watch.reused(name);
            return Ok(finished);
        }
        let scene = || variant.scene(&self.registry);
        let mut done = runner.run(scene()?, (&folder, body), (watch, name));
        // A checkpoint whose state does not fit the body, as that of another build of the program, is removed.
        if let Err(error) = &done
            && is_of_state(error)
        {
            watch.checkpoint(name, CheckpointEvent::Unused(&error.to_string()));
            discard(&folder)?;
            done = runner.run(scene()?, (&folder, body), (watch, name));
        }
        let finished = match done {
            // A run that fails is a result of the study, which has no use for its checkpoints.
            Err(error @ StudyError::Scene(_)) => {
                discard(&folder)?;
                return Err(error);
            }
            finished => finished?,
        };
        runner.store(&folder, fingerprint, &finished)?;
        discard(&folder)?;
        // Read back, as a later study does: a number may lose its last bit in a file.
        Ok(runner.finished(&folder, fingerprint)?.unwrap_or(finished))
    }
}

/// Locks a mutex; data of a thread that panicked are used as they are.
fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The columns of a table of histories, after that of time.
pub(crate) fn columns(table: &HistoryTable) -> Vec<TableColumn> {
    let mut columns = vec![TableColumn::new("time", "s", table.times.clone())];
    let others = table.columns.iter();
    columns.extend(others.map(|c| TableColumn::new(c.name.clone(), c.unit, c.values.clone())));
    columns
}
