//! One run of a scene, with its results in a folder.

mod ran;
mod watch;

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use powerhouse::engine::ExplicitOnRanks;
use powerhouse::engine::observe::{Snapshot, SnapshotSink};
use powerhouse::{
    CheckpointFiles, CheckpointInterval, EquilibratedBody, Error, FileScene, FolderLock, KeptState,
    Message, Remark, ResultFolder, ResumedRun, RunHooks, RunInputs, RunNotes, Simulation, remark,
    run_inputs,
};

use crate::checkpoints::{RunCheckpoints, RunStart};
use crate::ranks::RunRanks;
use crate::saving::FormatError;
use crate::{CheckpointEvent, FreeFieldCheck, OutputSize, StudyError, Warning};
pub use ran::RanScene;
use ran::Written;
pub use watch::RunWatch;

/// Why ranks do not measure the error of a number format: each would need the memory of the whole body.
const ON_RANKS: &str = "ranks do not measure it, `powerhouse check` does, which needs the memory of one process with the whole body";

/// Source of the body after the stages in place of the run, from the simulation and the hooks of its stages.
type BodySource<'a> =
    dyn FnOnce(&Simulation, RunHooks<'_>) -> Result<Option<EquilibratedBody>, StudyError> + 'a;

/// Run of a scene, with its results in a folder or in memory.
///
/// Everything that could refuse the run or spoil its end comes before its first step and before the results of an earlier
/// run are removed: warnings with the error of the number format, the stable step, the lock of the folder, a proof that all
/// files can be written, a look for the checkpoint of an interrupted run, and the free-field check if the scene requests one.
///
/// ```no_run
/// use powerhouse::{FileScene, ResultFolder};
/// use powerhouse_study::SceneRun;
///
/// let scene = FileScene::from_file("scene.toml")?;
/// let mut ran = SceneRun::new(scene, ResultFolder::new("results")).run(&mut ())?;
/// let files = ran.write()?;
/// ran.close()?;
/// println!("{} steps, {} files", ran.results.run.steps, files.len());
/// # Ok::<(), powerhouse_study::StudyError>(())
/// ```
#[non_exhaustive]
pub struct SceneRun<'a> {
    /// Number of threads, above zero, in place of the scene's.
    pub threads: Option<usize>,
    /// Whether the checkpoint of a run that was interrupted in the folder is removed; a new run is refused otherwise.
    pub restart: bool,
    /// Whether checkpoints are written, as by default: of no use to a scene that cannot be read again.
    pub saves: bool,
    /// Wall time between two checkpoints in place of the scene's.
    pub interval: Option<CheckpointInterval>,
    /// Cancellation flag, further observers, profile, and the sink of snapshots of a run in memory. All else is set by the
    /// run.
    pub hooks: RunHooks<'static>,
    /// Engine of this process among several that compute the run together, each of which makes the same one; rank 0 writes
    /// the files.
    pub engine: Option<Arc<ExplicitOnRanks>>,
    scene: FileScene,
    inputs: RunInputs,
    /// Where the results are written; in memory alone without it.
    folder: Option<ResultFolder>,
    start: (RunStart, Vec<String>),
    /// Lock of the folder, if it is locked already.
    pub(crate) lock: Option<Arc<FolderLock>>,
    /// Title of the results in place of the scene's.
    pub(crate) title: Option<String>,
    /// Warnings beside those about the scene.
    pub(crate) warnings: Vec<Message>,
    /// Source of the body after the stages, of which the run then computes none.
    pub(crate) bodies: Option<Box<BodySource<'a>>>,
}

impl<'a> SceneRun<'a> {
    fn of(scene: FileScene, folder: Option<ResultFolder>) -> Self {
        Self {
            inputs: run_inputs(&scene),
            scene,
            threads: None,
            restart: false,
            saves: true,
            interval: None,
            hooks: RunHooks::default(),
            engine: None,
            folder,
            start: (RunStart::Scene, Vec::new()),
            lock: None,
            title: None,
            warnings: Vec::new(),
            bodies: None,
        }
    }
    /// A new run with its results in a folder.
    pub fn new(scene: impl Into<FileScene>, folder: ResultFolder) -> Self {
        Self::of(scene.into(), Some(folder))
    }
    /// A new run that writes no files; snapshots go to a sink.
    pub fn in_memory(scene: impl Into<FileScene>, snapshots: Box<dyn SnapshotSink>) -> Self {
        let mut run = Self::of(scene.into(), None);
        run.hooks.snapshots = Some(snapshots);
        run
    }
    /// The run with results in a folder, resumed from its last checkpoint, which is that of the same scene.
    ///
    /// # Errors
    /// [`CheckpointError::OtherRun`](powerhouse::CheckpointError::OtherRun).
    pub fn resumed(
        scene: impl Into<FileScene>,
        folder: ResultFolder,
        mut from: ResumedRun,
    ) -> Result<Self, StudyError> {
        let mut run = Self::new(scene, folder);
        run.restart = true;
        let checked = run.files().check(&from.inputs, &run.inputs);
        checked.map_err(Error::from)?;
        run.inputs.origin = from.inputs.origin.clone();
        let unused = core::mem::take(&mut from.unused);
        run.start = (RunStart::Checkpoint(from), unused);
        Ok(run)
    }
    /// A new run from a state that another run has kept.
    ///
    /// # Errors
    /// As [`KeptState::variant`].
    pub fn from_state(
        scene: impl Into<FileScene>,
        folder: ResultFolder,
        kept: KeptState,
    ) -> Result<Self, StudyError> {
        let mut run = Self::new(scene, folder);
        let inputs = kept.variant(&run.scene, run.inputs);
        run.inputs = inputs.map_err(Error::from)?;
        run.start.0 = RunStart::Kept(kept);
        Ok(run)
    }
    /// A run that goes on from the last checkpoint of the same inputs in its folder if there is one that can be used, and
    /// begins anew otherwise.
    pub(crate) fn continued(scene: FileScene, folder: ResultFolder) -> Self {
        let mut run = Self::new(scene, folder);
        run.restart = true;
        run.start = RunStart::last(&run.files(), &run.inputs);
        run
    }

    fn files(&self) -> CheckpointFiles {
        CheckpointFiles::of(
            self.folder
                .as_ref()
                .map_or(Path::new(""), ResultFolder::path),
        )
    }

    /// Composes, checks and runs the scene. The results are not written yet, but for what grows during the run.
    ///
    /// # Errors
    /// Whatever refuses the run: faults of the scene, a folder in use or that cannot hold the files,
    /// [`StudyError::Unfinished`], [`StudyError::TooCoarse`]. [`StudyError::Interrupted`] if the flag was raised during the
    /// free-field check, [`Error::Interrupted`] if it was within a stage. Errors of the stages. A failure of the motion is none: it
    /// is with the [results](RanScene::failure) until then.
    pub fn run(self, watch: &mut dyn RunWatch) -> Result<RanScene, StudyError> {
        let files = self.files();
        let Self {
            scene,
            inputs,
            folder,
            mut lock,
            mut hooks,
            ..
        } = self;
        let ranks = RunRanks(self.engine);
        let scene = match self.threads {
            Some(count) => scene.map(|scene| scene.with_threads(count)),
            None => scene,
        };
        let (leads, stop) = (ranks.leads(), hooks.stop.clone());
        ranks.refuse(&[
            ("--profile", hooks.profile),
            (
                "a run from a kept state (--from)",
                matches!(self.start.0, RunStart::Kept(_)),
            ),
            (
                "`keep` of `[checkpoint]`",
                !scene.checkpoints().keep.is_empty(),
            ),
        ])?;
        let text = scene.source().map(|source| source.text.clone());
        let has_begun = self.start.0.run().is_some();
        let origin = inputs.origin.clone();
        let of_writer = (&scene, inputs.clone());
        let mut checkpoints =
            RunCheckpoints::new(files, of_writer, self.start, (self.interval, true));
        let resumes = checkpoints.is_resumed();
        let foreseen = if leads {
            Foreseen::of(&scene, (resumes, folder.is_some()), ranks.count()).map(Some)
        } else {
            Ok(None)
        };
        let Foreseen {
            mut warnings,
            check,
            size,
        } = ranks.agree(foreseen)?.unwrap_or_default();
        warnings.extend(self.warnings);
        let scene = ranks.take(scene, &inputs)?;
        ranks.check_same("the checkpoint of the run", &checkpoints.description())?;
        let stages = scene.stages().len();
        let mut simulation = scene.prepare()?;
        let step = match checkpoints.step() {
            Some(step) if resumes => {
                simulation.resume_at(step);
                step
            }
            kept => {
                let own = simulation.step()?;
                kept.unwrap_or(own)
            }
        };
        if !(resumes && has_begun) {
            watch.composed(&mut simulation, &warnings)?;
        }
        let title = self.title.unwrap_or_else(|| simulation.title().to_owned());
        let mut remarks = simulation.remarks().to_vec();
        checkpoints.report(|event| watch.checkpoint(event));
        if let Some(origin) = origin {
            let remark = Remark::from(remark::StartedFrom { origin });
            watch.checkpoint(CheckpointEvent::Origin(&remark));
            remarks.push(remark);
        }
        // Everything that the end of the run needs is tested before its first step.
        let prepare = || -> Result<(), StudyError> {
            let Some(folder) = folder.as_ref().filter(|_| leads) else {
                return Ok(());
            };
            if lock.is_none() {
                let own = folder.lock()?;
                if let Some(remark) = own.remark() {
                    watch.locked(remark);
                }
                lock = Some(Arc::new(own));
            }
            if !self.restart {
                let of = (folder.path(), &inputs);
                checkpoints.refuse_resumable(of, |event| watch.checkpoint(event))?;
            }
            folder.remove_unfinished()?;
            let size = size.map_or(0, |size| size.bytes(step));
            Ok(folder.prove(&simulation, size)?)
        };
        ranks.agree(prepare())?;
        let notes = RunNotes::new(remarks).with_warnings(warnings);
        let checked = match check {
            Some(check) => made(check, (step, stop.clone()), watch),
            None => Ok(()),
        };
        let goes_on = match checked.and_then(|()| if leads { watch.begins(&notes) } else { Ok(()) })
        {
            Err(StudyError::Interrupted) => Ok(false),
            begins => begins.map(|()| true),
        };
        let goes_on = ranks.agree(goes_on)?;
        if !ranks.all(goes_on)? {
            return Err(StudyError::Interrupted);
        }
        let mesh = simulation.mesh().clone();
        let mut saved = checkpoints.take();
        let completed = Arc::new(Mutex::new(Vec::new()));
        let mut begin = || -> Result<(), StudyError> {
            if !leads {
                // Snapshots are taken by all ranks.
                hooks.snapshots = Some(Box::new(|_: &Snapshot| Ok(())));
                return Ok(());
            }
            let Some(folder) = &folder else {
                hooks.stages = watch.stages(None);
                return Ok(());
            };
            if !resumes {
                folder.clear()?;
                checkpoints.clear()?;
            }
            folder.begin(&simulation)?;
            hooks.snapshots = Some(folder.snapshots(&simulation)?);
            hooks.tables = Some(Box::new(folder.tables()));
            hooks.stages = watch.stages(Some(folder.stages(&simulation)?));
            let (reports, writer) = (completed.clone(), checkpoints.writer().clone());
            hooks.keep_stage = Some(Box::new(move |body| {
                body.stages().clone_into(&mut locked(&reports));
                if self.saves {
                    writer.keep_stage(body);
                }
            }));
            if self.saves {
                hooks.checkpoints = Some(checkpoints.writer().clone());
                if let Some(body) = saved.body.as_ref().filter(|_| !resumes) {
                    checkpoints.writer().keep_stage(body);
                }
            }
            Ok(())
        };
        ranks.agree(begin())?;
        hooks.completed_stages = saved.body.take();
        hooks.resume = saved.run.take();
        if ranks.count() == 1 {
            hooks.stage_solution = saved.solution.take();
            if self.saves && folder.is_some() {
                hooks.stage_checkpoints = Some(checkpoints.writer().clone());
            }
        }
        let rested = match self.bodies {
            None => Ok(None),
            Some(source) => {
                let mut own = RunHooks::default();
                own.stop = stop.clone();
                own.stages = hooks.stages.take();
                own.keep_stage = hooks.keep_stage.take();
                own.completed_stages = hooks.completed_stages.take();
                own.stage_solution = hooks.stage_solution.take();
                own.stage_checkpoints = hooks.stage_checkpoints.take();
                source(&simulation, own)
            }
        };
        let outcome = rested.and_then(|body| {
            hooks.equilibrated_body = body;
            hooks.progress = watch.progress();
            Ok(simulation.run(hooks)?)
        });
        watch.ended();
        checkpoints.finish(|event| watch.checkpoint(event));
        let (results, failure) = match outcome {
            Ok(results) => (results, None),
            Err(StudyError::Scene(Error::Failed { error, results })) => (*results, Some(error)),
            Err(StudyError::Scene(error)) => {
                if let Some(folder) = folder.as_ref().filter(|_| leads) {
                    let completed = locked(&completed);
                    match &error {
                        Error::Interrupted { stage } => {
                            folder.interrupt(&title, stage, &completed)?
                        }
                        error => {
                            folder.fail(&title, error, &completed)?;
                            watch.failed_in_stages(completed.len(), stages);
                        }
                    }
                }
                return Err(error.into());
            }
            Err(error) => return Err(error),
        };
        let written = folder.filter(|_| leads).map(|folder| Written {
            folder,
            checkpoints,
            lock,
            text,
        });
        Ok(RanScene {
            title,
            mesh,
            results,
            notes,
            failure,
            written,
        })
    }
}

/// What is known of a run before its model is built.
#[derive(Default)]
struct Foreseen {
    warnings: Vec<Message>,
    /// The free-field check with its limit.
    check: Option<(FreeFieldCheck, f64)>,
    size: Option<OutputSize>,
}

impl Foreseen {
    /// That of a scene, which resumes a run or not and writes files or not, on a number of ranks.
    fn of(
        scene: &FileScene,
        (resumes, writes): (bool, bool),
        ranks: usize,
    ) -> Result<Self, StudyError> {
        // A run that is resumed has passed the check.
        let limit = scene.self_check().filter(|_| !resumes);
        let check = limit.map(|limit| Ok::<_, StudyError>((FreeFieldCheck::of(scene)?, limit)));
        let mut warnings = crate::warnings(scene)?;
        let format = match ranks {
            1 => FormatError::of(scene)?,
            _ => FormatError::not_measured(scene, ON_RANKS),
        };
        let format = format.filter(FormatError::needs_warning);
        warnings.extend(format.map(Warning::Format));
        Ok(Self {
            check: check.transpose()?,
            warnings: warnings.iter().map(Warning::message).collect(),
            size: writes.then(|| OutputSize::of(scene)).transpose()?,
        })
    }
}

/// Makes a free-field check at a step (s).
fn made(
    (check, limit): (FreeFieldCheck, f64),
    (step, stop): (f64, Option<Arc<AtomicBool>>),
    watch: &mut dyn RunWatch,
) -> Result<(), StudyError> {
    let mut hooks = RunHooks::default();
    (hooks.stop, hooks.progress) = (stop, watch.checks());
    let found = check.run(step, hooks);
    watch.checked(found.as_ref());
    found?.require(limit)
}

/// Locks a mutex; data of a thread that panicked are used as they are.
fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
