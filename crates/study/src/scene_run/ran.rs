//! What a run has left.

use std::path::PathBuf;
use std::sync::Arc;

use powerhouse::engine::Ended;
use powerhouse::model::{Mesh, RunError};
use powerhouse::{Error, FolderError, FolderLock, ResultFolder, Results, RunNotes};

use crate::StudyError;
use crate::checkpoints::RunCheckpoints;

/// Results of a run in memory, which can be written to its folder.
///
/// The folder is locked until it is dropped.
#[non_exhaustive]
pub struct RanScene {
    /// Title of the results.
    pub title: String,
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// The results, until the failure of a run that failed; on ranks other than 0 those of their part.
    pub results: Results,
    /// Remarks and warnings.
    pub notes: RunNotes,
    /// What ended the run before its time.
    pub failure: Option<RunError>,
    /// The folder; none for results in memory.
    pub(super) written: Option<Written>,
}

/// Where results are written.
pub(super) struct Written {
    pub(super) folder: ResultFolder,
    pub(super) checkpoints: RunCheckpoints,
    pub(super) lock: Option<Arc<FolderLock>>,
    /// Text of the scene.
    pub(super) text: Option<String>,
}

impl RanScene {
    /// Writes the results and returns the paths of all files; none of a run in memory or on a rank other than 0.
    ///
    /// # Errors
    /// First file that could not be written.
    pub fn write(&self) -> Result<Vec<PathBuf>, StudyError> {
        let Some(Written { folder, text, .. }) = &self.written else {
            return Ok(Vec::new());
        };
        let body = (self.title.as_str(), &*self.mesh);
        Ok(folder.write(body, &self.results, &self.notes, text.as_deref())?)
    }

    /// Removes the checkpoints of a complete run, whose results are written.
    ///
    /// # Errors
    /// [`FolderError::Gone`] if the folder was lost during the run; a file that cannot be removed.
    pub fn close(&self) -> Result<(), StudyError> {
        self.require_folder()?;
        let is_complete = self.failure.is_none() && self.results.run.ended != Ended::Stopped;
        if is_complete {
            self.remove_checkpoints()
        } else {
            Ok(())
        }
    }

    /// Checks that the folder is still that of this run.
    ///
    /// # Errors
    /// [`FolderError::Gone`].
    pub(crate) fn require_folder(&self) -> Result<(), StudyError> {
        match &self.written {
            Some(Written { folder, lock, .. })
                if !lock.as_ref().is_some_and(|lock| lock.is_held()) =>
            {
                let folder = folder.path().to_path_buf();
                Err(Error::from(FolderError::Gone { folder }).into())
            }
            _ => Ok(()),
        }
    }

    /// Removes the checkpoints.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub(crate) fn remove_checkpoints(&self) -> Result<(), StudyError> {
        match &self.written {
            Some(written) => written.checkpoints.remove(),
            None => Ok(()),
        }
    }
}
