//! Cases that several ranks compute together.
//!
//! Rank 0 runs the sweep: it claims cases, checks them, and writes their files. The others wait for the name of the next
//! case, build and compute their part of it, and write nothing. What may fail on one rank alone comes before a point at which
//! all agree on whether it has.

use std::sync::Arc;

use powerhouse::engine::ExplicitOnRanks;
use powerhouse::engine::observe::Snapshot;
use powerhouse::model::{Checksum, ModelError, RankError};
use powerhouse::{Error, RunHooks, Scene, Simulation};

use super::at_rest::{self, BodyStore};
use super::case::of_stages;
use super::{CaseControl, Sweep, locked};
use crate::StudyError;
use crate::checkpoints::RunCheckpoints;

/// The ranks that compute each case of a sweep together; none for one process.
#[derive(Clone, Default)]
pub(super) struct CaseRanks(pub(super) Option<Arc<ExplicitOnRanks>>);

fn failed(failure: RankError) -> StudyError {
    Error::from(ModelError::refused("ranks", failure)).into()
}

impl CaseRanks {
    /// Whether this process runs the sweep.
    pub(super) fn leads(&self) -> bool {
        self.0.as_ref().is_none_or(|engine| engine.rank() == 0)
    }

    /// Whether several ranks compute a case.
    pub(super) fn are_several(&self) -> bool {
        self.0
            .as_ref()
            .is_some_and(|engine| engine.rank_count() > 1)
    }

    /// The scene on the engine of this rank.
    ///
    /// # Errors
    /// A scene that keeps states, which one rank alone can.
    pub(super) fn take(&self, scene: Scene) -> Result<Scene, StudyError> {
        match &self.0 {
            Some(engine) if self.are_several() => {
                if !scene.checkpoints().keep.is_empty() {
                    let ranks = engine.rank_count();
                    return Err(StudyError::OneRankOnly {
                        what: "`keep` of `[checkpoint]`",
                        ranks,
                    });
                }
                Ok(scene.with_engine(engine.clone()))
            }
            _ => Ok(scene),
        }
    }

    /// A result of this rank, if those of all ranks are sound; the failure of one is that of all.
    pub(super) fn agree<T>(&self, result: Result<T, StudyError>) -> Result<T, StudyError> {
        let Some(engine) = &self.0 else {
            return result;
        };
        let failure = result.as_ref().err().map(StudyError::to_string);
        let agreed = engine.agree(failure.as_deref());
        let value = result?;
        agreed.map_err(Error::from)?;
        Ok(value)
    }

    /// Text of rank 0 on all ranks.
    fn of_first(&self, text: &str) -> Result<String, StudyError> {
        let Some(engine) = &self.0 else {
            return Ok(text.into());
        };
        let bytes = engine.of_first(text.as_bytes().to_vec());
        let bytes = bytes.map_err(failed)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// Gives the other ranks the name of the case that is computed next; none ends their work.
    pub(super) fn begin(&self, case: Option<&str>) -> Result<(), StudyError> {
        self.of_first(case.unwrap_or_default()).map(|_| ())
    }

    /// Whether rank 0 has found a body in equilibrium, so that the others read its file.
    pub(super) fn is_known(&self, found: bool) -> Result<bool, StudyError> {
        let text = if found { "found" } else { "" };
        Ok(!self.of_first(text)?.is_empty())
    }

    /// Checks that all ranks go on from the same checkpoint.
    pub(super) fn check_same(&self, checkpoints: &RunCheckpoints) -> Result<(), StudyError> {
        let Some(engine) = &self.0 else {
            return Ok(());
        };
        let sum = Checksum::of(checkpoints.description().as_bytes());
        let same = engine.check_same("the checkpoint of the case", sum.value());
        Ok(same.map_err(Error::from)?)
    }
}

impl Sweep {
    /// Computes the part of a rank other than 0 in all cases, until rank 0 ends the sweep.
    pub(super) fn follow(
        &self,
        control: &CaseControl,
        bodies: &BodyStore,
    ) -> Result<(), StudyError> {
        loop {
            let case = self.ranks.of_first("")?;
            if case.is_empty() {
                return Ok(());
            }
            match self.follow_case(&case, control, bodies) {
                // Rank 0 reports the failure of a case, and decides what comes next.
                Ok(()) | Err(StudyError::Scene(_) | StudyError::Interrupted) => {}
                Err(error) => {
                    locked(control.watch).fails(&case, &error);
                }
            }
        }
    }

    fn follow_case(
        &self,
        case: &str,
        control: &CaseControl,
        bodies: &BodyStore,
    ) -> Result<(), StudyError> {
        let opened = self.scene_of(case).and_then(|scene| {
            let folder = self.folder.join(case);
            let interval = self.checkpoint_interval;
            let checkpoints = RunCheckpoints::open(&folder, &scene, interval, true);
            let body = at_rest::key(&scene);
            Ok((self.ranks.take(scene)?, checkpoints, body))
        });
        let (scene, mut checkpoints, body) = self.ranks.agree(opened)?;
        self.ranks.check_same(&checkpoints)?;
        let mut simulation = scene.prepare()?;
        match checkpoints.step() {
            Some(step) => simulation.resume_at(step),
            None => {
                simulation.step()?;
            }
        }
        // Rank 0 makes the free-field check, and opens its files.
        self.ranks.agree(Ok(()))?;
        self.ranks.agree(Ok(()))?;
        // Rank 0 alone is shown and writes snapshots.
        let mut hooks = RunHooks::default().with_snapshots(Box::new(|_: &Snapshot| Ok(())));
        hooks.equilibrated_body =
            self.follow_stages(&simulation, &body, &mut checkpoints, (control, bodies))?;
        hooks.resume = checkpoints.take_run();
        hooks.stop = control.stop.cloned();
        match simulation.run(hooks) {
            Ok(_) | Err(Error::Failed { .. }) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// The body after the stages on a rank other than 0: from the file of rank 0, or computed with it.
    fn follow_stages(
        &self,
        simulation: &Simulation,
        key: &str,
        checkpoints: &mut RunCheckpoints,
        (control, bodies): (&CaseControl, &BodyStore),
    ) -> Result<Option<powerhouse::EquilibratedBody>, StudyError> {
        self.ranks.agree(Ok(()))?;
        if self.ranks.is_known(false)? {
            let read = bodies.read(key).ok_or_else(|| StudyError::NoResults {
                folder: self.folder.clone(),
            });
            return self.ranks.agree(read).map(Some);
        }
        self.ranks.agree(Ok(()))?;
        let mut hooks = RunHooks::default();
        hooks.stop = control.stop.cloned();
        hooks.completed_stages = checkpoints.take_body();
        let found = simulation.equilibrate_with(hooks);
        let body = found.map_err(of_stages)?;
        if body.is_some() {
            self.ranks.agree(Ok(()))?;
        }
        Ok(body)
    }
}
