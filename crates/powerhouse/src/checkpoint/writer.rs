//! Writing of checkpoints beside the computation.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use powerhouse_model::{CheckpointSink, ModelError, Progress, SavedRun};

use super::{CheckpointError, CheckpointFiles, RunInputs};
use crate::EquilibratedBody;

/// Writer of checkpoints: at an interval of wall time, and when the run is interrupted. A file that cannot be written does
/// not end the run: the last failure is kept.
///
/// The run waits while its state is copied; the files are written by another thread.
#[derive(Debug)]
pub struct CheckpointWriter {
    files: CheckpointFiles,
    inputs: RunInputs,
    every: Duration,
    progress: Mutex<Written>,
}

#[derive(Debug)]
struct Written {
    /// Time of the last state.
    last: Instant,
    /// The thread that writes it.
    thread: Option<JoinHandle<Result<(), CheckpointError>>>,
    failure: Option<String>,
    count: u64,
}

impl Written {
    /// Waits until the last state is on the disk.
    fn settle(&mut self) {
        let Some(thread) = self.thread.take() else {
            return;
        };
        match thread.join() {
            Ok(Ok(())) => self.count += 1,
            Ok(Err(error)) => self.failure = Some(error.to_string()),
            Err(_) => self.failure = Some("the thread that wrote a checkpoint panicked".into()),
        }
    }
}

impl CheckpointWriter {
    /// A writer of the checkpoints of a run with these inputs, at an interval of wall time that begins now.
    pub fn new(files: CheckpointFiles, inputs: RunInputs, every: Duration) -> Arc<Self> {
        Arc::new(Self {
            files,
            inputs,
            every,
            progress: Mutex::new(Written {
                last: Instant::now(),
                thread: None,
                failure: None,
                count: 0,
            }),
        })
    }

    fn progress(&self) -> MutexGuard<'_, Written> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes the body at the end of a stage.
    pub fn keep_stage(&self, body: &EquilibratedBody) {
        if let Err(error) = self.files.write_body(&self.inputs, body) {
            self.progress().failure = Some(error.to_string());
        }
    }

    /// Waits until the last state is on the disk; returns the number of states of the dynamic run that were written, and
    /// the last failure.
    pub fn finish(&self) -> (u64, Option<String>) {
        let mut progress = self.progress();
        progress.settle();
        (progress.count, progress.failure.clone())
    }
}

impl CheckpointSink for CheckpointWriter {
    fn is_due(&self, _progress: &Progress) -> bool {
        self.progress().last.elapsed() >= self.every
    }
    fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
        let mut progress = self.progress();
        progress.settle();
        let (files, inputs) = (self.files.clone(), self.inputs.clone());
        progress.thread = Some(std::thread::spawn(move || files.write_run(&inputs, &saved)));
        progress.last = Instant::now();
        Ok(())
    }
}
