//! What a run reports.

use powerhouse::{Error, Message, ProgressHook, RunNotes, Simulation, StageSink};

use crate::{CheckpointEvent, FreeFieldReport, StudyError};

/// Callbacks of a run of a scene, in the order in which they are called; by default none does anything.
///
/// Of several ranks each calls those of its own, but for [`checked`](Self::checked), [`begins`](Self::begins) and those of
/// the folder, which are called on rank 0 alone.
/// `()` is the one that does nothing.
pub trait RunWatch {
    /// Called when the model is built and its step is known, before the folder is touched, with the warnings about the scene;
    /// not for a run that is resumed in its motion.
    ///
    /// # Errors
    /// An error ends the run.
    fn composed(
        &mut self,
        _simulation: &mut Simulation,
        _warnings: &[Message],
    ) -> Result<(), Error> {
        Ok(())
    }
    /// Called when the run goes on from a checkpoint, or one is removed, or cannot be used or written.
    fn checkpoint(&mut self, _event: CheckpointEvent) {}
    /// Called with a remark on the lock of the folder, if there is one.
    fn locked(&mut self, _remark: &str) {}
    /// Returns the progress hook of the free-field check, before it is made; `None`, the default, for no progress.
    fn checks(&mut self) -> Option<ProgressHook<'static>> {
        None
    }
    /// Called after the free-field check, also if its error is above the limit.
    fn checked(&mut self, _found: Result<&FreeFieldReport, &StudyError>) {}
    /// Called when nothing is left that could refuse the run, before the results of an earlier one are removed.
    ///
    /// # Errors
    /// An error ends the run; [`StudyError::Interrupted`] as one that was interrupted before it began.
    fn begins(&mut self, _notes: &RunNotes) -> Result<(), StudyError> {
        Ok(())
    }
    /// Returns the sink for the stages that are computed; it must forward to `files`, which writes their results if there is
    /// a folder, and is returned by default.
    fn stages(&mut self, files: Option<Box<dyn StageSink>>) -> Option<Box<dyn StageSink>> {
        files
    }
    /// Returns the progress hook of the time steps; `None`, the default, for no progress.
    fn progress(&mut self) -> Option<ProgressHook<'static>> {
        None
    }
    /// Called after the last stage or step, whether it failed or not.
    fn ended(&mut self) {}
    /// Called if the run failed before its motion, with the number of stages that were completed and that of all.
    fn failed_in_stages(&mut self, _completed: usize, _of: usize) {}
}

impl RunWatch for () {}
