//! Checkpoints of the runs of a study, from which a study that was interrupted or killed goes on inside a run.

use core::fmt;
use std::path::Path;
use std::sync::Arc;

use powerhouse::engine::SavedRun;
use powerhouse::model::StateError;
use powerhouse::{
    CheckpointError, CheckpointFiles, CheckpointInterval, CheckpointWriter, EquilibratedBody,
    Error, ResumedRun, RunInputs, Scene, StageSolution,
};

use crate::StudyError;

/// Use of the checkpoint of a run of a study, for progress output; its text is a sentence without a full stop.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum CheckpointEvent<'a> {
    /// The run goes on from a checkpoint.
    Resumed(&'a ResumedRun),
    /// A checkpoint is damaged or of other inputs, for the reason given: the run goes on from an older one or begins anew.
    Unused(&'a str),
    /// A checkpoint could not be written, for the reason given: the run goes on, and the last one that was written remains.
    Unwritten(&'a str),
}

impl fmt::Display for CheckpointEvent<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Resumed(resumed) => match (&resumed.run, &resumed.body) {
                (Some(run), _) => {
                    let (done, time) = (run.done, run.time);
                    write!(f, "resumed after {done} steps, at t = {time:.6} s")
                }
                _ if resumed.solution.is_some() => {
                    f.write_str("resumed within the solution of a stage")
                }
                (None, Some(body)) => {
                    let last = body.stages().last().map_or("", |stage| stage.name.as_str());
                    write!(f, "resumed after the stage '{last}'")
                }
                (None, None) => f.write_str("resumed before its first step"),
            },
            Self::Unused(reason) => write!(f, "warning: a checkpoint is not used: {reason}"),
            Self::Unwritten(reason) => {
                write!(f, "warning: a checkpoint could not be written: {reason}")
            }
        }
    }
}

/// Whether an error is that of a saved state that does not fit the body.
pub(crate) fn is_of_state(error: &StudyError) -> bool {
    let first: &(dyn std::error::Error + 'static) = error;
    core::iter::successors(Some(first), |error| error.source())
        .any(|error| error.is::<StateError>())
}

/// Checkpoints in the results folder of a run of a study.
pub(crate) struct RunCheckpoints {
    files: CheckpointFiles,
    /// State from which the run goes on; its parts are taken one by one.
    resumed: Option<ResumedRun>,
    /// Reasons for which checkpoints are not used.
    unused: Vec<String>,
    writer: Arc<CheckpointWriter>,
}

impl RunCheckpoints {
    /// Reads the checkpoint of a scene's run from its results folder; one that is damaged or of other inputs is not used.
    /// New ones are written at an interval of wall time, in place of the scene's; states that the scene wants to keep are,
    /// if it `keeps` them.
    pub(crate) fn open(
        folder: &Path,
        scene: &Scene,
        interval: Option<CheckpointInterval>,
        keeps: bool,
    ) -> Self {
        let interval = interval.or(scene.checkpoints().every);
        let interval = interval.unwrap_or(CheckpointInterval::DEFAULT).duration();
        let files = CheckpointFiles::of(folder);
        let inputs = RunInputs::of(scene);
        let found = files.read().and_then(|found| {
            files.check(&found.inputs, &inputs)?;
            Ok(found)
        });
        let (resumed, unused) = match found {
            Ok(mut found) => {
                let unused = core::mem::take(&mut found.unused);
                (Some(found), unused)
            }
            Err(CheckpointError::None { .. }) => (None, Vec::new()),
            Err(error) => (None, vec![error.to_string()]),
        };
        let run = resumed.as_ref().and_then(|resumed| resumed.run.as_ref());
        let after = match keeps {
            true => run.map(|run| run.time),
            false => Some(f64::INFINITY),
        };
        Self {
            writer: CheckpointWriter::new(scene, (files.clone(), inputs), interval, after),
            files,
            resumed,
            unused,
        }
    }

    /// Whether the run goes on from a checkpoint.
    pub(crate) fn is_resumed(&self) -> bool {
        self.resumed.is_some()
    }
    /// Length of a step (s) of the dynamic run that is resumed; none if it has not begun.
    pub(crate) fn step(&self) -> Option<f64> {
        Some(self.resumed.as_ref()?.run.as_ref()?.step)
    }
    /// What the run goes on from, in words that differ if it does.
    pub(crate) fn description(&self) -> String {
        let resumed = self.resumed.as_ref();
        let run = resumed.and_then(|resumed| resumed.run.as_ref());
        let run = run.map(|run| (run.done, run.step.to_bits(), run.time.to_bits()));
        let body = resumed.and_then(|resumed| resumed.body.as_ref());
        format!("{run:?} {:?}", body.map(|body| body.stages().len()))
    }
    /// Reports from where the run goes on, and which checkpoints are not used.
    pub(crate) fn report(&self, mut event: impl FnMut(CheckpointEvent)) {
        let unused = self.unused.iter();
        unused.for_each(|reason| event(CheckpointEvent::Unused(reason)));
        if let Some(resumed) = &self.resumed {
            event(CheckpointEvent::Resumed(resumed));
        }
    }

    /// Takes the body after the stages that were completed.
    pub(crate) fn take_body(&mut self) -> Option<EquilibratedBody> {
        self.resumed.as_mut()?.body.take()
    }
    /// Takes the state of the static solution of a stage.
    pub(crate) fn take_solution(&mut self) -> Option<StageSolution> {
        self.resumed.as_mut()?.solution.take()
    }
    /// Takes the state of the dynamic run.
    pub(crate) fn take_run(&mut self) -> Option<Arc<SavedRun>> {
        Some(Arc::new(self.resumed.as_mut()?.run.take()?))
    }

    /// The writer of the checkpoints of this run.
    pub(crate) fn writer(&self) -> &Arc<CheckpointWriter> {
        &self.writer
    }
    /// Waits until the last checkpoint is on the disk, and reports one that could not be written.
    pub(crate) fn finish(&self, mut event: impl FnMut(CheckpointEvent)) {
        if let Some(reason) = self.writer.finish() {
            event(CheckpointEvent::Unwritten(&reason));
        }
    }
    /// Removes all checkpoints and states that were kept, as before a new run.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub(crate) fn clear(&self) -> Result<(), StudyError> {
        Ok(self.files.clear().map_err(Error::from)?)
    }
    /// Removes the checkpoints, such as when the run is finished.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub(crate) fn remove(&self) -> Result<(), StudyError> {
        Ok(self.files.remove().map_err(Error::from)?)
    }
}
