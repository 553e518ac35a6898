//! Runs of scenes, as the command `powerhouse run` makes them.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use powerhouse::engine::observe::Snapshot;
use powerhouse::engine::{Ended, StaticProgress};
use powerhouse::model::{Observer, RunError};
use powerhouse::{CheckpointInterval, CompletedStage, Error, RunHooks, RunNotes, StageSink};
use powerhouse_study::saving::FormatError;
use powerhouse_study::{FreeFieldCheck, OutputSize, StudyError, Warning};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::alarm::Alarm;
use crate::fault::{Failure, exception, with};
use crate::folder::{self, Open};
use crate::results::{Done, Results, Shot};
use crate::scene::Source;
use crate::waiting::wait_with;

/// A run that is to be made.
pub(crate) struct Order {
    pub(crate) source: Source,
    /// Folder of the results; none to keep them in memory alone.
    pub(crate) folder: Option<PathBuf>,
    /// Number of threads in place of the scene's.
    pub(crate) threads: Option<usize>,
    pub(crate) checkpoint_every: Option<CheckpointInterval>,
}

/// How far a run is, for the thread that waits.
#[derive(Default)]
pub(crate) struct Progress {
    /// The stage that is being solved.
    stage: Mutex<Option<String>>,
    done: AtomicU64,
    planned: AtomicU64,
    /// Bits of the time (s).
    time: AtomicU64,
}

impl Progress {
    fn set_stage(&self, stage: Option<&str>) {
        let mut present = self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        if present.as_deref() != stage {
            *present = stage.map(str::to_owned);
        }
    }

    /// Calls a function of Python with the stage, or none, steps done and planned, and the time (s).
    fn report(&self, py: Python<'_>, callback: &Py<PyAny>) -> PyResult<()> {
        let stage = self
            .stage
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        let [done, planned, time] =
            [&self.done, &self.planned, &self.time].map(|value| value.load(Ordering::Relaxed));
        callback.call1(py, (stage, done, planned, f64::from_bits(time)))?;
        Ok(())
    }
}

/// What ended a run without results.
pub(crate) enum End {
    /// An error before the first step, or of files.
    Failure(Box<Failure>),
    /// A signal while this was computed.
    Interrupted(String),
}

impl From<Failure> for End {
    fn from(failure: Failure) -> Self {
        Self::Failure(Box::new(failure))
    }
}

impl From<Error> for End {
    fn from(error: Error) -> Self {
        Self::Failure(Box::new(error.into()))
    }
}

impl From<StudyError> for End {
    fn from(error: StudyError) -> Self {
        Self::Failure(Box::new(error.into()))
    }
}

/// Results of a run, with the error that ended it early, or that of its files.
pub(crate) struct Ran {
    done: Done,
    error: Option<RunError>,
    unwritten: Option<Failure>,
}

/// Runs a scene on another thread and returns its results.
///
/// # Errors
/// The exception of the scene, of the run with the results until then, of a signal, or of the progress callback.
pub(crate) fn run(py: Python<'_>, order: Order, callback: Option<Py<PyAny>>) -> PyResult<Results> {
    let alarm = Arc::new(Alarm::default());
    let progress = Arc::new(Progress::default());
    let look = |py: Python<'_>| match &callback {
        Some(callback) => progress.report(py, callback),
        None => Ok(()),
    };
    let raise = || alarm.stop.store(true, Ordering::Relaxed);
    let work = || make(&order, &alarm, &progress, None);
    let (outcome, raised) = wait_with(py, work, look, raise);
    let results = finished(py, outcome, alarm.take().or(raised))?;
    if let Some(callback) = &callback {
        progress.report(py, callback)?;
    }
    Ok(results)
}

/// The results of a run that has ended.
///
/// # Errors
/// The exception of the run, with the results until then, or what was `raised` while it went on.
pub(crate) fn finished(
    py: Python<'_>,
    outcome: Result<Ran, End>,
    raised: Option<PyErr>,
) -> PyResult<Results> {
    match outcome {
        Err(End::Failure(failure)) => Err(match raised {
            // A function in Python that raised is why.
            Some(error) if !error.is_instance_of::<PyKeyboardInterrupt>(py) => error,
            _ => failure.exception(py),
        }),
        Err(End::Interrupted(what)) => {
            let message = format!("interrupted in {what}");
            Err(match raised {
                Some(error) if !error.is_instance_of::<PyKeyboardInterrupt>(py) => error,
                _ => with(
                    py,
                    exception(py, "Interrupted", &message),
                    "results",
                    py.None(),
                ),
            })
        }
        Ok(Ran {
            done,
            error,
            unwritten,
        }) => {
            let time = done.results.run.time;
            let results = Results::new(py, done)?;
            if let Some(error) = error.filter(|_| raised.is_none()) {
                let failed = exception(py, "RunError", &error.to_string());
                let failed = match unwritten {
                    Some(failure) => with(py, failed, "unwritten", failure.exception(py)),
                    None => failed,
                };
                return Err(with(py, failed, "results", results));
            }
            if let Some(failure) = unwritten {
                return Err(with(py, failure.exception(py), "results", results));
            }
            match raised {
                Some(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => {
                    let message = format!(
                        "interrupted at t = {time:.6} s; the results until then are complete"
                    );
                    let error = exception(py, "Interrupted", &message);
                    Err(with(py, error, "results", results))
                }
                Some(error) => Err(with(py, error, "results", results)),
                None => Ok(results),
            }
        }
    }
}

/// Sink of stages that counts for the thread that waits, and forwards to the writer of files, if there is one.
struct Stages {
    files: Option<Box<dyn StageSink>>,
    progress: Arc<Progress>,
}

impl StageSink for Stages {
    fn progress(&mut self, stage: &str, progress: StaticProgress) {
        self.progress.set_stage(Some(stage));
        if let Some(files) = &mut self.files {
            files.progress(stage, progress);
        }
    }
    fn completed(&mut self, stage: &CompletedStage) -> Result<(), Error> {
        self.progress.set_stage(None);
        match &mut self.files {
            Some(files) => files.completed(stage),
            None => Ok(()),
        }
    }
}

/// Composes, checks and runs the scene, with one more observer, and writes its results.
pub(crate) fn make(
    order: &Order,
    alarm: &Arc<Alarm>,
    progress: &Arc<Progress>,
    observer: Option<Box<dyn Observer>>,
) -> Result<Ran, End> {
    let stop = &alarm.stop;
    if let Some(folder) = &order.folder {
        order.source.keep_file(folder)?;
    }
    let mut scene = order.source.compose(alarm)?;
    if let Some(threads) = order.threads {
        scene = scene.with_threads(threads);
    }
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
    // Without a file there is nothing from which the command could resume the run.
    let checkpoints = (order.folder.as_ref())
        .filter(|_| order.source.is_file)
        .map(|folder| folder::checkpoints(&scene, (folder, order.checkpoint_every)));
    let mut simulation = scene.prepare()?;
    let step = simulation.step()?;
    let open = match &order.folder {
        None => None,
        Some(path) => {
            let simulation = (&simulation, size.bytes(step));
            Some(Open::lock(path, simulation, checkpoints)?)
        }
    };
    if let (Some(free_field), Some(limit)) = (free_field, limit) {
        let hooks = RunHooks::default().with_stop(stop.clone());
        match free_field.run(step, hooks) {
            Ok(found) => found.require(limit)?,
            Err(StudyError::Interrupted) => {
                return Err(End::Interrupted("the free-field check".into()));
            }
            Err(error) => return Err(error.into()),
        }
    }
    let (title, mesh) = (simulation.title().to_owned(), simulation.mesh().clone());
    let remarks = simulation.remarks().to_vec();
    let warnings = warnings.iter().map(Warning::message).collect();
    let notes = RunNotes::new(remarks).with_warnings(warnings);
    let counted = progress.clone();
    let hooks = RunHooks::default()
        .with_stop(stop.clone())
        .with_progress(move |now| {
            counted.done.store(now.done, Ordering::Relaxed);
            counted.planned.store(now.planned, Ordering::Relaxed);
            counted.time.store(now.time.to_bits(), Ordering::Relaxed);
        });
    let shots: Arc<Mutex<Vec<Shot>>> = Arc::default();
    let stages = |files| -> Box<dyn StageSink> {
        let progress = progress.clone();
        Box::new(Stages { files, progress })
    };
    let hooks = match &open {
        Some(open) => {
            open.begin(&title)?;
            open.hooks(hooks, &simulation, |files| stages(Some(files)))?
        }
        None => {
            let kept = shots.clone();
            let keep = move |shot: &Snapshot| {
                let mut shots = kept.lock().unwrap_or_else(PoisonError::into_inner);
                shots.push(Shot::of(shot));
                Ok(())
            };
            hooks
                .with_snapshots(Box::new(keep))
                .with_stages(stages(None))
        }
    };
    let mut hooks = hooks;
    hooks.observers.extend(observer);
    let outcome = simulation.run(hooks);
    let lost = open.as_ref().and_then(Open::settle);
    let (results, error) = match outcome {
        Ok(results) => (results, None),
        Err(Error::Failed { error, results }) => (*results, Some(error)),
        Err(Error::Interrupted { stage }) => {
            return Err(End::Interrupted(format!("the stage '{stage}'")));
        }
        Err(error) => return Err(error.into()),
    };
    let mut done = Done {
        title,
        mesh,
        results,
        notes,
        lost,
        folder: order.folder.clone(),
        files: Vec::new(),
        shots: core::mem::take(&mut *shots.lock().unwrap_or_else(PoisonError::into_inner)),
    };
    let mut unwritten = None;
    if let Some(open) = open {
        let is_complete = error.is_none() && done.results.run.ended != Ended::Stopped;
        let body = (done.title.as_str(), &*done.mesh);
        let text = (text.as_deref(), is_complete);
        match open.write(body, (&done.results, &done.notes), text) {
            Ok(files) => done.files = files,
            Err(failure) => unwritten = Some(failure),
        }
    }
    Ok(Ran {
        done,
        error,
        unwritten,
    })
}
