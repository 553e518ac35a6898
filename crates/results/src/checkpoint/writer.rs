//! Writing of checkpoints beside the computation.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use powerhouse_model::{CheckpointSink, ModelError, Progress, SavedRun};

use super::incident::IncidentMotion;
use super::{CheckpointFiles, RunInputs};
use powerhouse_scene::{
    CheckpointError, EquilibratedBody, Scene, StageCheckpointSink, StageSolution,
};

/// Writer of checkpoints: at an interval of wall time, when the run is interrupted, and at the times whose states the scene
/// keeps. A file that cannot be written does not end the run: the last failure is kept.
///
/// The run waits while its state is copied; the files are written by another thread.
#[derive(Debug)]
pub struct CheckpointWriter {
    files: CheckpointFiles,
    inputs: RunInputs,
    every: Duration,
    incident: Arc<IncidentMotion>,
    progress: Mutex<Written>,
}

#[derive(Debug)]
struct Written {
    /// Time of the last state.
    last: Instant,
    /// Times of the motion (s) whose states are still to be kept, the next one last.
    keep: Vec<f64>,
    /// The thread that writes it.
    thread: Option<JoinHandle<Result<(), CheckpointError>>>,
    failure: Option<String>,
}

impl Written {
    /// Waits until the last state is on the disk.
    fn settle(&mut self) {
        let Some(thread) = self.thread.take() else {
            return;
        };
        match thread.join() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => self.failure = Some(error.to_string()),
            Err(_) => self.failure = Some("the thread that wrote a checkpoint panicked".into()),
        }
    }

    /// The last time to be kept that a motion has reached, which is no longer to be kept, as are those before.
    fn reached(&mut self, time: f64) -> Option<f64> {
        let mut found = None;
        while let Some(next) = self.keep.pop_if(|next| *next <= time) {
            found = Some(next);
        }
        found
    }
}

impl CheckpointWriter {
    /// A writer of the checkpoints of a run of a scene with some inputs, at an interval of wall time that begins now, which
    /// keeps the states at times (s) in rising order. A run that is resumed begins `after` the time (s) of its state, and
    /// keeps no state until then.
    pub fn new(
        scene: &Scene,
        (files, inputs): (CheckpointFiles, RunInputs),
        every: Duration,
        keep: &[f64],
        after: Option<f64>,
    ) -> Arc<Self> {
        let keep = keep.iter().rev().copied();
        let is_ahead = |time: &f64| after.is_none_or(|after| *time > after);
        Arc::new(Self {
            files,
            inputs,
            every,
            incident: Arc::new(IncidentMotion::of(scene)),
            progress: Mutex::new(Written {
                last: Instant::now(),
                keep: keep.filter(is_ahead).collect(),
                thread: None,
                failure: None,
            }),
        })
    }

    fn progress(&self) -> MutexGuard<'_, Written> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes the body at the end of a stage.
    pub fn keep_stage(&self, body: &EquilibratedBody) {
        self.progress().settle();
        if let Err(error) = self.files.write_body(&self.inputs, body) {
            self.progress().failure = Some(error.to_string());
        }
    }

    /// Waits until the last state is on the disk; returns the last failure, if any.
    pub fn finish(&self) -> Option<String> {
        let mut progress = self.progress();
        progress.settle();
        progress.failure.clone()
    }
}

impl StageCheckpointSink for CheckpointWriter {
    fn is_due(&self, _progress: &Progress) -> bool {
        self.progress().last.elapsed() >= self.every
    }
    fn take(&self, solution: StageSolution) -> Result<(), ModelError> {
        let mut progress = self.progress();
        progress.settle();
        let (files, inputs) = (self.files.clone(), self.inputs.clone());
        progress.thread = Some(std::thread::spawn(move || {
            files.write_solution(&inputs, &solution)
        }));
        progress.last = Instant::now();
        Ok(())
    }
}

impl CheckpointSink for CheckpointWriter {
    fn is_due(&self, now: &Progress) -> bool {
        let progress = self.progress();
        let next = progress.keep.last();
        next.is_some_and(|next| *next <= now.time) || progress.last.elapsed() >= self.every
    }
    fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
        let mut progress = self.progress();
        progress.settle();
        let kept = progress.reached(saved.time);
        let (files, inputs) = (self.files.clone(), self.inputs.clone());
        let incident = self.incident.clone();
        progress.thread = Some(std::thread::spawn(move || match kept {
            Some(time) => files.write_kept(time, &inputs, &incident, &saved),
            None => files.write_run(&inputs, &saved),
        }));
        if kept.is_none() {
            progress.last = Instant::now();
        }
        Ok(())
    }
}
