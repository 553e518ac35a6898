//! Run of one case of a sweep.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use powerhouse::engine::Ended;
use powerhouse::io::write_summary;
use powerhouse::{
    CheckpointFiles, EquilibratedBody, Error, FileScene, FolderError, FolderLock, Message,
    ProgressHook, Remark, ResultFolder, RunHooks, RunNotes, SceneFile, Simulation, StageSink,
};

use super::at_rest::{self, BodyStore};
use super::processes::pause;
use super::{
    CaseInput, CaseOutcome, Coverage, LOOK, OUTCOME, Peak, Sweep, SweepWatch, ground, locked,
    pictures,
};
use crate::checkpoints::is_of_state;
use crate::{CheckpointEvent, FreeFieldReport, RunWatch, SceneRun, StudyError, store};

/// Cancellation flag and progress callback of a case.
pub(super) struct CaseControl<'h, 'w> {
    pub(super) stop: Option<&'h Arc<AtomicBool>>,
    pub(super) watch: &'h Mutex<&'w mut dyn SweepWatch>,
}

/// Who computes a case.
pub(super) enum Claim {
    /// None: its results are complete.
    Finished,
    /// This process, as long as it holds the lock.
    Own(Arc<FolderLock>),
    /// Another process, or a run into the folder of the case.
    Elsewhere,
}

/// An error of a run, an interruption within a stage as that of the study.
pub(crate) fn of_stages(error: StudyError) -> StudyError {
    match error {
        StudyError::Scene(Error::Interrupted { .. }) => StudyError::Interrupted,
        error => error,
    }
}

/// A case before its model is built.
struct PlannedCase {
    scene: FileScene,
    input: CaseInput,
    relative: Vec<String>,
    /// Key of the body after the stages.
    body: String,
    ground: Vec<Peak>,
    coverage: Option<Coverage>,
}

/// The callbacks of the run of a case as those of its sweep.
struct CaseRunWatch<'c, 'w> {
    case: &'c str,
    path: PathBuf,
    lock: Arc<FolderLock>,
    watch: &'c Mutex<&'w mut dyn SweepWatch>,
}

impl RunWatch for CaseRunWatch<'_, '_> {
    fn checkpoint(&mut self, event: CheckpointEvent) {
        locked(self.watch).checkpoint(self.case, event);
    }
    fn checked(&mut self, found: Result<&FreeFieldReport, &StudyError>) {
        if let Ok(found) = found {
            locked(self.watch).self_check(self.case, found.largest());
        }
    }
    fn begins(&mut self, notes: &RunNotes) -> Result<(), StudyError> {
        locked(self.watch).warns(self.case, notes, self.lock.remark());
        store::unmark(&self.path, &[OUTCOME])
    }
    fn stages(&mut self, files: Option<Box<dyn StageSink>>) -> Option<Box<dyn StageSink>> {
        Some(locked(self.watch).stages(self.case, files?))
    }
    fn progress(&mut self) -> Option<ProgressHook<'static>> {
        locked(self.watch).progress(self.case)
    }
}

/// Title of the results of a case of a scene.
fn titled(scene: &str, case: &str) -> String {
    format!("{scene}: {case}")
}

impl Sweep {
    /// Claims a case for this process, unless it is finished or another one computes it.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub(super) fn claim(&self, case: &str) -> Result<Claim, StudyError> {
        if self.is_finished(case) {
            // A process may have been killed between the end of the case and that of its lock.
            FolderLock::remove_left(&self.folder.join(case));
            return Ok(Claim::Finished);
        }
        match ResultFolder::new(self.folder.join(case)).lock() {
            Err(Error::Folder(FolderError::Busy { .. })) => Ok(Claim::Elsewhere),
            Err(error) => Err(error.into()),
            // Another process may have finished it before the lock was taken.
            Ok(_) if self.is_finished(case) => Ok(Claim::Finished),
            Ok(lock) => Ok(Claim::Own(Arc::new(lock))),
        }
    }

    /// Runs a case whose lock is held and writes its results, also if it fails during the run. A checkpoint whose state
    /// does not fit the body, as that of another build of the program, is removed, and the case begins anew.
    pub(super) fn case(
        &self,
        (case, lock): (&str, &Arc<FolderLock>),
        control: &CaseControl,
        bodies: &BodyStore,
    ) -> Result<CaseOutcome, StudyError> {
        match self.run_case((case, lock), control, bodies) {
            Err(error) if is_of_state(&error) => {
                let reason = error.to_string();
                locked(control.watch).checkpoint(case, CheckpointEvent::Unused(&reason));
                let files = CheckpointFiles::of(self.folder.join(case));
                files.remove().map_err(Error::from)?;
                self.run_case((case, lock), control, bodies)
            }
            done => done,
        }
    }

    fn run_case(
        &self,
        (case, lock): (&str, &Arc<FolderLock>),
        control: &CaseControl,
        bodies: &BodyStore,
    ) -> Result<CaseOutcome, StudyError> {
        self.ranks.begin(Some(case))?;
        let PlannedCase {
            scene,
            input,
            relative,
            body,
            ground,
            coverage,
        } = self.ranks.agree(self.plan(case))?;
        let path = self.folder.join(case);
        let title = titled(scene.title(), case);
        let mut run = self.run_of((case, scene), control);
        run.title = Some(title);
        (run.warnings).extend(coverage.as_ref().and_then(Coverage::warning));
        run.lock = Some(lock.clone());
        run.bodies = Some(Box::new(|simulation, hooks| {
            self.equilibrated((simulation, hooks), (case, &body), (control, bodies))
        }));
        let mut ran = run
            .run(&mut CaseRunWatch {
                case,
                path: path.clone(),
                lock: lock.clone(),
                watch: control.watch,
            })
            .map_err(of_stages)?;
        let (mesh, results) = (&ran.mesh, &ran.results);
        let of_results = results.warnings(mesh);
        let of_results: Vec<Message> = of_results.iter().map(Remark::message).collect();
        locked(control.watch).warns_of_results(case, &of_results);
        let mut files = ran.write()?;
        if let Some(failure) = ran.failure.take() {
            return Err(Error::from(failure).into());
        }
        let stop = control.stop;
        let stopped = stop.is_some_and(|stop| stop.load(Ordering::Relaxed));
        let ended = &results.run.ended;
        if *ended == Ended::Stopped || (stopped && *ended != Ended::Completed) {
            return Err(StudyError::Interrupted);
        }
        files.extend(pictures::draw(&path, mesh, results)?);
        let mut outcome = CaseOutcome::of((case, input), mesh, results, (&relative, ground));
        outcome.coverage = coverage;
        let file = path.join(OUTCOME);
        write_summary(&file, &outcome).map_err(Error::from)?;
        files.push(file.clone());
        // The fingerprint is written last: without it the case is not finished.
        ran.require_folder()?;
        if let Some(variant) = self.variant(case) {
            store::finish(&path, variant.fingerprint(), &files)?;
        }
        ran.remove_checkpoints()?;
        // Read back, as a later sweep does: a number may lose its last bit in a file.
        CaseOutcome::read(&file)
    }

    /// The run of the scene of a case into its folder.
    pub(super) fn run_of<'a>(
        &self,
        (case, scene): (&str, FileScene),
        control: &CaseControl,
    ) -> SceneRun<'a> {
        let folder = ResultFolder::new(self.folder.join(case));
        let mut run = SceneRun::continued(scene, folder);
        run.interval = self.checkpoint_interval;
        run.hooks.stop = control.stop.cloned();
        run.engine = self.ranks.0.clone();
        run
    }

    /// What a case needs before its model is built, from which the files of the last run are not touched yet.
    fn plan(&self, case: &str) -> Result<PlannedCase, StudyError> {
        let scene = self.scene_of(case)?;
        let input = CaseInput::of(scene.input());
        let relative = scene.output().relative.iter();
        Ok(PlannedCase {
            relative: relative.map(|request| request.name.clone()).collect(),
            body: at_rest::key(&scene),
            ground: ground::relative_peaks(&scene)?,
            coverage: Coverage::of(&scene, &input),
            input,
            scene,
        })
    }

    /// The scene of a case with the settings of this sweep.
    pub(super) fn scene_of(&self, case: &str) -> Result<FileScene, StudyError> {
        let file = self.file.path();
        let variant = self.variant(case).ok_or_else(|| Error::NoSuchCase {
            name: case.into(),
            available: self.all_names(),
        })?;
        if self.in_file && SceneFile::read(file)?.text().text != self.file.text().text {
            let file = file.into();
            return Err(StudyError::Changed { file });
        }
        let mut scene = variant.scene(&self.registry)?;
        let at_once = self.at_once.get().min(self.cases.len());
        if at_once > 1 && scene.threads().is_none() {
            let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
            scene = scene.map(|scene| scene.with_threads((cores / at_once).max(1)));
        }
        Ok(scene)
    }

    /// The equilibrated body of a case after its stages, from another case or an earlier sweep if possible, or computed with
    /// hooks; `None` without stages.
    fn equilibrated(
        &self,
        (simulation, hooks): (&Simulation, RunHooks),
        (case, key): (&str, &str),
        (control, bodies): (&CaseControl, &BodyStore),
    ) -> Result<Option<EquilibratedBody>, StudyError> {
        let slot = bodies.slot(key);
        // Other cases that need the same body wait here.
        let mut body = locked(&slot);
        if body.is_none() {
            *body = bodies.read(key);
        }
        let mut lock = None;
        if body.is_none() {
            let mut has_waited = false;
            let waits = || {
                if !std::mem::replace(&mut has_waited, true) {
                    locked(control.watch).waits_for_stages(case);
                }
                pause(LOOK, control.stop)
            };
            lock = Some(self.ranks.agree(bodies.lock(key, waits))?);
            // Another process may have computed it before the lock was taken.
            *body = bodies.read(key);
        } else {
            self.ranks.agree(Ok(()))?;
        }
        if self.ranks.is_known(body.is_some())? {
            self.ranks.agree(Ok(()))?;
        } else {
            let started = Instant::now();
            let before = hooks.completed_stages.as_ref();
            let before = before.map_or(0, |body| body.stages().len());
            *body = simulation.equilibrate_with(hooks)?;
            if let Some(found) = &*body {
                if found.stages().len() > before {
                    locked(control.watch).equilibrated(case, started.elapsed());
                }
                self.ranks.agree(bodies.write(key, found))?;
            }
        }
        drop(lock);
        Ok(body.clone())
    }
}
