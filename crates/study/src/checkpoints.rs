//! Checkpoints in the results folder of a run, from which one that was interrupted or killed goes on.

use core::fmt;
use std::path::Path;
use std::sync::Arc;

use powerhouse::engine::SavedRun;
use powerhouse::model::StateError;
use powerhouse::{
    CheckpointError, CheckpointFiles, CheckpointInterval, CheckpointWriter, EquilibratedBody,
    Error, FileScene, KeptState, Remark, ResumedRun, RunInputs, StageSolution,
};

use crate::StudyError;
use crate::text::start_of;

/// Use of the checkpoint of a run, for progress output; its text is a sentence without a full stop.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum CheckpointEvent<'a> {
    /// The run goes on from a checkpoint.
    Resumed(&'a ResumedRun),
    /// A checkpoint is damaged or of other inputs, for the reason given: the run goes on from an older one or begins anew.
    Unused(&'a str),
    /// A checkpoint could not be written, for the reason given: the run goes on, and the last one that was written remains.
    Unwritten(&'a str),
    /// The run starts from a state that another run has kept, or goes on from a run that did.
    Origin(&'a Remark),
    /// A new run removes the checkpoint of another run, of other inputs, from its folder.
    Removed {
        /// Path of the folder.
        folder: &'a Path,
        /// The checkpoint.
        of: &'a ResumedRun,
    },
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
            Self::Origin(remark) => write!(f, "{remark}"),
            Self::Removed { folder, of } => write!(
                f,
                "warning: the checkpoint of another run in {}, which would go on {}, is removed: its scene or files differ",
                folder.display(),
                start_of(of)
            ),
        }
    }
}

/// Whether an error is that of a saved state that does not fit the body.
pub(crate) fn is_of_state(error: &StudyError) -> bool {
    let first: &(dyn std::error::Error + 'static) = error;
    core::iter::successors(Some(first), |error| error.source())
        .any(|error| error.is::<StateError>())
}

/// State from which a run begins.
#[derive(Debug)]
pub(crate) enum RunStart {
    /// That of its scene.
    Scene,
    /// The last checkpoint of the same run.
    Checkpoint(ResumedRun),
    /// A state that another run has kept.
    Kept(KeptState),
}

impl RunStart {
    /// The last checkpoint in a folder of a run with these inputs, or the scene, and the reasons for which checkpoints are
    /// not used.
    pub(crate) fn last(files: &CheckpointFiles, inputs: &RunInputs) -> (Self, Vec<String>) {
        let found = files.read().and_then(|found| {
            files.check(&found.inputs, inputs)?;
            Ok(found)
        });
        match found {
            Ok(mut found) => {
                let unused = core::mem::take(&mut found.unused);
                (Self::Checkpoint(found), unused)
            }
            Err(CheckpointError::None { .. }) => (Self::Scene, Vec::new()),
            Err(error) => (Self::Scene, vec![error.to_string()]),
        }
    }

    /// State of the dynamic run; none if it has not begun.
    pub(crate) fn run(&self) -> Option<&SavedRun> {
        match self {
            Self::Scene => None,
            Self::Checkpoint(resumed) => resumed.run.as_ref(),
            Self::Kept(kept) => Some(&kept.run),
        }
    }
}

/// What a run goes on from.
#[derive(Default)]
pub(crate) struct SavedParts {
    /// The body after the stages that were completed.
    pub(crate) body: Option<EquilibratedBody>,
    /// State of the static solution of a stage.
    pub(crate) solution: Option<StageSolution>,
    /// State of the dynamic run.
    pub(crate) run: Option<Arc<SavedRun>>,
}

/// Checkpoints in the results folder of a run.
pub(crate) struct RunCheckpoints {
    files: CheckpointFiles,
    start: RunStart,
    /// Reasons for which checkpoints are not used.
    unused: Vec<String>,
    writer: Arc<CheckpointWriter>,
}

impl RunCheckpoints {
    /// Those of a scene's run with inputs, from its start. New ones are written at an interval of wall time, in place of the
    /// scene's; states that the scene wants to keep are, if it `keeps` them.
    pub(crate) fn new(
        files: CheckpointFiles,
        (scene, inputs): (&FileScene, RunInputs),
        (start, unused): (RunStart, Vec<String>),
        (interval, keeps): (Option<CheckpointInterval>, bool),
    ) -> Self {
        let interval = interval.or(scene.checkpoints().every);
        let interval = interval.unwrap_or(CheckpointInterval::DEFAULT).duration();
        let after = if keeps {
            start.run().map(|run| run.time)
        } else {
            Some(f64::INFINITY)
        };
        Self {
            writer: CheckpointWriter::new(
                scene,
                (files.clone(), inputs),
                interval,
                &scene.checkpoints().keep,
                after,
            ),
            files,
            start,
            unused,
        }
    }

    /// Whether the run goes on from a checkpoint of its own.
    pub(crate) fn is_resumed(&self) -> bool {
        matches!(self.start, RunStart::Checkpoint(_))
    }
    /// Length of a step (s) of the dynamic run from whose state this one goes on.
    pub(crate) fn step(&self) -> Option<f64> {
        self.start.run().map(|run| run.step)
    }
    /// What the run goes on from, in words that differ if it does.
    pub(crate) fn description(&self) -> String {
        let run = self.start.run();
        let run = run.map(|run| (run.done, run.step.to_bits(), run.time.to_bits()));
        let body = match &self.start {
            RunStart::Scene => None,
            RunStart::Checkpoint(resumed) => resumed.body.as_ref(),
            RunStart::Kept(kept) => kept.body.as_ref(),
        };
        format!("{run:?} {:?}", body.map(|body| body.stages().len()))
    }
    /// Reports from where the run goes on, and which checkpoints are not used.
    pub(crate) fn report(&self, mut event: impl FnMut(CheckpointEvent)) {
        let unused = self.unused.iter();
        unused.for_each(|reason| event(CheckpointEvent::Unused(reason)));
        if let RunStart::Checkpoint(resumed) = &self.start {
            event(CheckpointEvent::Resumed(resumed));
        }
    }
    /// Takes what the run goes on from.
    pub(crate) fn take(&mut self) -> SavedParts {
        match core::mem::replace(&mut self.start, RunStart::Scene) {
            RunStart::Scene => SavedParts::default(),
            RunStart::Checkpoint(resumed) => SavedParts {
                body: resumed.body,
                solution: resumed.solution,
                run: resumed.run.map(Arc::new),
            },
            RunStart::Kept(kept) => SavedParts {
                body: kept.body,
                solution: None,
                run: Some(Arc::new(kept.run)),
            },
        }
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
    /// Refuses a new run of inputs in a folder with a checkpoint that cannot be read, or from which a run of the same inputs
    /// goes on; reports one of other inputs, which will be removed.
    ///
    /// # Errors
    /// [`StudyError::Unfinished`], [`StudyError::UnreadableCheckpoint`].
    pub(crate) fn refuse_resumable(
        &self,
        (folder, inputs): (&Path, &RunInputs),
        mut event: impl FnMut(CheckpointEvent),
    ) -> Result<(), StudyError> {
        let found = match self.files.read() {
            Ok(found) => found,
            Err(CheckpointError::None { .. }) => return Ok(()),
            Err(source) => {
                let (folder, source) = (folder.into(), Box::new(source));
                return Err(StudyError::UnreadableCheckpoint { folder, source });
            }
        };
        let is_same = found.inputs.origin == inputs.origin;
        if is_same && self.files.check(&found.inputs, inputs).is_ok() {
            let (folder, start) = (folder.into(), start_of(&found));
            return Err(StudyError::Unfinished { folder, start });
        }
        event(CheckpointEvent::Removed { folder, of: &found });
        Ok(())
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
