//! `powerhouse run`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use indicatif::MultiProgress;
use powerhouse::engine::{Ended, StaticProgress};
use powerhouse::{CompletedStage, Error, ResultFolder, RunHooks, RunNotes, StageSink};
use powerhouse_study::saving::FormatError;
use powerhouse_study::{FreeFieldCheck, OutputSize, Warning};

use crate::progress::{Display, StaticDisplay};
use crate::terminal::{say, warn_aside};
use crate::{INTERRUPTED, Outcome, check, read, report, stop};

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
pub(crate) fn run(path: &Path, case: Option<&str>, out: Option<PathBuf>, profile: bool) -> Outcome {
    let scene = read(path, case)?;
    let folder = out.map_or_else(|| scene.result_folder(), ResultFolder::new);
    let text = scene.source().map(|source| source.text.clone());
    let limit = scene.self_check();
    let free_field = match limit {
        Some(_) => Some(FreeFieldCheck::of(&scene)?),
        None => None,
    };
    let mut warnings = powerhouse_study::warnings(&scene)?;
    if let Some(format) = FormatError::of(&scene)?.filter(FormatError::needs_warning) {
        warnings.push(Warning::Format(format));
    }
    let size = OutputSize::of(&scene)?;
    let mut simulation = scene.prepare()?;
    let stop = stop::flag()?;
    report::before_run(&mut simulation, &warnings)?;
    // Everything that the end of the run needs is tested before its first step.
    let lock = folder.lock()?;
    if let Some(remark) = lock.remark() {
        say!("{remark}");
    }
    let step = simulation.step()?;
    folder.prove(&simulation, size.bytes(step))?;

    if let (Some(free_field), Some(limit)) = (free_field, limit) {
        match check::compare(free_field, step, &stop)? {
            Some(found) => found.require(limit)?,
            None => return Ok(ExitCode::from(INTERRUPTED)),
        }
    }
    folder.clear()?;
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
    let outcome = simulation.run(hooks);
    display.clear();
    let (results, failure) = match outcome {
        Ok(results) => (results, None),
        Err(Error::Failed { error, results }) => (*results, Some(error)),
        Err(Error::Interrupted { stage }) => {
            say!("interrupted in the stage '{stage}': the dynamic run has not begun");
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
    if let (Err(_), Some(failure)) = (&written, &failure) {
        // Both errors are printed, that of the run first.
        warn_aside!("error: {failure}");
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
        (Some(failure), _) => Err(failure.into()),
        (None, Ended::Stopped) => Ok(ExitCode::from(INTERRUPTED)),
        (None, _) => Ok(ExitCode::SUCCESS),
    }
}
