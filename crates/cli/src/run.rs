//! `powerhouse run`.

use std::path::PathBuf;
use std::process::ExitCode;

use indicatif::MultiProgress;
use powerhouse::engine::{Ended, StaticProgress};
use powerhouse::{
    CheckpointFiles, CheckpointWriter, CompletedStage, Error, ResultFolder, ResumedRun, RunHooks,
    RunInputs, RunNotes, Scene, StageSink,
};
use powerhouse_study::saving::FormatError;
use powerhouse_study::{FreeFieldCheck, OutputSize, Warning};

use crate::checkpoint::{self, Interval};
use crate::progress::{Display, StaticDisplay};
use crate::terminal::{say, warn_aside};
use crate::{INTERRUPTED, Outcome, check, read, report, stop};

/// Scene that is run, and where its results are.
pub(crate) enum Choice {
    /// A new run of a scene, or of a case of it.
    Start {
        scene: PathBuf,
        case: Option<String>,
        out: Option<PathBuf>,
    },
    /// The run with results in a folder, which is resumed; its scene may have moved.
    Resume {
        folder: PathBuf,
        scene: Option<PathBuf>,
    },
}

impl Choice {
    /// The scene, the folder of its results, and the state from which it is resumed, if it is.
    fn open(self) -> Result<(Scene, ResultFolder, Option<ResumedRun>), Box<dyn std::error::Error>> {
        match self {
            Self::Start { scene, case, out } => {
                let scene = read(&scene, case.as_deref())?;
                let folder = out.map_or_else(|| scene.result_folder(), ResultFolder::new);
                Ok((scene, folder, None))
            }
            Self::Resume { folder, scene } => {
                let files = CheckpointFiles::of(&folder);
                let mut resumed = files.read().map_err(Error::from)?;
                let path = scene.or_else(|| resumed.inputs.scene.clone());
                let path = path.ok_or("the checkpoint is of a scene without a file")?;
                let scene = read(&path, resumed.inputs.case.as_deref())?;
                let here = RunInputs::of(&scene);
                let checked = files.check(&resumed.inputs, &here);
                checked.map_err(Error::from)?;
                // The same but for the path of the scene.
                resumed.inputs = here;
                Ok((scene, ResultFolder::new(folder), Some(resumed)))
            }
        }
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

/// Runs the free-field check if the scene requests it, runs the scene, and writes the results, also of a failed run.
pub(crate) fn run(choice: Choice, every: Interval, profile: bool) -> Outcome {
    let (scene, folder, resumed) = choice.open()?;
    let text = scene.source().map(|source| source.text.clone());
    // A run that is resumed has passed the check.
    let limit = scene.self_check().filter(|_| resumed.is_none());
    let free_field = match limit {
        Some(_) => Some(FreeFieldCheck::of(&scene)?),
        None => None,
    };
    let mut warnings = powerhouse_study::warnings(&scene)?;
    if let Some(format) = FormatError::of(&scene)?.filter(FormatError::needs_warning) {
        warnings.push(Warning::Format(format));
    }
    let size = OutputSize::of(&scene)?;
    let inputs = match &resumed {
        Some(resumed) => resumed.inputs.clone(),
        None => RunInputs::of(&scene),
    };
    let stages = scene.stages().len();
    let mut simulation = scene.prepare()?;
    let stop = stop::flag()?;
    let saved_step = resumed
        .as_ref()
        .and_then(|resumed| Some(resumed.run.as_ref()?.step));
    match saved_step {
        Some(step) => simulation.resume_at(step),
        None => report::before_run(&mut simulation, &warnings)?,
    }
    if let Some(resumed) = &resumed {
        checkpoint::say_resumed(resumed);
    }
    // Everything that the end of the run needs is tested before its first step.
    let lock = folder.lock()?;
    if let Some(remark) = lock.remark() {
        say!("{remark}");
    }
    folder.remove_unfinished()?;
    let step = match saved_step {
        Some(step) => step,
        None => simulation.step()?,
    };
    folder.prove(&simulation, size.bytes(step))?;

    if let (Some(free_field), Some(limit)) = (free_field, limit) {
        match check::compare(free_field, step, &stop)? {
            Some(found) => found.require(limit)?,
            None => return Ok(ExitCode::from(INTERRUPTED)),
        }
    }
    let files = CheckpointFiles::of(folder.path());
    if resumed.is_none() {
        folder.clear()?;
        files.remove().map_err(Error::from)?;
    }
    let checkpoints = CheckpointWriter::new(files.clone(), inputs, every.0);
    let (title, mesh) = (simulation.title().to_owned(), simulation.mesh().clone());
    folder.begin(&title)?;
    let notes = RunNotes::new(simulation.remarks().to_vec())
        .with_warnings(warnings.iter().map(Warning::message).collect());
    let bars = MultiProgress::new();
    let display = Display::among(&bars, "run");
    let hooks = RunHooks::default()
        .with_progress(display.hook())
        .with_stop(stop)
        .with_profile(profile)
        .with_tables(folder.tables())
        .with_snapshots(folder.snapshots(&simulation)?)
        .with_stages(Box::new(Stages::new(
            folder.stages(&simulation)?,
            &bars,
            "",
        )));
    let keep = checkpoints.clone();
    let hooks = hooks
        .with_checkpoints(checkpoints.clone())
        .with_stage_hook(move |body| keep.keep_stage(body));
    let outcome = simulation.run(checkpoint::from(hooks, resumed, stages));
    display.clear();
    let (_, lost) = checkpoints.finish();
    if let Some(lost) = lost {
        say!("warning: a checkpoint could not be written: {lost}");
    }
    let (results, failure) = match outcome {
        Ok(results) => (results, None),
        Err(Error::Failed { error, results }) => (*results, Some(error)),
        Err(Error::Interrupted { stage }) => {
            say!("interrupted in the stage '{stage}': the dynamic run has not begun");
            checkpoint::say_resumable(&folder);
            return Ok(ExitCode::from(INTERRUPTED));
        }
        Err(error) => return Err(error.into()),
    };
    report::end_of_run(&mesh, &results);
    if let Some(profile) = &results.run.profile {
        report::profile(profile);
    }
    let is_held = lock.is_held();
    let written = folder.write((&title, &mesh), &results, &notes, text.as_deref());
    if written.is_err() {
        // Both errors are printed, that of the run first.
        if let Some(failure) = &failure {
            warn_aside!("error: {failure}");
        }
        checkpoint::say_after_failure(&folder, !results.advice.is_empty());
    }
    report::results(&mesh, &results, (&notes, &written?));
    // Released after all files are written, so that no results are lost.
    if !is_held {
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
