//! Run of one case of a sweep.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use powerhouse::engine::Ended;
use powerhouse::io::write_summary;
use powerhouse::{
    CheckpointFiles, EquilibratedBody, Error, FolderError, FolderLock, Message, Remark,
    ResultFolder, RunHooks, RunNotes, Scene, SceneFile, Simulation,
};

use super::at_rest::{self, BodyStore};
use super::processes::pause;
use super::{
    CaseInput, CaseOutcome, Coverage, LOOK, OUTCOME, Peak, Sweep, SweepWatch, ground, locked,
    pictures,
};
use crate::checkpoints::{RunCheckpoints, is_of_state};
use crate::store;
use crate::{CheckpointEvent, FreeFieldCheck, OutputSize, StudyError, Warning};

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
    Own(FolderLock),
    /// Another process, or a run into the folder of the case.
    Elsewhere,
}

/// The error of a case from that of its stages.
pub(super) fn of_stages(error: Error) -> StudyError {
    match error {
        Error::Interrupted { .. } => StudyError::Interrupted,
        error => error.into(),
    }
}

/// A case before its model is built.
struct PlannedCase {
    scene: Scene,
    input: CaseInput,
    text: Option<String>,
    relative: Vec<String>,
    /// Key of the body after the stages.
    body: String,
    title: String,
    ground: Vec<Peak>,
    coverage: Option<Coverage>,
    checkpoints: RunCheckpoints,
    /// The free-field check with its limit.
    check: Option<(FreeFieldCheck, f64)>,
    size: OutputSize,
    warnings: Vec<Message>,
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
            return Ok(Claim::Finished);
        }
        match ResultFolder::new(self.folder.join(case)).lock() {
            Err(Error::Folder(FolderError::Busy { .. })) => Ok(Claim::Elsewhere),
            Err(error) => Err(error.into()),
            // Another process may have finished it before the lock was taken.
            Ok(_) if self.is_finished(case) => Ok(Claim::Finished),
            Ok(lock) => Ok(Claim::Own(lock)),
        }
    }

    /// Runs a case whose lock is held and writes its results, also if it fails during the run. A checkpoint whose state
    /// does not fit the body, as that of another build of the program, is removed, and the case begins anew.
    pub(super) fn case(
        &self,
        (case, lock): (&str, &FolderLock),
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
        (case, lock): (&str, &FolderLock),
        control: &CaseControl,
        bodies: &BodyStore,
    ) -> Result<CaseOutcome, StudyError> {
        self.ranks.begin(Some(case))?;
        let planned = self.ranks.agree(self.plan(case))?;
        let PlannedCase {
            scene,
            input,
            text,
            relative,
            body,
            title,
            ground,
            coverage,
            mut checkpoints,
            check,
            size,
            mut warnings,
        } = planned;
        self.ranks.check_same(&checkpoints)?;
        let path = self.folder.join(case);
        let folder = ResultFolder::new(&path);
        let mut simulation = scene.prepare()?;
        // An invalid step is an error before any file is removed.
        let step = match checkpoints.step() {
            Some(step) => {
                simulation.resume_at(step);
                step
            }
            None => simulation.step()?,
        };
        let report = |event: CheckpointEvent| locked(control.watch).checkpoint(case, event);
        let begin = || {
            folder.remove_unfinished()?;
            folder.prove(&simulation, size.bytes(step))?;
            store::unmark(&path, &[OUTCOME])?;
            checkpoints.report(report);
            if !checkpoints.is_resumed() {
                folder.clear()?;
                checkpoints.clear()?;
            }
            if let Some((check, limit)) = check {
                let mut hooks = RunHooks::default();
                hooks.stop = control.stop.cloned();
                let found = check.run(step, hooks)?;
                locked(control.watch).self_check(case, found.largest());
                found.require(limit)?;
            }
            Ok(())
        };
        self.ranks.agree(begin())?;

        let mesh = simulation.mesh().clone();
        warnings.extend(coverage.as_ref().and_then(Coverage::warning));
        let notes = RunNotes::new(simulation.remarks().to_vec()).with_warnings(warnings);
        locked(control.watch).warns(case, &notes, lock.remark());
        let open = || -> Result<_, StudyError> {
            folder.begin(&title)?;
            Ok(folder.snapshots(&simulation)?)
        };
        let mut hooks = RunHooks::default()
            .with_snapshots(self.ranks.agree(open())?)
            .with_tables(folder.tables())
            .with_checkpoints(checkpoints.writer().clone());
        let staged = (&folder, &mut checkpoints);
        hooks.equilibrated_body =
            self.equilibrated(&simulation, (case, &body), staged, (control, bodies))?;
        hooks.resume = checkpoints.take_run();
        hooks.progress = locked(control.watch).progress(case);
        hooks.stop = control.stop.cloned();
        let outcome = simulation.run(hooks);
        checkpoints.finish(report);
        let (results, failure) = match outcome {
            Ok(results) => (results, None),
            Err(Error::Failed { error, results }) => (*results, Some(error)),
            Err(error) => return Err(error.into()),
        };
        let of_results = results.warnings(&mesh);
        let of_results: Vec<Message> = of_results.iter().map(Remark::message).collect();
        locked(control.watch).warns_of_results(case, &of_results);
        let is_held = lock.is_held();
        let mut files = folder.write((&title, &mesh), &results, &notes, text.as_deref())?;
        if let Some(failure) = failure {
            return Err(Error::from(failure).into());
        }
        let stop = control.stop;
        let stopped = stop.is_some_and(|stop| stop.load(Ordering::Relaxed));
        let ended = &results.run.ended;
        if *ended == Ended::Stopped || (stopped && *ended != Ended::Completed) {
            return Err(StudyError::Interrupted);
        }
        files.extend(pictures::draw(&path, &mesh, &results)?);
        let mut outcome = CaseOutcome::of((case, input), &mesh, &results, (&relative, ground));
        outcome.coverage = coverage;
        let file = path.join(OUTCOME);
        write_summary(&file, &outcome).map_err(Error::from)?;
        files.push(file.clone());
        // The fingerprint is written last: without it the case is not finished.
        if !is_held {
            return Err(Error::from(FolderError::Gone { folder: path }).into());
        }
        if let Some(variant) = self.variant(case) {
            store::finish(&path, variant.fingerprint(), &files)?;
        }
        checkpoints.remove()?;
        // Read back, as a later sweep does: a number may lose its last bit in a file.
        CaseOutcome::read(&file)
    }

    /// What a case needs before its model is built, from which the files of the last run are not touched yet.
    fn plan(&self, case: &str) -> Result<PlannedCase, StudyError> {
        let scene = self.scene_of(case)?;
        let input = CaseInput::of(scene.input());
        let path = self.folder.join(case);
        let relative = scene.output().relative.iter();
        let checkpoints = RunCheckpoints::open(&path, &scene, self.checkpoint_interval, true);
        // A run that is resumed has passed the check.
        let check = scene.self_check().filter(|_| !checkpoints.is_resumed());
        let check = check.map(|limit| Ok::<_, StudyError>((FreeFieldCheck::of(&scene)?, limit)));
        let warnings = crate::warnings(&scene)?;
        Ok(PlannedCase {
            text: scene.source().map(|source| source.text.clone()),
            relative: relative.map(|request| request.name.clone()).collect(),
            body: at_rest::key(&scene),
            title: titled(scene.title(), case),
            ground: ground::relative_peaks(&scene)?,
            coverage: Coverage::of(&scene, &input),
            check: check.transpose()?,
            size: OutputSize::of(&scene)?,
            warnings: warnings.iter().map(Warning::message).collect(),
            input,
            checkpoints,
            scene: self.ranks.take(scene)?,
        })
    }

    /// The scene of a case with the settings of this sweep.
    pub(super) fn scene_of(&self, case: &str) -> Result<Scene, StudyError> {
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
            scene = scene.with_threads((cores / at_once).max(1));
        }
        Ok(scene)
    }
}

impl Sweep {
    /// The equilibrated body of a case after its stages, from another case or an earlier sweep if possible, or after the last
    /// stage of its checkpoint; `None` without stages.
    fn equilibrated(
        &self,
        simulation: &Simulation,
        (case, key): (&str, &str),
        (folder, checkpoints): (&ResultFolder, &mut RunCheckpoints),
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
            let files = self
                .ranks
                .agree(folder.stages(simulation).map_err(StudyError::from))?;
            let completed = Arc::new(Mutex::new(Vec::new()));
            let (writer, reports) = (checkpoints.writer().clone(), completed.clone());
            let mut hooks = RunHooks::default().with_stage_hook(move |body| {
                let mut reports = locked(&reports);
                reports.clear();
                reports.extend_from_slice(body.stages());
                writer.keep_stage(body);
            });
            hooks.stop = control.stop.cloned();
            hooks.stages = Some(locked(control.watch).stages(case, files));
            hooks.completed_stages = checkpoints.take_body();
            if !self.ranks.are_several() {
                hooks.stage_solution = checkpoints.take_solution();
                hooks.stage_checkpoints = Some(checkpoints.writer().clone());
            }
            let before = hooks.completed_stages.as_ref();
            let before = before.map_or(0, |body| body.stages().len());
            let found = simulation.equilibrate_with(hooks);
            let title = || titled(simulation.title(), case);
            let completed = locked(&completed);
            match &found {
                Err(Error::Interrupted { stage }) => {
                    folder.interrupt(&title(), stage, &completed)?
                }
                Err(error) => folder.fail(&title(), error, &completed)?,
                Ok(_) => {}
            }
            *body = found.map_err(of_stages)?;
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
