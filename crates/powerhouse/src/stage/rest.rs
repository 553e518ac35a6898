//! From stage to stage, and into motion.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use powerhouse_explicit_core::{
    BoltSet, HandOverReport, Model, ModelBuilder, Stage, StageError, StageEvent, StageModel,
    StageReport, StaticError, StaticProgress, run_stages,
};
use powerhouse_model::{HistoryVariable, Mesh, ModelError, State, Stress};

use super::Timeline;
use super::list::renewal;
use crate::scene::Piece;
use crate::{BoltForces, Error, Scene};

/// How much what holds a body may change when it is handed over, over its internal forces: the digits
/// of single precision, not a load that was lost.
const SAME: f64 = 1.0e-3;

/// A stage that has come to rest.
#[derive(Debug)]
#[non_exhaustive]
pub struct CompletedStage<'a> {
    /// Its place among the stages, from zero.
    pub index: usize,
    /// How many stages there are.
    pub count: usize,
    /// What it took and did.
    pub report: &'a StageReport,
    /// The mesh, elements that are not there among the others.
    pub mesh: &'a Mesh,
    /// The body: displacement, absent elements, history variables of laws and joints.
    pub state: &'a State,
    /// Mean stress (Pa), initial stress included, one per element of the mesh.
    pub stress: &'a [Stress],
    /// The history variables of the laws.
    pub variables: &'a [HistoryVariable],
    /// The bolts that are installed by now.
    pub bolts: Vec<&'a BoltSet>,
}

/// Is shown stages: a writer of their results, or a display.
pub trait StageSink: Send {
    /// Sees how far the static solution of a stage is.
    fn progress(&mut self, _stage: &str, _progress: StaticProgress) {}
    /// Takes a stage that has come to rest.
    ///
    /// # Errors
    /// Ends the run.
    fn at_rest(&mut self, stage: &CompletedStage) -> Result<(), Error>;
}

/// A body at the end of the stages of a scene, from which it and its other cases can be set in motion.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibratedBody {
    pub(crate) state: State,
    pub(crate) stages: Vec<StageReport>,
}

impl EquilibratedBody {
    /// Its state.
    pub fn state(&self) -> &State {
        &self.state
    }
    /// What the stages took and did.
    pub fn stages(&self) -> &[StageReport] {
        &self.stages
    }
}

/// What the stages of a scene came to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StagingOutcome {
    pub(crate) stages: Vec<StageReport>,
    pub(crate) hand_over: HandOverReport,
}

/// A scene whose body goes through stages before it moves.
pub(crate) struct Staging {
    pub(crate) scene: Scene,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) timeline: Timeline,
    pub(crate) variables: Vec<HistoryVariable>,
}

impl Staging {
    /// The axial forces of all bolts as they are in the model that moves.
    pub(crate) fn forces(&self, model: &mut Model) -> Vec<BoltForces> {
        let mut bolts = self.timeline.bolts(self.timeline.moments.len()).peekable();
        if bolts.peek().is_none() {
            return Vec::new();
        }
        let state = model.state();
        let forces = bolts.filter_map(|bolts| BoltForces::of(bolts, &self.scene.mesh, &state));
        forces.collect()
    }

    /// Sets a body that its stages have brought to rest in motion: its model, and what the stages came
    /// to.
    pub(crate) fn set_in_motion(
        &self,
        body: EquilibratedBody,
    ) -> Result<(Model, StagingOutcome), Error> {
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

    /// Goes through the stages.
    pub(crate) fn run(
        &self,
        stop: Option<&Arc<AtomicBool>>,
        mut sink: Option<Box<dyn StageSink + '_>>,
    ) -> Result<EquilibratedBody, Error> {
        let mesh = &*self.scene.mesh;
        let mut state = State::at_rest(mesh.node_count());
        if let Some(stress) = &self.scene.in_situ_stress {
            state.initial_stress = stress.of_elements(mesh);
        }
        if !self.timeline.absent.is_empty() {
            state.remove(&self.timeline.absent);
        }
        let mut stages = Vec::with_capacity(self.scene.stages.len());
        for (index, stage) in self.scene.stages.iter().enumerate() {
            if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
                let stage = stage.name.clone();
                return Err(Error::Interrupted { stage });
            }
            let stress;
            let report;
            (state, stress, report) = self.bring_to_rest(index, state, stop, &mut sink)?;
            if let Some(sink) = &mut sink {
                sink.at_rest(&CompletedStage {
                    index,
                    count: self.scene.stages.len(),
                    report: &report,
                    mesh,
                    state: &state,
                    stress: &stress,
                    variables: &self.variables,
                    bolts: self.timeline.bolts(index + 1).collect(),
                })?;
            }
            stages.push(report);
        }
        Ok(EquilibratedBody { state, stages })
    }

    /// One stage: the state afterwards, its stress, and what it took.
    fn bring_to_rest(
        &self,
        index: usize,
        state: State,
        stop: Option<&Arc<AtomicBool>>,
        sink: &mut Option<Box<dyn StageSink + '_>>,
    ) -> Result<(State, Vec<Stress>, StageReport), Error> {
        let (mesh, stage) = (&*self.scene.mesh, &self.scene.stages[index]);
        let moment = &self.timeline.moments[index];
        let body: Box<StageModel> = Box::new(|builder| {
            let builder = match stop {
                Some(stop) => builder.stop_on(stop.clone()),
                None => builder,
            };
            let built = self.resting(builder, index);
            built.map_err(|error| ModelError::refused("stage", error))
        });
        let engine = Stage::new(&stage.name, body)
            .excavate(&moment.excavated)
            .cast(&moment.cast)
            .renew_joints(moment.renewed.iter().cloned())
            .options(stage.options);
        let mut stress = Vec::new();
        let mut watch = |event: StageEvent| match event {
            StageEvent::Progress { stage, progress } => {
                if let Some(sink) = sink {
                    sink.progress(stage, progress);
                }
            }
            StageEvent::Equilibrated { model, .. } => stress = model.stress_changes(),
            _ => {}
        };
        let (state, mut reports) =
            run_stages(mesh, state, &[engine], &mut watch).map_err(|error| match error {
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

    /// The model of a stage.
    fn resting<'a>(
        &self,
        mut builder: ModelBuilder<'a>,
        index: usize,
    ) -> Result<ModelBuilder<'a>, Error> {
        let (scene, moment) = (&self.scene, &self.timeline.moments[index]);
        for piece in &self.pieces {
            let own = moment.materials.get(&piece.part);
            let factory = piece.resting(&scene.parts[piece.part], own);
            builder = builder.elements(piece.elements.clone(), factory);
        }
        let mut builder = scene.acted_on(builder, Some(index));
        for support in scene.stages[..=index]
            .iter()
            .flat_map(|stage| &stage.supports)
        {
            builder = builder.support(support.clone());
        }
        let closing = |name: &str| scene.stages[index].closing(name);
        for joint in scene.constraints_of_joints(closing)?.0 {
            builder = builder.constraint(Box::new(joint));
        }
        for bolts in self.timeline.bolts(index + 1) {
            builder = builder.embed(bolts.block());
        }
        Ok(match scene.threads_taken() {
            Some(threads) => builder.threads(threads),
            None => builder,
        })
    }

    /// The model that moves, from the state of the last stage.
    fn hand_over(&self, mut state: State) -> Result<(Model, HandOverReport), Error> {
        let scene = &self.scene;
        state.time = scene.start;
        let stages = &scene.stages;
        let anew = |name: &str| renewal(stages, stages.len(), name);
        (state.joints).retain(|joint| anew(&joint.name).is_none());
        let builder = Model::builder(&scene.mesh).start(state);
        let found = scene.moving(builder, &self.pieces, Some(&self.timeline), &mut Vec::new())?;
        let mut model = found.builder.build()?;
        for joint in &scene.joints {
            if let Some(renewal) = anew(&joint.name) {
                model.renew_joint(&joint.name, renewal);
            }
        }
        let report = model
            .hand_over(SAME)
            .map_err(|source| Error::HandOver { source })?;
        Ok((model, report))
    }
}
