//! `powerhouse run`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};

use indicatif::MultiProgress;
use powerhouse::engine::observe::Snapshot;
use powerhouse::engine::{Ended, StaticProgress};
use powerhouse::io::peak_memory;
use powerhouse::{
    CheckpointFiles, CheckpointInterval, CheckpointWriter, CompletedStage, Error, FolderLock,
    KeptState, KeyChange, Remark, ResultFolder, ResumedRun, RunHooks, RunInputs, RunNotes, Scene,
    SceneChoice, Simulation, StageSink,
};
use powerhouse_study::saving::FormatError;
use powerhouse_study::sweep::is_sweep;
use powerhouse_study::{FreeFieldCheck, OutputSize, Warning};

use crate::checkpoint::{self, KeptAt};
use crate::progress::{Display, StaticDisplay};
use crate::ranks::Place;
use crate::terminal::{say, say_warning, warn_aside};
use crate::{INTERRUPTED, Outcome, check, read, report, stop};

/// Why ranks do not measure the error of a number format: each would need the memory of the whole body.
const ON_RANKS: &str = "ranks do not measure it, `powerhouse check` does, which needs the memory of one process with the whole body";

/// Scene that is run, and where its results are.
pub(crate) enum Choice {
    /// A new run of a scene, or of a case of it.
    Start {
        scene: PathBuf,
        of_file: SceneChoice,
        out: Option<PathBuf>,
        /// Whether it begins anew although a run of the same inputs was interrupted in its folder.
        restart: bool,
    },
    /// The run with results in a folder, which is resumed; its scene may have moved.
    Resume {
        folder: PathBuf,
        scene: Option<PathBuf>,
    },
    /// A new run from a state that an earlier one has kept; its scene is that of the earlier run, unless another is given.
    From {
        kept: KeptAt,
        scene: Option<PathBuf>,
        of_file: SceneChoice,
        out: Option<PathBuf>,
        restart: bool,
    },
}

/// Options of a run that do not change its results.
pub(crate) struct Options {
    /// Wall time between two checkpoints, in place of the scene's.
    pub(crate) every: Option<CheckpointInterval>,
    /// Number of threads, in place of the scene's.
    pub(crate) threads: Option<NonZeroUsize>,
    /// Whether the parts of time steps are timed.
    pub(crate) profile: bool,
}

/// State from which a run begins.
enum Beginning {
    /// That of the scene.
    Scene,
    /// The last checkpoint of the same run.
    Checkpoint(ResumedRun),
    /// A state that another run has kept.
    Kept(KeptState),
}

/// What is run: a scene, the folder of its results, its inputs, and the state from which it begins.
struct Planned {
    scene: Scene,
    folder: ResultFolder,
    inputs: RunInputs,
    beginning: Beginning,
    /// Whether the checkpoint of an interrupted run in the folder is removed.
    restart: bool,
}

impl Choice {
    fn open(self) -> Result<Planned, Box<dyn std::error::Error>> {
        match self {
            Self::Start {
                scene,
                of_file,
                out,
                restart,
            } => {
                let path = scene;
                let scene = read(&path, &of_file)?;
                let folder = out.map_or_else(|| scene.result_folder(), ResultFolder::new);
                folder.keep_scene(&path)?;
                warn_of_sweep(&folder);
                Ok(Planned {
                    folder,
                    inputs: RunInputs::of(&scene),
                    beginning: Beginning::Scene,
                    restart,
                    scene,
                })
            }
            Self::Resume { folder, scene } => {
                let files = CheckpointFiles::of(&folder);
                let resumed = files.read().map_err(Error::from)?;
                let scene = read_as(scene, &resumed.inputs, Vec::new())?;
                let mut inputs = RunInputs::of(&scene);
                let checked = files.check(&resumed.inputs, &inputs);
                checked.map_err(Error::from)?;
                inputs.origin = resumed.inputs.origin.clone();
                Ok(Planned {
                    scene,
                    folder: ResultFolder::new(folder),
                    inputs,
                    beginning: Beginning::Checkpoint(resumed),
                    restart: true,
                })
            }
            Self::From {
                kept: KeptAt { folder, time },
                scene,
                of_file,
                out,
                restart,
            } => {
                let kept = CheckpointFiles::of(&folder).read_kept(time);
                let kept = kept.map_err(Error::from)?;
                if of_file.case.is_some() && of_file.case != kept.inputs.case {
                    return Err(
                        "the case is that of the run whose state is used: leave out --case".into(),
                    );
                }
                let scene = read_as(scene, &kept.inputs, of_file.changes)?;
                let inputs = kept.variant(&scene).map_err(Error::from)?;
                let results = out.map_or_else(|| scene.result_folder(), ResultFolder::new);
                warn_of_sweep(&results);
                if is_same(results.path(), &folder) {
                    return Err(format!(
                        "the results would take the place of those of the run in {}: choose another folder with --out",
                        folder.display()
                    )
                    .into());
                }
                Ok(Planned {
                    scene,
                    folder: results,
                    inputs,
                    beginning: Beginning::Kept(kept),
                    restart,
                })
            }
        }
    }
}

/// Warns of the folder of a sweep, among whose cases the files of a run will lie.
fn warn_of_sweep(folder: &ResultFolder) {
    if is_sweep(folder.path()) {
        say_warning!(
            "{} has the results of a sweep, of which `report` and `plot` speak there: the files of this run are written among them; --out gives another folder",
            folder.path().display()
        );
    }
}

/// The scene of an earlier run with its changes and further ones, from another path if one is given.
fn read_as(
    path: Option<PathBuf>,
    inputs: &RunInputs,
    further: Vec<KeyChange>,
) -> Result<Scene, Box<dyn std::error::Error>> {
    let path = path.or_else(|| inputs.scene.clone());
    let path = path.ok_or("the earlier run is that of a scene without a file")?;
    let changes: Result<Vec<KeyChange>, _> = inputs.changes.iter().map(|c| c.parse()).collect();
    let mut changes = changes?;
    changes.extend(further);
    let case = inputs.case.clone();
    Ok(read(&path, &SceneChoice { case, changes })?)
}

/// Whether two paths are those of one file or folder that exists.
fn is_same(first: &Path, second: &Path) -> bool {
    match (first.canonicalize(), second.canonicalize()) {
        (Ok(first), Ok(second)) => first == second,
        _ => false,
    }
}

/// Locks the folder of the results, removes what an earlier run left unfinished, and proves that the files of a simulation,
/// with a size (bytes), can be written. A run of the same inputs that was interrupted there is refused, unless it is
/// resumed or begun anew on purpose.
fn prepare(
    folder: &ResultFolder,
    (simulation, size): (&Simulation, u64),
    (restart, inputs): (bool, &RunInputs),
) -> Result<FolderLock, Box<dyn std::error::Error>> {
    let lock = folder.lock()?;
    if let Some(remark) = lock.remark() {
        say!("{remark}");
    }
    if !restart {
        checkpoint::refuse_resumable(folder, inputs)?;
    }
    folder.remove_unfinished()?;
    folder.prove(simulation, size)?;
    Ok(lock)
}

/// Removes the files of an earlier run unless it is resumed, and writes the summary of one that has begun.
fn begin(
    folder: &ResultFolder,
    files: &CheckpointFiles,
    (title, resumes): (&str, bool),
) -> Result<(), Box<dyn std::error::Error>> {
    if !resumes {
        folder.clear()?;
        files.clear().map_err(Error::from)?;
    }
    folder.begin(title)?;
    Ok(())
}

/// Stage sink that prints a line per stage, shows the progress of its solution, and forwards to the writer of files.
pub(crate) struct Stages {
    files: Box<dyn StageSink>,
    bars: MultiProgress,
    display: StaticDisplay,
}

impl Stages {
    /// Creates the sink; the prefix distinguishes parallel cases and may be empty.
    pub(crate) fn new(files: Box<dyn StageSink>, bars: &MultiProgress, prefix: &str) -> Self {
        Self {
            files,
            bars: bars.clone(),
            display: StaticDisplay::among(bars, prefix),
        }
    }
}

impl StageSink for Stages {
    fn progress(&mut self, stage: &str, progress: StaticProgress) {
        self.display.update(stage, &progress);
        self.files.progress(stage, progress);
    }
    fn completed(&mut self, stage: &CompletedStage) -> Result<(), Error> {
        self.display.clear();
        self.bars.suspend(|| report::stage(stage));
        self.files.completed(stage)
    }
}

/// Runs the free-field check if the scene requests it, runs the scene, and writes the results, also of a failed run.
///
/// On several ranks all of them run the scene; one of them checks and writes.
pub(crate) fn run(
    choice: Choice,
    Options {
        every,
        threads,
        profile,
    }: Options,
    place: &Place,
) -> Outcome {
    let leads = place.leads();
    let Planned {
        scene,
        folder,
        inputs,
        beginning,
        restart,
    } = place.agree(choice.open())?;
    let scene = match threads {
        Some(count) => scene.with_threads(count.get()),
        None => scene,
    };
    place.refuse(&[
        ("--profile", profile),
        (
            "a run from a kept state (--from)",
            matches!(beginning, Beginning::Kept(_)),
        ),
        (
            "`keep` of `[checkpoint]`",
            !scene.checkpoints().keep.is_empty(),
        ),
    ])?;
    let text = scene.source().map(|source| source.text.clone());
    let resumes = matches!(beginning, Beginning::Checkpoint(_));
    // A run that is resumed has passed the check.
    let limit = scene.self_check().filter(|_| !resumes && leads);
    let free_field = match limit {
        Some(_) => Some(FreeFieldCheck::of(&scene)?),
        None => None,
    };
    let mut warnings = powerhouse_study::warnings(&scene)?;
    let format = match place.count() {
        1 => FormatError::of(&scene)?,
        _ => FormatError::not_measured(&scene, ON_RANKS),
    };
    if let Some(format) = format.filter(FormatError::needs_warning) {
        warnings.push(Warning::Format(format));
    }
    let size = OutputSize::of(&scene)?;
    let scene = place.take(scene, &inputs)?;
    let origin = inputs.origin.clone();
    let saved = match &beginning {
        Beginning::Scene => None,
        Beginning::Checkpoint(resumed) => resumed.run.as_ref(),
        Beginning::Kept(kept) => Some(&kept.run),
    };
    let (saved_step, saved_time) = (saved.map(|run| run.step), saved.map(|run| run.time));
    let files = CheckpointFiles::of(folder.path());
    let every = every.or(scene.checkpoints().every);
    let every = every.unwrap_or(CheckpointInterval::DEFAULT).duration();
    let own = (files.clone(), inputs.clone());
    let checkpoints = CheckpointWriter::new(&scene, own, every, saved_time);
    let stages = scene.stages().len();
    let mut simulation = scene.prepare()?;
    let stop = stop::flag()?;
    match saved_step {
        Some(step) if resumes => simulation.resume_at(step),
        _ => report::before_run(&mut simulation, &warnings)?,
    }
    if let Beginning::Checkpoint(resumed) = &beginning {
        checkpoint::say_resumed(resumed);
    }
    let mut remarks = simulation.remarks().to_vec();
    if let Some(origin) = origin {
        let remark = Remark::StartedFrom { origin };
        say!("{remark}");
        remarks.push(remark);
    }
    let step = match saved_step {
        Some(step) => step,
        None => simulation.step()?,
    };
    // Everything that the end of the run needs is tested before its first step.
    let prepared = match leads {
        true => prepare(&folder, (&simulation, size.bytes(step)), (restart, &inputs)).map(Some),
        false => Ok(None),
    };
    let lock = place.agree(prepared)?;
    let checked = match (free_field, limit) {
        (Some(free_field), Some(limit)) => match check::compare(free_field, step, &stop) {
            Ok(Some(found)) => found.require(limit).map(|()| true).map_err(Into::into),
            Ok(None) => Ok(false),
            Err(error) => Err(error.into()),
        },
        _ => Ok(true),
    };
    let goes_on = place.agree(checked)?;
    if !place.all(goes_on)? {
        return Ok(ExitCode::from(INTERRUPTED));
    }
    let (title, mesh) = (simulation.title().to_owned(), simulation.mesh().clone());
    let begun = match leads {
        true => begin(&folder, &files, (&title, resumes)),
        false => Ok(()),
    };
    place.agree(begun)?;
    let notes =
        RunNotes::new(remarks).with_warnings(warnings.iter().map(Warning::message).collect());
    let bars = MultiProgress::new();
    let display = Display::among(&bars, "run");
    let hooks = RunHooks::default()
        .with_progress(display.hook())
        .with_stop(stop)
        .with_profile(profile);
    // The body after the last completed stage, and with it the reports of all before it.
    let completed = Arc::new(Mutex::new(Vec::new()));
    let mut hooks = match leads {
        false => hooks.with_snapshots(Box::new(|_: &Snapshot| Ok(()))),
        true => {
            let (keep, reports) = (checkpoints.clone(), completed.clone());
            let sink = folder.stages(&simulation)?;
            hooks
                .with_tables(folder.tables())
                .with_snapshots(folder.snapshots(&simulation)?)
                .with_stages(Box::new(Stages::new(sink, &bars, "")))
                .with_checkpoints(checkpoints.clone())
                .with_stage_hook(move |body| {
                    let mut reports = reports.lock().unwrap_or_else(PoisonError::into_inner);
                    reports.clear();
                    reports.extend_from_slice(body.stages());
                    keep.keep_stage(body);
                })
        }
    };
    if place.count() == 1 {
        hooks = hooks.with_stage_checkpoints(checkpoints.clone());
    }
    let hooks = match beginning {
        Beginning::Scene => hooks,
        Beginning::Checkpoint(resumed) => checkpoint::resuming(hooks, resumed, stages),
        Beginning::Kept(kept) => {
            if let Some(body) = &kept.body {
                checkpoints.keep_stage(body);
            }
            checkpoint::starting_from(hooks, kept)
        }
    };
    let outcome = simulation.run(hooks);
    display.clear();
    // Only of a run whose end the ranks agree on.
    let memory = outcome.is_ok().then(|| place.peak_memory()).flatten();
    if let Some(lost) = checkpoints.finish() {
        say_warning!("a checkpoint could not be written: {lost}");
    }
    if !leads {
        return match outcome {
            Ok(results) if results.run.ended == Ended::Stopped => Ok(ExitCode::from(INTERRUPTED)),
            Ok(_) => Ok(ExitCode::SUCCESS),
            Err(Error::Interrupted { .. }) => Ok(ExitCode::from(INTERRUPTED)),
            Err(Error::Failed { error, .. }) => Err(error.into()),
            Err(error) => Err(error.into()),
        };
    }
    let (results, failure) = match outcome {
        Ok(results) => (results, None),
        Err(Error::Failed { error, results }) => (*results, Some(error)),
        Err(Error::Interrupted { stage }) => {
            say!("interrupted in the stage '{stage}': the dynamic run has not begun");
            let completed = completed.lock().unwrap_or_else(PoisonError::into_inner);
            folder.interrupt(&title, &stage, &completed)?;
            checkpoint::say_resumable(&folder);
            return Ok(ExitCode::from(INTERRUPTED));
        }
        Err(error) => {
            let completed = completed.lock().unwrap_or_else(PoisonError::into_inner);
            folder.fail(&title, &error, &completed)?;
            if !completed.is_empty() {
                warn_aside!(
                    "note: the results of {} of {stages} stages are in {}",
                    completed.len(),
                    folder.path().join("stages").display()
                );
                checkpoint::say_after_failure(&folder, false);
            }
            return Err(error.into());
        }
    };
    report::end_of_run(&mesh, &results);
    if let Some(profile) = &results.run.profile {
        report::profile(profile);
    }
    let is_held = lock.as_ref().is_some_and(FolderLock::is_held);
    let written = folder.write((&title, &mesh), &results, &notes, text.as_deref());
    if written.is_err() {
        // Both errors are printed, that of the run first.
        if let Some(failure) = &failure {
            warn_aside!("error: {failure}");
        }
        checkpoint::say_after_failure(&folder, !results.advice.is_empty());
    }
    report::results(&mesh, &results, (&notes, &written?));
    // With that of the files, which the first rank writes.
    let mut memory = memory.unwrap_or_default();
    if let (Some(first), Some(peak)) = (memory.first_mut(), peak_memory()) {
        *first = peak;
    }
    report::peak_memory(&memory);
    // Released after all files are written, so that no results are lost.
    if let Some(lock) = lock.filter(|_| !is_held) {
        lock.release()?;
    }
    for advice in &results.advice {
        warn_aside!("note: {advice}");
    }
    match (failure, results.run.ended) {
        (Some(failure), _) => {
            checkpoint::say_after_failure(&folder, !results.advice.is_empty());
            Err(failure.into())
        }
        (None, Ended::Stopped) => {
            checkpoint::say_resumable(&folder);
            Ok(ExitCode::from(INTERRUPTED))
        }
        (None, _) => {
            // The results are complete.
            files.remove().map_err(Error::from)?;
            Ok(ExitCode::SUCCESS)
        }
    }
}
