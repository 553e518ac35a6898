//! A model ready to run, and its run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use powerhouse_contact::JointSurface;
use powerhouse_model::{
    Cadence, CheckpointSink, EnergyCheck, Engine, EngineModel, HistoryVariable, IncidentField,
    Mesh, ModelError, Observer, Progress, RunFailure, RunOptions, RunReport, SavedRun, StableStep,
    StateError, StepChoice, StepProfile, TimeIntegrator, decode, encode,
};
use powerhouse_observe::{SectionGeometry, Snapshot, SnapshotSink, Snapshots};

use crate::fibres::{FibreSite, set_fibres};
use crate::in_use::{InUse, check_in_use};
use crate::output::{self, OutputPlan, Recordings, Results};
use crate::places::placed;
use crate::stage::{
    EquilibratedBody, StageCheckpointSink, StageHook, StageSink, StageSolution, Staging,
    StagingOutcome, StagingStart,
};
use crate::{
    Error, FibreChoice, FibreOptions, Places, Remark, ResidualLimit, SceneBolts, SceneStage,
    Subject, TableForm, TableSink, TimeStep, field_motion, remark,
};

/// Sampling interval of the energy balance, over the duration, if energies are not recorded.
const LOOKS_SHARE: f64 = 0.01;

/// Progress callback of a run, called after every time step of the dynamic run, on a thread of the run.
pub type ProgressHook<'a> = Box<dyn FnMut(Progress) + Send + 'a>;

/// Progress callback, cancellation flag, sinks and further observers of a run.
///
/// ```
/// use powerhouse_scene::RunHooks;
/// use std::sync::Arc;
/// use std::sync::atomic::AtomicBool;
/// let stop = Arc::new(AtomicBool::new(false));
/// let hooks = RunHooks::default()
///     .with_stop(stop.clone())
///     .with_progress(|progress| println!("{} of {}", progress.done, progress.planned));
/// assert!(hooks.stop.is_some());
/// ```
#[derive(Default)]
#[non_exhaustive]
pub struct RunHooks<'a> {
    /// Progress callback, called after every time step of the dynamic run; stages report to [`stages`](Self::stages).
    pub progress: Option<ProgressHook<'a>>,
    /// Cancellation flag, raised from outside. During the dynamic run it ends the run after one more step, with
    /// complete results up to there ([`Ended::Stopped`](powerhouse_model::Ended::Stopped)); during a construction stage it
    /// ends the run with [`Error::Interrupted`], without results.
    pub stop: Option<Arc<AtomicBool>>,
    /// Receiver of the snapshots that the scene requests; without it none is taken. An error of it ends the run.
    pub snapshots: Option<Box<dyn SnapshotSink>>,
    /// Receiver of the progress and the state of each construction stage that the run computes; an error of it ends the
    /// run.
    pub stages: Option<Box<dyn StageSink + 'a>>,
    /// The body in static equilibrium after the same stages, from [`Simulation::equilibrate`] or a file: the run starts
    /// from it and computes no stage. Unused in a scene without stages.
    pub equilibrated_body: Option<EquilibratedBody>,
    /// Observers of the dynamic run beside those of the scene's output requests, called after them; one may stop the run.
    pub observers: Vec<Box<dyn Observer>>,
    /// Receiver of the tables of histories during the dynamic run.
    pub tables: Option<Box<dyn TableSink>>,
    /// Whether the wall time of the parts of time steps is measured, see [`RunReport::profile`](powerhouse_model::RunReport::profile)
    /// in [`Results::run`]. The motion is the same to the bit; steps take some per cent longer. False by default.
    pub profile: bool,
    /// The body after some of the stages, from which the others are computed; unused with an
    /// [equilibrated body](Self::equilibrated_body).
    pub completed_stages: Option<EquilibratedBody>,
    /// Callback with the body at the end of every stage that the run computes, such as a writer of checkpoint files.
    pub keep_stage: Option<StageHook<'a>>,
    /// Receiver of the states of the static solutions of the stages, from which they can be resumed.
    pub stage_checkpoints: Option<Arc<dyn StageCheckpointSink>>,
    /// State of the static solution of the first stage that the run computes, which goes on from it to the same bits; unused
    /// if it is that of another stage.
    pub stage_solution: Option<StageSolution>,
    /// Receiver of the state of the dynamic run between two steps, from which a run can be resumed, such as a writer of
    /// checkpoint files.
    pub checkpoints: Option<Arc<dyn CheckpointSink>>,
    /// State of the same scene's dynamic run, which goes on from it to the same bits. The
    /// [equilibrated body](Self::equilibrated_body) of that run must be given with it if the scene has stages, and the same
    /// observers; the number of threads may differ.
    pub resume: Option<Arc<SavedRun>>,
}

impl<'a> RunHooks<'a> {
    /// Sets the [body after some of the stages](Self::completed_stages).
    #[must_use]
    pub fn with_completed_stages(mut self, body: EquilibratedBody) -> Self {
        self.completed_stages = Some(body);
        self
    }
    /// Sets the [callback with the body at the end of every stage](Self::keep_stage).
    #[must_use]
    pub fn with_stage_hook(mut self, keep: impl FnMut(&EquilibratedBody) + Send + 'a) -> Self {
        self.keep_stage = Some(Box::new(keep));
        self
    }
    /// Sets the [receiver of the states of static solutions](Self::stage_checkpoints).
    #[must_use]
    pub fn with_stage_checkpoints(mut self, sink: Arc<dyn StageCheckpointSink>) -> Self {
        self.stage_checkpoints = Some(sink);
        self
    }
    /// Sets the [state of a static solution](Self::stage_solution) from which it goes on.
    #[must_use]
    pub fn with_stage_solution(mut self, solution: StageSolution) -> Self {
        self.stage_solution = Some(solution);
        self
    }
    /// Sets the [receiver of checkpoints](Self::checkpoints).
    #[must_use]
    pub fn with_checkpoints(mut self, sink: Arc<dyn CheckpointSink>) -> Self {
        self.checkpoints = Some(sink);
        self
    }
    /// Sets the [state](Self::resume) from which the dynamic run goes on.
    #[must_use]
    pub fn with_resume(mut self, saved: Arc<SavedRun>) -> Self {
        self.resume = Some(saved);
        self
    }
    /// Sets the [progress callback](Self::progress), called with the steps done and planned and the present time.
    #[must_use]
    pub fn with_progress(mut self, progress: impl FnMut(Progress) + Send + 'a) -> Self {
        self.progress = Some(Box::new(progress));
        self
    }
    /// Sets the [cancellation flag](Self::stop); to end the run, another thread or the progress callback sets it to true.
    #[must_use]
    pub fn with_stop(mut self, stop: Arc<AtomicBool>) -> Self {
        self.stop = Some(stop);
        self
    }
    /// Sets the [receiver](Self::snapshots) of the snapshots that the scene requests.
    #[must_use]
    pub fn with_snapshots(mut self, sink: Box<dyn SnapshotSink>) -> Self {
        self.snapshots = Some(sink);
        self
    }
    /// Sets the [receiver of tables](Self::tables) during the dynamic run.
    #[must_use]
    pub fn with_tables(mut self, tables: impl TableSink + 'static) -> Self {
        self.tables = Some(Box::new(tables));
        self
    }
    /// Sets whether the wall time of the parts of time steps is [measured](Self::profile).
    #[must_use]
    pub fn with_profile(mut self, profile: bool) -> Self {
        self.profile = profile;
        self
    }
    /// Sets the [receiver](Self::stages) of the progress and the state of construction stages.
    #[must_use]
    pub fn with_stages(mut self, sink: Box<dyn StageSink + 'a>) -> Self {
        self.stages = Some(sink);
        self
    }
    /// Sets the body from which the run starts in place of its stages.
    #[must_use]
    pub fn with_equilibrated_body(mut self, body: EquilibratedBody) -> Self {
        self.equilibrated_body = Some(body);
        self
    }
    /// Adds an observer of the dynamic run.
    #[must_use]
    pub fn with_observer(mut self, observer: impl Observer + 'static) -> Self {
        self.observers.push(Box::new(observer));
        self
    }
}

/// A scene whose model is built and checked, ready to run.
pub struct Simulation {
    pub(crate) title: String,
    pub(crate) mesh: Arc<Mesh>,
    pub(crate) model: Box<dyn EngineModel>,
    pub(crate) integrator: Box<dyn TimeIntegrator>,
    pub(crate) step: TimeStep,
    pub(crate) duration: f64,
    pub(crate) residual: ResidualLimit,
    /// Places of the values of the scene in what its user wrote, if its errors are to be shown there.
    pub(crate) places: Option<Arc<dyn Places>>,
    /// The field whose motion the body starts with.
    pub(crate) initial: Option<Arc<dyn IncidentField>>,
    pub(crate) fibre_site: FibreSite,
    /// The fibres of the model.
    pub(crate) fibres: Option<FibreChoice>,
    pub(crate) plan: OutputPlan,
    pub(crate) recordings: Recordings,
    pub(crate) observers: Vec<Box<dyn Observer>>,
    /// The history variables of the laws.
    pub(crate) variables: Vec<HistoryVariable>,
    pub(crate) remarks: Vec<Remark>,
    pub(crate) in_use: Option<InUse>,
    pub(crate) engine: Arc<dyn Engine>,
    /// The construction stages before the motion.
    pub(crate) staging: Option<Staging>,
}

impl Simulation {
    /// The scene's title.
    pub fn title(&self) -> &str {
        &self.title
    }
    /// The mesh.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }
    /// The engine's model. Before a run the model of a scene with stages has the elements and bolts
    /// that move, unloaded: the run takes it through the stages.
    pub fn model(&self) -> &dyn EngineModel {
        self.model.as_ref()
    }
    /// The output requests.
    pub fn output(&self) -> &OutputPlan {
        &self.plan
    }
    /// Node pairs and facets of each joint, with the name of the joint.
    pub fn joint_surfaces(&self) -> &[(String, JointSurface)] {
        &self.recordings.joint_surfaces
    }
    /// Geometry of the sections whose forces are recorded: area, extents, axes and pieces.
    pub fn section_geometry(&self) -> &[SectionGeometry] {
        &self.recordings.section_geometry
    }
    /// Which elements of the mesh are present when the body moves, one flag per element: stages may have
    /// excavated some, or not cast them. None if all are present.
    pub fn present(&self) -> Option<&[bool]> {
        self.recordings.present.as_deref()
    }
    /// The tables against time that a run has.
    pub fn tables(&self) -> impl Iterator<Item = &TableForm> {
        self.recordings.forms()
    }
    /// Paths of the tables and plots that a run may write, relative to its folder.
    pub fn table_files(&self) -> Vec<String> {
        self.recordings.files()
    }
    /// The construction stages before the motion, in their order.
    pub fn stages(&self) -> &[SceneStage] {
        (self.staging.as_ref()).map_or(&[], |staging| &staging.scene.stages)
    }
    /// The bolt groups.
    pub fn bolts(&self) -> &[SceneBolts] {
        (self.staging.as_ref()).map_or(&[], |staging| &staging.scene.bolts)
    }
    /// History variables of the laws.
    pub fn history_variables(&self) -> &[HistoryVariable] {
        &self.variables
    }
    fn placed(&self, error: Error) -> Error {
        placed(self.places.as_ref(), Subject::OfError, error)
    }
    /// Remarks and warnings that were found while the scene was composed.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }
    /// Duration of the dynamic run (s).
    pub fn duration(&self) -> f64 {
        self.duration
    }
    /// Name of the time integration scheme.
    pub fn scheme(&self) -> &'static str {
        self.integrator.name()
    }

    /// The stable step (s) and the element that limits it. The first call costs some tens of force
    /// evaluations.
    ///
    /// # Errors
    /// If the scheme is unstable at every step under the scene's damping.
    pub fn stable_step(&mut self) -> Result<StableStep, Error> {
        let stable = self.model.stable_step(self.integrator.as_ref());
        stable.map_err(|error| self.placed(error.into()))
    }
    /// The fibres of the run; none if the scene asks for none.
    pub fn fibres(&self) -> Option<&FibreChoice> {
        self.fibres.as_ref()
    }
    /// The fibres that other options than the scene's would choose, with the stable step that they permit; those of the
    /// run do not change. Costs some tens of force evaluations.
    ///
    /// # Errors
    /// A factor out of range, an unknown set, or a model that cannot have fibres.
    pub fn choose_fibres(&mut self, options: &FibreOptions) -> Result<FibreChoice, Error> {
        let chosen = self
            .fibre_site
            .choose(options, self.model.as_mut(), self.integrator.as_ref());
        let own = self.fibres.as_ref().map_or(&[][..], |own| &own.fibres);
        set_fibres(self.model.as_mut(), own)?;
        chosen
    }
    /// The time step of the run (s). Requested sampling intervals shorter than it, or longer than the run, become
    /// [remarks](Self::remarks).
    ///
    /// # Errors
    /// A given step that is above the stable one, or as [`stable_step`](Self::stable_step).
    pub fn step(&mut self) -> Result<f64, Error> {
        let step = match self.step {
            TimeStep::OfStable(share) => share * self.stable_step()?.step,
            TimeStep::Seconds(step) => {
                let frequencies = self.model.frequencies();
                let frequencies = frequencies
                    .ok_or_else(|| ModelError::lacking("checks of a given time step"))?;
                let limits = frequencies.frequency_limits();
                let checked = self.integrator.check(&limits, step);
                checked.map_err(|error| self.placed(error.into()))?;
                step
            }
        };
        self.check_intervals(step);
        Ok(step)
    }

    /// Adds the [remarks](Self::remarks) about sampling intervals at the step (s) of a [saved run](RunHooks::resume), as
    /// [`step`](Self::step) does, without computing the stable step.
    pub fn resume_at(&mut self, step: f64) {
        self.check_intervals(step);
    }

    /// Adds warnings about output intervals shorter than the step or longer than the run, without repetitions.
    fn check_intervals(&mut self, step: f64) {
        let histories = !self.plan.histories.is_empty() || !self.plan.cuts.is_empty();
        let intervals = [
            ("histories", histories.then_some(self.plan.every)),
            ("energies", self.plan.energies),
            (
                "envelopes",
                self.plan.envelope.as_ref().map(|request| request.every),
            ),
            (
                "snapshots",
                self.plan.snapshots.map(|request| request.every),
            ),
        ];
        for (what, interval) in intervals {
            // The default interval is not a request.
            let own = OutputPlan::default().every;
            let by_default = |interval: f64| match what {
                "energies" => {
                    let own = LOOKS_SHARE * self.duration;
                    (0.999 * own..=self.duration).contains(&interval)
                }
                _ => interval == own,
            };
            let asked = interval.filter(|interval| !by_default(*interval));
            let finding = match asked {
                Some(interval) if interval < step => Remark::from(remark::ShortInterval {
                    what,
                    interval,
                    step,
                }),
                Some(interval) if interval > self.duration => Remark::from(remark::LongInterval {
                    what,
                    interval,
                    duration: self.duration,
                }),
                _ => continue,
            };
            let is_said = |remark: &Remark| {
                matches!(
                    remark,
                    Remark::ShortInterval(remark::ShortInterval { what: said, .. })
                        | Remark::LongInterval(remark::LongInterval { what: said, .. }) if *said == what
                )
            };
            if !self.remarks.iter().any(is_said) {
                self.remarks.push(finding);
            }
        }
    }

    /// Sets the time step of the run in place of that of the scene; it is checked by [`step`](Self::step) and the run.
    pub fn set_step(&mut self, step: TimeStep) {
        // An error of the step no longer concerns the scene file.
        self.places = None;
        self.step = step;
    }

    /// The body in static equilibrium after the construction stages of the scene; none without stages.
    /// Several runs can start from it: those of scenes that differ in nothing but what makes the body move.
    /// `stop` is a cancellation flag, `sink` receives the progress and the state of each stage.
    ///
    /// # Errors
    /// A stage that does not reach static equilibrium; [`Error::Interrupted`] if the flag was raised; an error of the
    /// sink.
    pub fn equilibrate(
        &self,
        stop: Option<&Arc<AtomicBool>>,
        sink: Option<Box<dyn StageSink + '_>>,
    ) -> Result<Option<EquilibratedBody>, Error> {
        self.equilibrate_with(RunHooks {
            stop: stop.cloned(),
            stages: sink,
            ..RunHooks::default()
        })
    }

    /// The same with hooks, of which the cancellation flag, the sink of stages, the
    /// [body after some of the stages](RunHooks::completed_stages) and the [callback](RunHooks::keep_stage) at the end of
    /// every stage are used.
    ///
    /// # Errors
    /// As [`equilibrate`](Self::equilibrate); [`Error::ForeignStages`] for a body after other stages.
    pub fn equilibrate_with(&self, mut hooks: RunHooks) -> Result<Option<EquilibratedBody>, Error> {
        let Some(staging) = &self.staging else {
            return Ok(None);
        };
        let from = StagingStart::of(&mut hooks);
        let found = staging.run(hooks.stop.as_ref(), hooks.stages, from);
        Ok(Some(found.map_err(|error| self.placed(error))?))
    }

    /// The results of the scene's run, construction stages first.
    ///
    /// # Errors
    /// A stage that does not reach static equilibrium; [`Error::Interrupted`] if the cancellation flag was raised before
    /// or during a stage; [`Error::ForeignBody`] for an equilibrated body of another mesh or with other inactive
    /// elements; a step above the stable one; [`Error::Failed`] with the results until then for whatever ended the run
    /// before its time.
    pub fn run(mut self, mut hooks: RunHooks) -> Result<Results, Error> {
        let started = Instant::now();
        let step = match &hooks.resume {
            Some(saved) => {
                self.check_intervals(saved.step);
                saved.step
            }
            None => self.step()?,
        };
        let mut rested = None;
        if let Some(staging) = &self.staging {
            let body = match hooks.equilibrated_body {
                Some(body) => Ok(body),
                None => {
                    let from = StagingStart::of(&mut hooks);
                    staging.run(hooks.stop.as_ref(), hooks.stages, from)
                }
            };
            let moving = body.and_then(|body| staging.set_in_motion(body));
            let (model, stages) = moving.map_err(|error| self.placed(error))?;
            self.model = model;
            if let Some(choice) = &self.fibres {
                set_fibres(self.model.as_mut(), &choice.fibres)?;
            }
            rested = Some(stages);
        }
        if let Some(field) = self.initial.take().filter(|_| hooks.resume.is_none()) {
            let nodes = self.mesh.positions();
            let (displacement, velocity) =
                field_motion(field.as_ref(), nodes, self.model.time(), step)?;
            self.model.set_initial(&displacement, &velocity)?;
        }
        let mut options = self.options(RunOptions::seconds(self.duration), step);
        options.stop = hooks.stop;
        options.profile = hooks.profile;
        (options.checkpoints, options.resume) = (hooks.checkpoints, hooks.resume);
        let done_before = options.resume.as_ref().map_or(0, |saved| saved.done);
        let (recordings, mut observers) = (self.recordings, self.observers);
        let fibres = self.fibres;
        let taken = Arc::new(AtomicU64::new(0));
        if let (Some(request), Some(sink)) = (self.plan.snapshots, hooks.snapshots) {
            let cadence = Cadence::Seconds(request.every);
            let sink = Counted(sink, taken.clone());
            let snapshots = Snapshots::new(&self.mesh, request.fields, cadence, sink);
            let mut snapshots = snapshots.map_err(ModelError::from)?;
            if self.plan.state.snapshots {
                snapshots = snapshots.with_state(&self.variables);
            }
            observers.push(Box::new(snapshots));
        }
        observers.extend(hooks.observers);
        let mut progress = hooks.progress.unwrap_or_else(|| Box::new(|_| {}));
        let mut tables = hooks.tables;
        let mut progress = |now: Progress| {
            if let Some(tables) = &mut tables
                && tables.is_due()
            {
                recordings.each_table(|form, rows| tables.take(form, rows));
            }
            progress(now);
        };
        let first_step = Instant::now();
        let outcome = self.model.run(
            self.integrator.as_ref(),
            &options,
            &mut observers,
            &mut progress,
        );
        let (wall_time, taken_by_steps) = (started.elapsed(), first_step.elapsed());
        // What follows reads the mesh again. All processes agree on whether a run has failed.
        if outcome.is_ok() {
            check_in_use(self.in_use.as_ref(), self.engine.as_ref())?;
        }
        let staging = self.staging.as_ref();
        let bolts = staging.map_or_else(Vec::new, |staging| staging.forces(self.model.as_mut()));
        let finish = |report: RunReport| {
            let steps = report.steps.saturating_sub(done_before).max(1) as f64;
            let times = [wall_time, taken_by_steps.div_f64(steps)];
            let mut results = recordings.finish(report, times, bolts);
            results.snapshots = taken.load(Ordering::Relaxed);
            results.fibres = fibres;
            if let Some(StagingOutcome { stages, hand_over }) = rested {
                (results.stages, results.hand_over) = (stages, Some(hand_over));
                results.in_situ_stress =
                    staging.is_some_and(|staging| staging.scene.in_situ_stress.is_some());
            }
            results
        };
        match outcome {
            Ok(report) => Ok(finish(report)),
            Err(RunFailure { error, report }) => Err(match report {
                None => error.into(),
                Some(report) => {
                    let mut results = Box::new(finish(*report));
                    results.advice = output::advice(&error, &results.run);
                    Error::Failed { error, results }
                }
            }),
        }
    }

    /// Run options with a step (s) and the check of the energy balance, at the sampling interval of the energies.
    fn options(&self, options: RunOptions, step: f64) -> RunOptions {
        let options = options.with_step(StepChoice::Fixed(step));
        let every = self.plan.energies.unwrap_or(LOOKS_SHARE * self.duration);
        let limit = match self.residual {
            ResidualLimit::OfPrecision => None,
            ResidualLimit::Share(limit) => Some(limit),
            ResidualLimit::Unchecked => return options,
        };
        // Balances by set take a tenth of a step, and name a fault's set only a little more surely.
        let mut check =
            EnergyCheck::every((every / step).round().max(1.0) as u64).with_by_set(false);
        check.limit = limit;
        options.with_energy(check)
    }

    /// Wall time of `count` time steps of the dynamic run with all that is recorded, without stages. One step before and
    /// one after, at which every observer samples, are computed beside and not timed. The model has moved afterwards, and
    /// what was recorded belongs to no run: a run needs a new simulation.
    ///
    /// # Errors
    /// A step above the stable one; [`Error::Run`] for a failure during the steps.
    pub fn time_steps(&mut self, count: u64) -> Result<Duration, Error> {
        let step = self.step()?;
        let options = self.options(RunOptions::steps(count + 2), step);
        let (mut started, mut taken) = (Instant::now(), Duration::ZERO);
        let run = self.model.run(
            self.integrator.as_ref(),
            &options,
            &mut self.observers,
            &mut |progress| {
                if progress.done == 1 {
                    started = Instant::now();
                }
                if progress.done == count + 1 {
                    taken = started.elapsed();
                }
            },
        );
        run.map_err(|failure| failure.error)?;
        Ok(taken)
    }

    /// Wall time of the parts of `count` time steps of the dynamic run with all that is recorded, without stages. The
    /// model has moved afterwards, as after [`time_steps`](Self::time_steps).
    ///
    /// # Errors
    /// As [`time_steps`](Self::time_steps).
    pub fn profile_steps(&mut self, count: u64) -> Result<StepProfile, Error> {
        let step = self.step()?;
        let mut options = self.options(RunOptions::steps(count), step);
        options.profile = true;
        let run = self.model.run(
            self.integrator.as_ref(),
            &options,
            &mut self.observers,
            &mut |_| {},
        );
        let report = run.map_err(|failure| failure.error)?;
        Ok(report.profile.unwrap_or_default())
    }
}

/// A sink that counts its snapshots.
struct Counted(Box<dyn SnapshotSink>, Arc<AtomicU64>);

impl SnapshotSink for Counted {
    fn take(
        &mut self,
        snapshot: &Snapshot,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        self.0.take(snapshot)?;
        self.1.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }
    fn finish(&mut self) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        self.0.finish()
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        encode(&(self.1.load(Ordering::Relaxed), self.0.save_state()?))
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        let (count, of_sink): (u64, Vec<u8>) = decode(saved)?;
        self.0.restore_state(&of_sink)?;
        self.1.store(count, Ordering::Relaxed);
        Ok(())
    }
}
