//! Ranks that compute a run together: what may fail on one of them alone comes before a point at which all agree on
//! whether it has.

use std::sync::Arc;

use powerhouse::engine::ExplicitOnRanks;
use powerhouse::io::file_checksum;
use powerhouse::model::{Checksum, ModelError, RankError};
use powerhouse::{Error, FileScene, RunInputs};

use crate::StudyError;

/// The ranks that compute a run together; none for one process.
#[derive(Clone, Default)]
pub(crate) struct RunRanks(pub(crate) Option<Arc<ExplicitOnRanks>>);

fn failed(failure: RankError) -> StudyError {
    Error::from(ModelError::refused("ranks", failure)).into()
}

impl RunRanks {
    /// Whether this process writes the results.
    pub(crate) fn leads(&self) -> bool {
        self.0.as_ref().is_none_or(|engine| engine.rank() == 0)
    }

    /// Number of processes.
    pub(crate) fn count(&self) -> usize {
        self.0.as_ref().map_or(1, |engine| engine.rank_count())
    }

    /// Refuses what one rank alone can compute, if it is used.
    ///
    /// # Errors
    /// [`StudyError::OneRankOnly`].
    pub(crate) fn refuse(&self, used: &[(&'static str, bool)]) -> Result<(), StudyError> {
        match used.iter().find(|(_, used)| *used) {
            Some(&(what, _)) if self.count() > 1 => {
                let ranks = self.count();
                Err(StudyError::OneRankOnly { what, ranks })
            }
            _ => Ok(()),
        }
    }

    /// The scene on the engine of this rank, after a check that all have the same one.
    ///
    /// # Errors
    /// Scenes, files that they name, or programs that differ between the ranks.
    pub(crate) fn take(
        &self,
        scene: FileScene,
        inputs: &RunInputs,
    ) -> Result<FileScene, StudyError> {
        let Some(engine) = self.0.as_ref().filter(|_| self.count() > 1) else {
            return Ok(scene);
        };
        let same = |what, value| engine.check_same(what, value).map_err(Error::from);
        same("the scene, or a file that it names,", inputs.checksum())?;
        let program = std::env::current_exe().and_then(|program| file_checksum(&program));
        let program = program.map(|sum| sum.value());
        same("the program", program.unwrap_or_default())?;
        Ok(scene.map(|scene| scene.with_engine(engine.clone())))
    }

    /// Checks that a text is the same on all ranks.
    ///
    /// # Errors
    /// The name of what differs.
    pub(crate) fn check_same(&self, what: &'static str, text: &str) -> Result<(), StudyError> {
        let Some(engine) = &self.0 else {
            return Ok(());
        };
        let sum = Checksum::of(text.as_bytes());
        Ok(engine.check_same(what, sum.value()).map_err(Error::from)?)
    }

    /// A result of this rank, if those of all ranks are sound; the failure of one is that of all.
    pub(crate) fn agree<T>(&self, result: Result<T, StudyError>) -> Result<T, StudyError> {
        let Some(engine) = &self.0 else {
            return result;
        };
        let failure = result.as_ref().err().map(StudyError::to_string);
        let agreed = engine.agree(failure.as_deref());
        let value = result?;
        agreed.map_err(Error::from)?;
        Ok(value)
    }

    /// Whether something is true on all ranks.
    pub(crate) fn all(&self, own: bool) -> Result<bool, StudyError> {
        match &self.0 {
            None => Ok(own),
            Some(engine) => engine.all(own).map_err(failed),
        }
    }

    /// Text of rank 0 on all ranks.
    pub(crate) fn of_first(&self, text: &str) -> Result<String, StudyError> {
        let Some(engine) = &self.0 else {
            return Ok(text.into());
        };
        let bytes = engine.of_first(text.as_bytes().to_vec());
        let bytes = bytes.map_err(failed)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}
