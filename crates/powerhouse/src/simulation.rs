//! A model ready to run, and its run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use powerhouse_contact::JointSurface;
use powerhouse_explicit_core::observe::{Snapshot, SnapshotSink, Snapshots};
use powerhouse_explicit_core::{
    EnergyCheck, Model, Progress, RunFailure, RunOptions, StableStep, StepChoice, run,
    run_reporting,
};
use powerhouse_model::{
    Cadence, HistoryVariable, IncidentField, Mesh, ModelError, Observer, TimeIntegrator,
};

use crate::output::{Named, OutputPlan, Recordings, Results};
use crate::scene::{ResidualLimit, SceneSpans, TimeStep, field_motion};
use crate::stage::{EquilibratedBody, StageSink, Staging, StagingOutcome};
use crate::{Error, Remark, SceneDoubt, SceneText};

/// Sampling interval of the energy balance, over the duration, if energies are not recorded.
const LOOKS_SHARE: f64 = 0.01;

/// Told after every step where a run stands.
pub type ProgressHook<'a> = Box<dyn FnMut(Progress) + Send + 'a>;

/// What a run is given beside its scene.
#[derive(Default)]
pub struct RunHooks<'a> {
    /// Called after every step.
    pub progress: Option<ProgressHook<'a>>,
    /// Raised from outside, it ends the run after one more step; the results are complete up to
    /// there.
    pub stop: Option<Arc<AtomicBool>>,
    /// Takes the snapshots that the scene asks for.
    pub snapshots: Option<Box<dyn SnapshotSink>>,
    /// Is shown the stages of the scene.
    pub stages: Option<Box<dyn StageSink + 'a>>,
    /// The body as the same stages left it before, from which the run starts without them.
    pub at_rest: Option<EquilibratedBody>,
    /// Further observers.
    pub observers: Vec<Box<dyn Observer>>,
}

/// A model ready to run.
pub struct Simulation {
    title: String,
    mesh: Arc<Mesh>,
    model: Model,
    integrator: Box<dyn TimeIntegrator>,
    step: TimeStep,
    duration: f64,
    residual: ResidualLimit,
    /// The scene's file, and what stands where in it.
    source: (Option<Arc<SceneText>>, SceneSpans),
    /// The field whose motion the body starts with.
    initial: Option<Arc<dyn IncidentField>>,
    plan: OutputPlan,
    observed: (Recordings, Vec<Box<dyn Observer>>),
    /// The history variables of the laws.
    variables: Vec<HistoryVariable>,
    remarks: Vec<Remark>,
    /// What the body goes through before it moves.
    staging: Option<Staging>,
}

impl Simulation {
    pub(crate) fn new(
        (title, mesh, model): (String, Arc<Mesh>, Model),
        (integrator, step): (Box<dyn TimeIntegrator>, TimeStep),
        (duration, residual): (f64, ResidualLimit),
        source: (Option<Arc<SceneText>>, SceneSpans),
        initial: Option<Arc<dyn IncidentField>>,
        (plan, observed): (OutputPlan, (Recordings, Vec<Box<dyn Observer>>)),
        variables: Vec<HistoryVariable>,
        remarks: Vec<Remark>,
        staging: Option<Staging>,
    ) -> Self {
        Self {
            title,
            mesh,
            model,
            integrator,
            step,
            duration,
            residual,
            source,
            initial,
            plan,
            observed,
            variables,
            remarks,
            staging,
        }
    }
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
    pub fn model(&self) -> &Model {
        &self.model
    }
    /// What is recorded.
    pub fn output_plan(&self) -> &OutputPlan {
        &self.plan
    }
    /// The sides of the joints, by name.
    pub fn joint_surfaces(&self) -> &[(String, JointSurface)] {
        self.observed.0.joint_surfaces()
    }
    /// Which elements of the mesh are there when the body moves, one flag per element: stages may have
    /// excavated some, or not cast them. None if all are.
    pub fn present(&self) -> Option<&[bool]> {
        self.observed.0.present()
    }
    /// The files that a run may write, below its folder; that of snapshots stands for all of them.
    pub fn result_files(&self) -> Vec<String> {
        let scene = self.staging.as_ref().map(|staging| &staging.scene);
        let joints = self.joint_surfaces().iter();
        let named = Named {
            plan: &self.plan,
            joints: joints.map(|(name, _)| name.as_str()).collect(),
            stages: scene.map_or_else(Vec::new, |scene| {
                let stages = scene.stages.iter();
                stages.map(|stage| stage.name.as_str()).collect()
            }),
            bolts: scene.map_or_else(Vec::new, |scene| {
                let bolts = scene.bolts.iter();
                bolts.map(|bolts| bolts.name.as_str()).collect()
            }),
            variables: &self.variables,
        };
        named.files()
    }
    /// What was found while the scene was composed.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }
    /// How long the run lasts (s).
    pub fn duration(&self) -> f64 {
        self.duration
    }
    /// The scheme's name.
    pub fn scheme(&self) -> &'static str {
        self.integrator.name()
    }

    /// The stable step and the element that limits it. The first call costs some tens of force
    /// evaluations.
    ///
    /// # Errors
    /// If the scheme is unstable at every step under the scene's damping.
    pub fn stable_step(&mut self) -> Result<StableStep, Error> {
        let stable = self.model.stable_step(self.integrator.as_ref());
        stable.map_err(|error| self.source.1.put(&self.source.0, error.into()))
    }
    /// The step that a run takes (s). Intervals of output that are shorter become remarks.
    ///
    /// # Errors
    /// A given step that is above the stable one, or as [`stable_step`](Self::stable_step).
    pub fn step(&mut self) -> Result<f64, Error> {
        let step = match self.step {
            TimeStep::OfStable(share) => share * self.stable_step()?.step,
            TimeStep::Seconds(step) => {
                let limits = self.model.frequency_limits();
                let checked = self.integrator.check(&limits, step);
                checked.map_err(|error| self.source.1.put(&self.source.0, error.into()))?;
                step
            }
        };
        self.check_intervals(step);
        Ok(step)
    }

    /// Adds warnings about output intervals shorter than the step or longer than the run, without repetitions.
    fn check_intervals(&mut self, step: f64) {
        let histories = !self.plan.histories.is_empty() || !self.plan.cuts.is_empty();
        let intervals = [
            ("histories", histories.then_some(self.plan.every)),
            ("energies", self.plan.energies),
            (
                "envelopes",
                self.plan.envelope.as_ref().map(|wish| wish.every),
            ),
            ("snapshots", self.plan.snapshots.map(|wish| wish.every)),
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
            let doubt = match asked {
                Some(interval) if interval < step => SceneDoubt::ShortInterval {
                    what,
                    interval,
                    step,
                },
                Some(interval) if interval > self.duration => SceneDoubt::LongInterval {
                    what,
                    interval,
                    duration: self.duration,
                },
                _ => continue,
            };
            let is_said = |remark: &Remark| {
                let doubt = match remark {
                    Remark::Doubt(doubt) => doubt,
                    _ => return false,
                };
                matches!(
                    doubt,
                    SceneDoubt::ShortInterval { what: said, .. }
                        | SceneDoubt::LongInterval { what: said, .. } if *said == what
                )
            };
            if !self.remarks.iter().any(is_said) {
                self.remarks.push(Remark::Doubt(doubt));
            }
        }
    }

    /// Replaces the scene's step.
    pub fn set_step(&mut self, step: TimeStep) {
        // An error of the step no longer concerns the scene file.
        self.source.0 = None;
        self.step = step;
    }

    /// Goes through the stages of the scene and leaves the body at rest, for several runs to start
    /// from: those of scenes that differ in what makes the body move alone. Nothing if there are none.
    ///
    /// # Errors
    /// A stage that does not come to rest.
    pub fn bring_to_rest(
        &self,
        stop: Option<&Arc<AtomicBool>>,
        sink: Option<Box<dyn StageSink + '_>>,
    ) -> Result<Option<EquilibratedBody>, Error> {
        let Some(staging) = &self.staging else {
            return Ok(None);
        };
        let found = staging.run(stop, sink);
        Ok(Some(found.map_err(|error| {
            self.source.1.put(&self.source.0, error)
        })?))
    }

    /// Runs the scene to its end, through its stages first.
    ///
    /// # Errors
    /// A stage that does not come to rest, a step above the stable one, or, as [`Error::Failed`] with the results until then, what
    /// ended the run before its time.
    pub fn run(mut self, hooks: RunHooks) -> Result<Results, Error> {
        let started = Instant::now();
        let step = self.step()?;
        let mut rested = None;
        if let Some(staging) = &self.staging {
            let body = match hooks.at_rest {
                Some(body) => Ok(body),
                None => staging.run(hooks.stop.as_ref(), hooks.stages),
            };
            let moving = body.and_then(|body| staging.set_in_motion(body));
            let (model, stages) =
                moving.map_err(|error| self.source.1.put(&self.source.0, error))?;
            self.model = model;
            rested = Some(stages);
        }
        if let Some(field) = self.initial.take() {
            let now = (self.model.time(), step);
            let nodes = self.mesh.positions();
            let (displacement, velocity) = field_motion(field.as_ref(), nodes, now)?;
            self.model.set_initial(&displacement, &velocity)?;
        }
        let mut options = self.options(RunOptions::seconds(self.duration), step);
        options.stop = hooks.stop;
        let (recordings, mut observers) = self.observed;
        let taken = Arc::new(AtomicU64::new(0));
        if let (Some(wish), Some(sink)) = (self.plan.snapshots, hooks.snapshots) {
            let cadence = Cadence::Seconds(wish.every);
            let sink = Counted(sink, taken.clone());
            let snapshots = Snapshots::new(&self.mesh, wish.fields, cadence, sink);
            let mut snapshots = snapshots.map_err(ModelError::from)?;
            if self.plan.state.snapshots {
                snapshots = snapshots.with_state(&self.variables);
            }
            observers.push(Box::new(snapshots));
        }
        observers.extend(hooks.observers);
        let mut progress = hooks.progress.unwrap_or_else(|| Box::new(|_| {}));
        let outcome = run_reporting(
            &mut self.model,
            self.integrator.as_ref(),
            &options,
            &mut observers,
            &mut progress,
        );
        let wall_time = started.elapsed();
        let staging = self.staging.as_ref();
        let bolts = staging.map_or_else(Vec::new, |staging| staging.forces(&mut self.model));
        let finish = |report| {
            let snapshots = taken.load(Ordering::Relaxed);
            let mut results = recordings.finish((report, wall_time, snapshots), bolts);
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
                Some(report) => Error::Failed {
                    error,
                    results: Box::new(finish(*report)),
                },
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
        let mut check = EnergyCheck::every((every / step).round().max(1.0) as u64);
        check.limit = limit;
        // Balances by set take a tenth of a step, and tell a fault's set only a little more surely.
        check.by_set = false;
        options.with_energy(check)
    }

    /// Takes some steps with all that is recorded, and tells how long they take; the first and the
    /// last one, which everything looks at, are taken beside. The model has moved afterwards, and
    /// what was recorded belongs to no run.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn time_steps(&mut self, count: u64) -> Result<Duration, Error> {
        let step = self.step()?;
        let options = self.options(RunOptions::steps(count + 2), step);
        let (mut started, mut taken) = (Instant::now(), Duration::ZERO);
        run(
            &mut self.model,
            self.integrator.as_ref(),
            &options,
            &mut self.observed.1,
            &mut |progress| {
                if progress.done == 1 {
                    started = Instant::now();
                }
                if progress.done == count + 1 {
                    taken = started.elapsed();
                }
            },
        )?;
        Ok(taken)
    }
}

/// A sink of any type, and how many snapshots it took.
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
}
