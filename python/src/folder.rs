//! The results folder of a run, as the command `powerhouse run` uses it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use powerhouse::model::Mesh;
use powerhouse::{
    CheckpointFiles, CheckpointInterval, CheckpointWriter, Error, FolderLock, ResultFolder,
    Results, RunHooks, RunInputs, RunNotes, Scene, Simulation, StageSink,
};

use crate::fault::Failure;

/// A results folder that is locked for one run.
pub(crate) struct Open {
    folder: ResultFolder,
    files: CheckpointFiles,
    checkpoints: Option<Arc<CheckpointWriter>>,
    lock: FolderLock,
}

/// Reads an interval of checkpoints, such as `10min` or `never`.
pub(crate) fn interval(text: Option<&str>) -> Result<Option<CheckpointInterval>, String> {
    let read = text.map(|text| text.parse::<CheckpointInterval>());
    read.transpose().map_err(|error| error.to_string())
}

/// The writer of checkpoints of a scene whose run can be resumed, and its files.
pub(crate) fn checkpoints(
    scene: &Scene,
    (folder, every): (&Path, Option<CheckpointInterval>),
) -> Arc<CheckpointWriter> {
    let every = every.or(scene.checkpoints().every);
    let every = every.unwrap_or(CheckpointInterval::DEFAULT).duration();
    let kept = (CheckpointFiles::of(folder), RunInputs::of(scene));
    CheckpointWriter::new(scene, kept, every, None)
}

impl Open {
    /// Locks the folder, removes what an earlier run left unfinished, and proves that the files of a simulation, with a
    /// size (bytes), can be written.
    pub(crate) fn lock(
        path: &Path,
        (simulation, size): (&Simulation, u64),
        checkpoints: Option<Arc<CheckpointWriter>>,
    ) -> Result<Self, Error> {
        let folder = ResultFolder::new(path);
        let lock = folder.lock()?;
        folder.remove_unfinished()?;
        folder.prove(simulation, size)?;
        Ok(Self {
            files: CheckpointFiles::of(path),
            folder,
            checkpoints,
            lock,
        })
    }

    /// Removes the results of an earlier run and begins those of this one.
    pub(crate) fn begin(&self, title: &str) -> Result<(), Error> {
        self.folder.clear()?;
        self.files.clear()?;
        self.folder.begin(title)
    }

    /// Adds all that is written during the run.
    pub(crate) fn hooks<'a>(
        &self,
        hooks: RunHooks<'a>,
        simulation: &Simulation,
        stages: impl FnOnce(Box<dyn StageSink>) -> Box<dyn StageSink>,
    ) -> Result<RunHooks<'a>, Error> {
        let hooks = hooks
            .with_tables(self.folder.tables())
            .with_snapshots(self.folder.snapshots(simulation)?)
            .with_stages(stages(self.folder.stages(simulation)?));
        Ok(match &self.checkpoints {
            None => hooks,
            Some(checkpoints) => {
                let keep = checkpoints.clone();
                hooks
                    .with_checkpoints(checkpoints.clone())
                    .with_stage_checkpoints(checkpoints.clone())
                    .with_stage_hook(move |body| keep.keep_stage(body))
            }
        })
    }

    /// Waits for the last checkpoint; returns what was lost of it, if anything.
    pub(crate) fn settle(&self) -> Option<String> {
        self.checkpoints.as_ref()?.finish()
    }

    /// Writes the results; the checkpoint of a complete run is removed.
    pub(crate) fn write(
        self,
        (title, mesh): (&str, &Mesh),
        (results, notes): (&Results, &RunNotes),
        (text, is_complete): (Option<&str>, bool),
    ) -> Result<Vec<PathBuf>, Failure> {
        let is_held = self.lock.is_held();
        let written = self.folder.write((title, mesh), results, notes, text)?;
        if !is_held {
            self.lock.release()?;
        }
        if is_complete {
            self.files.remove().map_err(Error::from)?;
        }
        Ok(written)
    }
}
