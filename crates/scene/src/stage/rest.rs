//! Static analysis of the stages, and transfer of the body to the dynamic run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use powerhouse_elements::BoltSet;
use powerhouse_model::{
    EXCESS_PORE_PRESSURE, EngineModel, HandOverReport, HistoryField, HistoryVariable, Mesh,
    ModelError, ModelSpec, Stage, StageError, StageEvent, StageModel, StageReport, State,
    StaticError, StaticMethod, StaticProgress, Stress,
};

use super::list::renewal;
use super::water::add_pressures;
use super::{SolutionStates, Timeline};
use crate::in_use::check_in_use;
use crate::{BoltForces, Error, Piece, RunHooks, Scene};

/// Largest permitted change of the nodal forces at the transfer to the dynamic run, over the internal forces: rounding
/// of single precision is below, a lost load above.
const FORCE_TOLERANCE: f64 = 1.0e-3;
/// The same where elements take another material in the run, and their stress becomes an initial one: forces are carried that were
/// internal ones before, so that nothing is compared.
const RENEWED_TOLERANCE: f64 = 1.0;

/// Completed construction stage, in static equilibrium.
#[derive(Debug)]
#[non_exhaustive]
pub struct CompletedStage<'a> {
    /// Index of the stage, from zero.
    pub index: usize,
    /// Number of stages of the scene.
    pub count: usize,
    /// Report of the stage's changes and static solution.
    pub report: &'a StageReport,
    /// Mesh, including inactive elements.
    pub mesh: &'a Mesh,
    /// State of the body: displacement since before the first stage, inactive elements, history variables of laws and
    /// joints.
    pub state: &'a State,
    /// Total stress of each element of the mesh (Pa), mean over the element, including the in-situ stress.
    pub stress: &'a [Stress],
    /// Pressure of the water in the pores of each element of the mesh (Pa), zero in dry ones, by which its effective stress exceeds
    /// the total one; empty if there is no such water.
    pub pore_pressure: &'a [f64],
    /// Names, units and kinds of the history variables of all laws of the body.
    pub variables: &'a [HistoryVariable],
    /// Bolt groups installed so far.
    pub bolts: Vec<&'a BoltSet>,
}

/// Callback with the body at the end of every stage, and the reports of the stages until then, called when the
/// [receiver](StageSink) of the stage has returned.
pub type StageHook<'a> = Box<dyn FnMut(&EquilibratedBody) + Send + 'a>;

/// Receiver of stage progress and results, such as a file writer or a display.
///
/// Its methods are called one after the other, by the thread that computes the stages, which waits for their return.
pub trait StageSink: Send {
    /// Called with the progress of the static solution of a stage, given by its name, many times in a stage; does nothing
    /// by default.
    fn progress(&mut self, _stage: &str, _progress: StaticProgress) {}
    /// Called once with every completed stage, in their order, before the next one begins.
    ///
    /// # Errors
    /// An error ends the run.
    fn completed(&mut self, stage: &CompletedStage) -> Result<(), Error>;
}

/// Equilibrated body: state after the construction stages of a scene, from which dynamic runs of the scene and of its
/// other cases can start.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibratedBody {
    pub(crate) state: State,
    pub(crate) stages: Vec<StageReport>,
}

impl EquilibratedBody {
    /// Body in a state in static equilibrium, with the reports of the stages that lead to it, as from another program
    /// or from a file of another form. Whether a state belongs to a scene is checked at the start of its run.
    pub fn new(state: State, stages: Vec<StageReport>) -> Self {
        Self { state, stages }
    }
    /// State of the body after the last stage.
    pub fn state(&self) -> &State {
        &self.state
    }
    /// Reports of the stages, in their order.
    pub fn stages(&self) -> &[StageReport] {
        &self.stages
    }
}

/// Reports of the stages of a scene, and of the transfer to the dynamic run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StagingOutcome {
    pub(crate) stages: Vec<StageReport>,
    pub(crate) hand_over: HandOverReport,
}

/// Where the stages begin, and receivers of their states.
#[derive(Default)]
pub(crate) struct StagingStart<'a> {
    /// The body after some of the stages.
    pub(crate) completed: Option<EquilibratedBody>,
    /// Callback at the end of every stage.
    pub(crate) keep: Option<StageHook<'a>>,
    pub(crate) solutions: SolutionStates,
}

impl<'a> StagingStart<'a> {
    /// Takes what concerns the stages from the hooks of a run, but for the cancellation flag and the sink.
    pub(crate) fn of(hooks: &mut RunHooks<'a>) -> Self {
        Self {
            completed: hooks.completed_stages.take(),
            keep: hooks.keep_stage.take(),
            solutions: SolutionStates {
                sink: hooks.stage_checkpoints.take(),
                resume: hooks.stage_solution.take(),
            },
        }
    }
}

/// Static analysis of a scene with construction stages.
pub(crate) struct Staging {
    pub(crate) scene: Scene,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) timeline: Timeline,
    pub(crate) variables: Vec<HistoryVariable>,
}

impl Staging {
    /// Axial forces of all bolts in the dynamic model.
    pub(crate) fn forces(&self, model: &mut dyn EngineModel) -> Vec<BoltForces> {
        let mut bolts = self
            .timeline
            .bolts(self.timeline.configurations.len())
            .peekable();
        if bolts.peek().is_none() {
            return Vec::new();
        }
        let Some(stateful) = model.stateful() else {
            return Vec::new();
        };
        let state = stateful.state();
        let forces = bolts.filter_map(|bolts| BoltForces::of(bolts, &self.scene.mesh, &state));
        forces.collect()
    }

    /// Dynamic model of an equilibrated body, and the outcome of the stages.
    pub(crate) fn set_in_motion(
        &self,
        body: EquilibratedBody,
    ) -> Result<(Box<dyn EngineModel>, StagingOutcome), Error> {
        let EquilibratedBody { state, stages } = body;
        let expected = self.timeline.bare_state(self.scene.mesh.node_count());
        if state.absent != expected.absent
            || state.displacement.len() != expected.displacement.len()
        {
            return Err(Error::ForeignBody {
                found: state.displacement.len(),
                found_absent: state.absent.len(),
                expected: expected.displacement.len(),
                expected_absent: expected.absent.len(),
            });
        }
        let (model, hand_over) = self.hand_over(state)?;
        Ok((model, StagingOutcome { stages, hand_over }))
    }

    /// Computes all stages.
    pub(crate) fn run(
        &self,
        stop: Option<&Arc<AtomicBool>>,
        mut sink: Option<Box<dyn StageSink + '_>>,
        start: StagingStart<'_>,
    ) -> Result<EquilibratedBody, Error> {
        let StagingStart {
            completed,
            mut keep,
            solutions,
        } = start;
        let mesh = &*self.scene.mesh;
        let mut body = completed.unwrap_or_else(|| self.before_stages());
        let names = body.stages.iter().map(|report| &report.name);
        let own = self.scene.stages.iter().map(|stage| &stage.name);
        if !names.clone().eq(own.clone().take(body.stages.len())) {
            return Err(Error::ForeignStages {
                found: names.cloned().collect(),
                expected: own.cloned().collect(),
            });
        }
        let first = body.stages.len();
        for index in first..self.scene.stages.len() {
            let goes_on = stop.is_none_or(|stop| !stop.load(Ordering::Relaxed));
            if !self.scene.engine.is_on_all(goes_on)? {
                let stage = self.scene.stages[index].name.clone();
                return Err(Error::Interrupted { stage });
            }
            let state = core::mem::take(&mut body.state);
            let (state, stress, report) =
                self.equilibrate((index, &solutions), state, stop, &mut sink)?;
            body.state = state;
            // Neither files nor a kept body of a mesh that has changed.
            check_in_use(self.scene.in_use.as_ref(), self.scene.engine.as_ref())?;
            if let Some(sink) = &mut sink {
                sink.completed(&CompletedStage {
                    index,
                    count: self.scene.stages.len(),
                    report: &report,
                    mesh,
                    state: &body.state,
                    stress: &stress,
                    pore_pressure: &self.pore_pressure(index, &body.state),
                    variables: &self.variables,
                    bolts: self.timeline.bolts(index + 1).collect(),
                })?;
            }
            body.stages.push(report);
            if let Some(keep) = &mut keep {
                keep(&body);
            }
        }
        Ok(body)
    }

    /// The body before the first stage.
    fn before_stages(&self) -> EquilibratedBody {
        let mesh = &*self.scene.mesh;
        let mut state = State::at_rest(mesh.node_count());
        if let Some(stress) = &self.scene.in_situ_stress {
            state.initial_stress = stress.of_elements(mesh);
            state.initial_slope = stress.slopes_of_elements(mesh);
        }
        if !self.timeline.absent.is_empty() {
            state.remove(&self.timeline.absent);
        }
        EquilibratedBody {
            state,
            stages: Vec::with_capacity(self.scene.stages.len()),
        }
    }

    /// Computes one stage: state and stress after it, and its report.
    fn equilibrate(
        &self,
        (index, solutions): (usize, &SolutionStates),
        mut state: State,
        stop: Option<&Arc<AtomicBool>>,
        sink: &mut Option<Box<dyn StageSink + '_>>,
    ) -> Result<(State, Vec<Stress>, StageReport), Error> {
        let (mesh, stage) = (&*self.scene.mesh, &self.scene.stages[index]);
        let configuration = &self.timeline.configurations[index];
        let changes = &configuration.pressure_changes;
        add_pressures(&mut state, changes, mesh.element_count());
        let body: Box<StageModel> = Box::new(|spec| {
            let spec = match stop {
                Some(stop) => spec.stop_on(stop.clone()),
                None => spec,
            };
            let spec = solutions.of_stage(index, spec);
            let built = self.static_model(spec, index);
            built.map_err(|error| ModelError::refused("stage", error))
        });
        let stage = Stage::new(&stage.name, body)
            .excavate(&configuration.excavated)
            .cast(&configuration.cast)
            .renew_joints(configuration.renewed.iter().cloned())
            .options(stage.options);
        let mut stress = Vec::new();
        let mut watch = |event: StageEvent| match event {
            StageEvent::Progress { stage, progress } => {
                if let Some(sink) = sink {
                    sink.progress(stage, progress);
                }
            }
            StageEvent::Equilibrated { model, .. } => {
                let output = model.output();
                stress = output.map_or_else(Vec::new, |output| output.stress_changes());
            }
            _ => {}
        };
        let (state, mut reports) = self
            .scene
            .engine
            .run_stages(mesh, state, &[stage], &mut watch)
            .map_err(|error| match error {
                StageError::NotEquilibrated {
                    stage,
                    source: StaticError::Interrupted,
                } => Error::Interrupted { stage },
                other => other.into(),
            })?;
        for (change, initial) in stress.iter_mut().zip(&state.initial_stress) {
            *change = Stress(core::array::from_fn(|i| change.0[i] + initial.0[i]));
        }
        let report = reports.swap_remove(0);
        Ok((state, stress, report))
    }

    /// Pressure (Pa) of the water in the pores of each element after a stage, zero in dry and absent ones; empty if there is no
    /// such water.
    fn pore_pressure(&self, index: usize, state: &State) -> Vec<f64> {
        let (scene, configuration) = (&self.scene, &self.timeline.configurations[index]);
        let mut pressures = Vec::new();
        for piece in &self.pieces {
            let own = scene.parts[piece.part].static_material.as_ref();
            let of_stage = configuration.materials.get(&piece.part).or(own);
            let material = of_stage.unwrap_or(&piece.material).clone();
            if material.pore_water().is_none() {
                continue;
            }
            let material = configuration.water.of(material);
            pressures.resize(scene.mesh.element_count(), 0.0);
            let there = |element: &&u32| configuration.present[**element as usize];
            for &element in piece.elements.iter().filter(there) {
                let height = scene.mesh.centroid(element).z;
                pressures[element as usize] = material.law().pore_pressure(element, height);
            }
        }
        let of_excess = |field: &&HistoryField| field.name == EXCESS_PORE_PRESSURE.name;
        for field in state.history.iter().filter(of_excess) {
            let values = field.values.chunks_exact(field.points.max(1));
            for (&element, values) in field.elements.iter().zip(values) {
                if let Some(pressure) = pressures.get_mut(element as usize) {
                    *pressure += EXCESS_PORE_PRESSURE.of_element(values.iter().copied());
                }
            }
        }
        pressures
    }

    /// Adds elements, supports, joints and bolts of a stage to its static model.
    fn static_model<'a>(
        &self,
        mut spec: ModelSpec<'a>,
        index: usize,
    ) -> Result<ModelSpec<'a>, Error> {
        let (scene, configuration) = (&self.scene, &self.timeline.configurations[index]);
        for piece in &self.pieces {
            let part = &scene.parts[piece.part];
            let of_stage = configuration.materials.get(&piece.part);
            let other = of_stage.or(part.static_material.as_ref());
            let factory = piece.resting(part, other, &configuration.water);
            spec = spec.elements(piece.elements.clone(), factory);
        }
        let mut spec = scene.acted_on(spec, Some(index));
        for support in scene.stages[..=index]
            .iter()
            .flat_map(|stage| &stage.supports)
        {
            spec = spec.support(support.clone());
        }
        let closing = |name: &str| scene.stages[index].closing(name);
        for load in &configuration.joint_loads {
            spec = spec.load(Box::new(load.clone()));
        }
        let joints = scene.constraints_of_joints(closing, &configuration.in_joints)?;
        for joint in joints.0 {
            spec = spec.constraint(Box::new(joint));
        }
        for bolts in self.timeline.bolts(index + 1) {
            spec = spec.embed(Box::new(bolts.clone()));
        }
        Ok(match scene.threads_taken() {
            Some(threads) => spec.threads(threads),
            None => spec,
        })
    }

    /// Builds the dynamic model from the state of the last stage.
    fn hand_over(&self, mut state: State) -> Result<(Box<dyn EngineModel>, HandOverReport), Error> {
        let scene = &self.scene;
        state.time = scene.start;
        let stages = &scene.stages;
        let renewal_of = |name: &str| renewal(stages, stages.len(), name);
        (state.joints).retain(|joint| renewal_of(&joint.name).is_none());
        // Stages have no time: what has slipped or opened in them has done so when the run starts.
        for record in state.joints.iter_mut().flat_map(|joint| &mut joint.records) {
            for first in [&mut record.first_slip, &mut record.first_crack] {
                *first = first.map(|_| scene.start);
            }
        }
        let tolerance = if self.renew_materials(&mut state)? {
            RENEWED_TOLERANCE
        } else {
            FORCE_TOLERANCE
        };
        let spec = ModelSpec::new(&scene.mesh).start(state);
        let found = scene.moving(spec, &self.pieces, Some(&self.timeline), &mut Vec::new())?;
        let mut model = scene.engine.build(found.spec)?;
        if let Some(stateful) = model.stateful() {
            for joint in &scene.joints {
                if let Some(renewal) = renewal_of(&joint.name) {
                    stateful.renew_joint(&joint.name, renewal);
                }
            }
        }
        let report = match model.statics() {
            Some(statics) => statics.hand_over(tolerance),
            None => Err(StaticError::NoMethod {
                engine: scene.engine.name().into(),
                method: StaticMethod::default().name(),
            }),
        };
        let report = report.map_err(|source| Error::HandOver { source })?;
        Ok((model, report))
    }

    /// Lets the parts with a static material begin the run anew: their stress becomes the initial stress of the material of the
    /// run, at the present displacement. Returns whether there are such parts.
    fn renew_materials(&self, state: &mut State) -> Result<bool, Error> {
        let (scene, last) = (&self.scene, self.timeline.configurations.len() - 1);
        let present = &self.timeline.configurations[last].present;
        let renewed = self.pieces.iter();
        let renewed = renewed.filter(|piece| scene.parts[piece.part].static_material.is_some());
        let mut renewed: Vec<u32> = renewed
            .flat_map(|piece| piece.elements.iter().copied())
            .filter(|&element| present[element as usize])
            .collect();
        if renewed.is_empty() {
            return Ok(false);
        }
        renewed.sort_unstable();
        let spec = ModelSpec::new(&scene.mesh).start(state.clone());
        let model = scene.engine.build(self.static_model(spec, last)?)?;
        let output = model.output();
        let changes = output
            .ok_or_else(|| ModelError::lacking("stresses"))?
            .stress_changes();
        let mut stress = state.initial_stress.clone();
        stress.resize(scene.mesh.element_count(), Stress::default());
        let slope = state.initial_slope.clone();
        state.cast(&renewed);
        state.initial_slope = slope;
        state.initial_stress.resize(stress.len(), Stress::default());
        for element in renewed.into_iter().map(|element| element as usize) {
            let (before, change) = (stress[element].0, changes[element].0);
            state.initial_stress[element] = Stress(core::array::from_fn(|i| before[i] + change[i]));
        }
        Ok(true)
    }
}
