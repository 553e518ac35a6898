//! Runs of scenes, as the command `powerhouse run` makes them.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use powerhouse::engine::StaticProgress;
use powerhouse::engine::observe::Snapshot;
use powerhouse::model::{Observer, RunError};
use powerhouse::{
    CheckpointInterval, CompletedStage, Error, ProgressHook, ResultFolder, StageSink,
};
use powerhouse_study::{CheckpointEvent, RunWatch, SceneRun, StudyError};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::alarm::Alarm;
use crate::fault::{Failure, exception, with};
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
    /// Whether the checkpoint of an interrupted run in the folder is removed.
    pub(crate) restart: bool,
}

/// Reads an interval of checkpoints, such as `10min` or `never`.
pub(crate) fn interval(text: Option<&str>) -> Result<Option<CheckpointInterval>, String> {
    let read = text.map(|text| text.parse::<CheckpointInterval>());
    read.transpose().map_err(|error| error.to_string())
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
        match error {
            StudyError::Interrupted => Self::Interrupted("the free-field check".into()),
            StudyError::Scene(Error::Interrupted { stage }) => {
                Self::Interrupted(format!("the stage '{stage}'"))
            }
            error => Self::Failure(Box::new(error.into())),
        }
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

/// The callbacks of a run, which count for the thread that waits.
struct Counting {
    progress: Arc<Progress>,
    /// What is to be said of checkpoints.
    said: Vec<String>,
}

impl RunWatch for Counting {
    fn checkpoint(&mut self, event: CheckpointEvent) {
        let text = event.to_string();
        let warning = text.strip_prefix("warning: ");
        self.said.extend(warning.map(str::to_owned));
    }
    fn stages(&mut self, files: Option<Box<dyn StageSink>>) -> Option<Box<dyn StageSink>> {
        let progress = self.progress.clone();
        Some(Box::new(Stages { files, progress }))
    }
    fn progress(&mut self) -> Option<ProgressHook<'static>> {
        let counted = self.progress.clone();
        Some(Box::new(move |now| {
            counted.done.store(now.done, Ordering::Relaxed);
            counted.planned.store(now.planned, Ordering::Relaxed);
            counted.time.store(now.time.to_bits(), Ordering::Relaxed);
        }))
    }
}

/// Composes, checks and runs the scene, with one more observer, and writes its results.
pub(crate) fn make(
    order: &Order,
    alarm: &Arc<Alarm>,
    progress: &Arc<Progress>,
    observer: Option<Box<dyn Observer>>,
) -> Result<Ran, End> {
    if let Some(folder) = &order.folder {
        order.source.keep_file(folder)?;
    }
    let scene = order.source.compose(alarm)?;
    let shots: Arc<Mutex<Vec<Shot>>> = Arc::default();
    let mut run = match &order.folder {
        Some(folder) => SceneRun::new(scene, ResultFolder::new(folder)),
        None => {
            let kept = shots.clone();
            let keep = move |shot: &Snapshot| {
                let mut shots = kept.lock().unwrap_or_else(PoisonError::into_inner);
                shots.push(Shot::of(shot));
                Ok(())
            };
            SceneRun::in_memory(scene, Box::new(keep))
        }
    };
    (run.threads, run.restart) = (order.threads, order.restart);
    run.interval = order.checkpoint_every;
    // Without a file there is nothing from which the command could resume the run.
    run.saves = order.source.is_file;
    run.hooks.stop = Some(alarm.stop.clone());
    run.hooks.observers.extend(observer);
    let mut watch = Counting {
        progress: progress.clone(),
        said: Vec::new(),
    };
    let ran = run.run(&mut watch)?;
    let written = ran.write().and_then(|files| ran.close().map(|()| files));
    let (files, unwritten) = match written {
        Ok(files) => (files, None),
        Err(error) => (Vec::new(), Some(error.into())),
    };
    Ok(Ran {
        done: Done {
            title: ran.title,
            mesh: ran.mesh,
            results: ran.results,
            notes: ran.notes,
            of_checkpoints: watch.said,
            folder: order.folder.clone(),
            files,
            shots: core::mem::take(&mut *shots.lock().unwrap_or_else(PoisonError::into_inner)),
        },
        error: ran.failure,
        unwritten,
    })
}
