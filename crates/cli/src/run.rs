//! `powerhouse run`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::MultiProgress;
use powerhouse::engine::{Ended, StaticProgress};
use powerhouse::io::peak_memory;
use powerhouse::{
    CheckpointFiles, CheckpointInterval, CompletedStage, Error, FileScene, KeyChange, Message,
    ProgressHook, ResultFolder, RunHooks, RunInputs, RunNotes, SceneChoice, Simulation, StageSink,
};
use powerhouse_study::sweep::is_sweep;
use powerhouse_study::{CheckpointEvent, FreeFieldReport, RunWatch, SceneRun, StudyError};

use crate::checkpoint::{self, KeptAt};
use crate::progress::{Display, StaticDisplay};
use crate::ranks::Place;
use crate::terminal::{say, say_warning, warn_aside};
use crate::{INTERRUPTED, Outcome, check, read, report, stop};

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

impl Choice {
    /// The run, and the folder of its results.
    fn open(self) -> Result<(SceneRun<'static>, ResultFolder), Box<dyn std::error::Error>> {
        match self {
            Self::Start {
                scene,
                of_file,
                out,
                restart,
            } => {
                let path = scene;
                let scene = read(&path, &of_file)?;
                let folder = ResultFolder::new(out.unwrap_or_else(|| scene.result_folder()));
                folder.keep_scene(&path)?;
                warn_of_sweep(&folder);
                let mut run = SceneRun::new(scene, folder.clone());
                run.restart = restart;
                Ok((run, folder))
            }
            Self::Resume { folder, scene } => {
                let resumed = CheckpointFiles::of(&folder).read().map_err(Error::from)?;
                let scene = read_as(scene, &resumed.inputs, Vec::new())?;
                let folder = ResultFolder::new(folder);
                Ok((SceneRun::resumed(scene, folder.clone(), resumed)?, folder))
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
                let results = ResultFolder::new(out.unwrap_or_else(|| scene.result_folder()));
                let mut run = SceneRun::from_state(scene, results.clone(), kept)?;
                run.restart = restart;
                warn_of_sweep(&results);
                if is_same(results.path(), &folder) {
                    return Err(format!(
                        "the results would take the place of those of the run in {}: choose another folder with --out",
                        folder.display()
                    )
                    .into());
                }
                Ok((run, results))
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
) -> Result<FileScene, Box<dyn std::error::Error>> {
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

/// What a run prints.
struct Output {
    folder: ResultFolder,
    bars: MultiProgress,
    /// The display of the free-field check or of the time steps.
    display: Display,
    /// The cancellation flag.
    stop: Arc<AtomicBool>,
}

impl Output {
    fn show(&mut self, what: &str) -> Option<ProgressHook<'static>> {
        self.display = Display::among(&self.bars, what);
        Some(self.display.hook())
    }
}

impl RunWatch for Output {
    fn composed(&mut self, simulation: &mut Simulation, warnings: &[Message]) -> Result<(), Error> {
        report::before_run(simulation, warnings)
    }
    fn checkpoint(&mut self, event: CheckpointEvent) {
        report::lines(&event.to_string());
    }
    fn locked(&mut self, remark: &str) {
        say!("{remark}");
    }
    fn checks(&mut self) -> Option<ProgressHook<'static>> {
        self.show("free field")
    }
    fn checked(&mut self, found: Result<&FreeFieldReport, &StudyError>) {
        self.display.clear();
        check::say_found(found);
    }
    fn begins(&mut self, _notes: &RunNotes) -> Result<(), StudyError> {
        if self.stop.load(Ordering::Relaxed) {
            say!("interrupted before the first step: nothing was run");
            return Err(StudyError::Interrupted);
        }
        Ok(())
    }
    fn stages(&mut self, files: Option<Box<dyn StageSink>>) -> Option<Box<dyn StageSink>> {
        Some(Box::new(Stages::new(files?, &self.bars, "")))
    }
    fn progress(&mut self) -> Option<ProgressHook<'static>> {
        self.show("run")
    }
    fn ended(&mut self) {
        self.display.clear();
    }
    fn failed_in_stages(&mut self, completed: usize, of: usize) {
        if completed > 0 {
            warn_aside!(
                "note: the results of {completed} of {of} stages are in {}",
                self.folder.path().join("stages").display()
            );
            checkpoint::say_after_failure(&self.folder, false);
        }
    }
}

/// Runs a scene and writes the results, also of a failed run.
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
    let (mut run, folder) = place.agree(choice.open())?;
    run.threads = threads.map(NonZeroUsize::get);
    let stop = stop::flag()?;
    let bars = MultiProgress::new();
    let mut output = Output {
        folder: folder.clone(),
        display: Display::among(&bars, ""),
        bars,
        stop: stop.clone(),
    };
    run.interval = every;
    run.hooks = RunHooks::default().with_profile(profile).with_stop(stop);
    run.engine = place.engine().cloned();
    let ran = match run.run(&mut output) {
        Err(StudyError::Interrupted) => return Ok(ExitCode::from(INTERRUPTED)),
        Err(StudyError::Scene(Error::Interrupted { stage })) => {
            say!("interrupted in the stage '{stage}': the dynamic run has not begun");
            if place.leads() {
                checkpoint::say_resumable(&folder);
            }
            return Ok(ExitCode::from(INTERRUPTED));
        }
        ran => ran?,
    };
    let (mesh, results, failure) = (&ran.mesh, &ran.results, &ran.failure);
    // Only of a run whose end the ranks agree on.
    let memory = match failure {
        None => place.peak_memory(),
        Some(_) => None,
    };
    if !place.leads() {
        return match (ran.failure, ran.results.run.ended) {
            (Some(failure), _) => Err(failure.into()),
            (None, Ended::Stopped) => Ok(ExitCode::from(INTERRUPTED)),
            (None, _) => Ok(ExitCode::SUCCESS),
        };
    }
    report::end_of_run(mesh, results);
    if let Some(profile) = &results.run.profile {
        report::profile(profile);
    }
    let written = ran.write();
    if written.is_err() {
        // Both errors are printed, that of the run first.
        if let Some(failure) = failure {
            warn_aside!("error: {failure}");
        }
        checkpoint::say_after_failure(&folder, !results.advice.is_empty());
    }
    report::results(mesh, results, (&ran.notes, &written?));
    // With that of the files, which the first rank writes.
    let mut memory = memory.unwrap_or_default();
    if let (Some(first), Some(peak)) = (memory.first_mut(), peak_memory()) {
        *first = peak;
    }
    report::peak_memory(&memory);
    ran.close()?;
    for advice in &results.advice {
        warn_aside!("note: {advice}");
    }
    if failure.is_some() {
        checkpoint::say_after_failure(&folder, !results.advice.is_empty());
    }
    match (ran.failure, ran.results.run.ended) {
        (Some(failure), _) => Err(failure.into()),
        (None, Ended::Stopped) => {
            checkpoint::say_resumable(&folder);
            Ok(ExitCode::from(INTERRUPTED))
        }
        (None, _) => Ok(ExitCode::SUCCESS),
    }
}
