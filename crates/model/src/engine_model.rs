//! Engines, and the models that they build.

use crate::stage::run_stages;
use crate::{
    Fibre, FrequencyBound, FrequencyLimits, HandOverReport, HourglassShare, JointView, Mesh,
    ModelError, ModelSpec, Observer, Program, ProgramError, Progress, RankForecast, Renewal,
    RunError, RunFailure, RunOptions, RunReport, StableStep, Stage, StageError, StageEvent,
    StageReport, State, StaticError, StaticOptions, StaticProgress, StaticReport, Stress,
    TimeIntegrator, Vec3,
};

/// A finite element engine: it builds models from their specification.
pub trait Engine: Send + Sync {
    /// Name of the engine in reports.
    fn name(&self) -> &str;
    /// Checks a specification and builds its model.
    ///
    /// # Errors
    /// An [`EngineError`](crate::EngineError), as the source of [`ModelError::Refused`], that names the node,
    /// element or set; the error of a factory; whatever the engine does not support.
    fn build(&self, spec: ModelSpec) -> Result<Box<dyn EngineModel>, ModelError>;
    /// Whether dynamic runs of the engine can compute the balance of energies; if not, a run that asks for it is refused. True by
    /// default.
    fn balances_energy(&self) -> bool {
        true
    }
    /// Whether the host takes every step of a dynamic run, so that observers at short intervals cost nothing more; an engine
    /// whose device takes the steps between them is slowed down. True by default.
    fn takes_every_step(&self) -> bool {
        true
    }
    /// Whether something is true in all processes that compute with this engine, each of which calls this method; by default
    /// there is this process alone.
    ///
    /// # Errors
    /// A failure of the communication.
    fn is_on_all(&self, own: bool) -> Result<bool, ModelError> {
        Ok(own)
    }
    /// Solves a sequence of construction stages from an initial state, such as [`State::at_rest`] with an initial
    /// stress; returns the final state, from which a dynamic model [starts](ModelSpec::start) with
    /// [`StaticModel::hand_over`], and a report of each stage.
    ///
    /// # Errors
    /// The error of the first stage that fails, see [`StageError`].
    fn run_stages(
        &self,
        mesh: &Mesh,
        first: State,
        stages: &[Stage],
        watch: &mut (dyn FnMut(StageEvent) + Send),
    ) -> Result<(State, Vec<StageReport>), StageError> {
        run_stages(self, mesh, first, stages, watch)
    }
}

/// A model of an engine with its present motion: time, stable step and runs. Nodes and elements are mesh indices.
///
/// What static solutions, stages, fibres, outputs and programs need in addition is behind methods that return none by
/// default, for engines that compute without it.
pub trait EngineModel: Send {
    /// The mesh of the model.
    fn mesh(&self) -> &Mesh;
    /// Present time (s), that of the displacement.
    fn time(&self) -> f64;
    /// Displacement (m) of a node at [`time`](Self::time), in all stages together.
    ///
    /// # Panics
    /// If the node is out of range.
    fn displacement(&self, node: u32) -> Vec3;
    /// Velocity (m/s) of a node, half a step before [`time`](Self::time).
    ///
    /// # Panics
    /// If the node is out of range.
    fn velocity(&self, node: u32) -> Vec3;
    /// Sets the initial motion: displacement (m) at the present time and velocity (m/s) half a step before it, one
    /// per node. Velocity components along supports are set to zero.
    ///
    /// # Errors
    /// Wrong lengths, numbers that are not finite or out of range, tied nodes with different velocities.
    fn set_initial(&mut self, displacement: &[Vec3], velocity: &[Vec3]) -> Result<(), ModelError>;
    /// The stable step of the model under an integration scheme, and the element that limits it.
    ///
    /// # Errors
    /// If the scheme is unstable at every step under the model's damping.
    fn stable_step(&mut self, integrator: &dyn TimeIntegrator) -> Result<StableStep, RunError>;
    /// Integrates the model in time and calls observers; `progress` is called after every step.
    ///
    /// In a step from `t` to `t + dt` observers receive the state at `t`, when the velocities before and after are
    /// both known. The run therefore ends one step after the last output state, and a continued run repeats no
    /// state. Observers receive the last step whatever their cadence, and [`Observer::finish`] is called in every
    /// case.
    ///
    /// # Errors
    /// An option out of range, an unstable step or a saved state of another run, before the first step, all of them if
    /// the engine cannot resume runs; a divergence, a failed element,
    /// constraint or observer, or an energy residual above its limit, during the run, with the report of the steps
    /// before it.
    fn run(
        &mut self,
        integrator: &dyn TimeIntegrator,
        options: &RunOptions,
        observers: &mut [Box<dyn Observer>],
        progress: &mut (dyn FnMut(Progress) + Send),
    ) -> Result<RunReport, RunFailure>;
    /// Masses, joints, stresses and hourglass energies of the model, for outputs and reports; none by default.
    fn output(&self) -> Option<&dyn ModelOutput> {
        None
    }
    /// The state of the body, which can be read and set; none by default.
    fn stateful(&mut self) -> Option<&mut dyn StatefulModel> {
        None
    }
    /// Static solutions of the model; none by default.
    fn statics(&mut self) -> Option<&mut dyn StaticModel> {
        None
    }
    /// Frequencies of the model, and its fibres; none by default.
    fn frequencies(&mut self) -> Option<&mut dyn ModelFrequencies> {
        None
    }
    /// The division of the model among processes, and its programs for other processors; none by default.
    fn distributed(&self) -> Option<&dyn DistributedModel> {
        None
    }
}

/// Masses, joints, stresses and hourglass energies of a model, for outputs and reports.
pub trait ModelOutput {
    /// Lumped mass (kg) of a node.
    ///
    /// # Panics
    /// If the node is out of range.
    fn mass(&self, node: u32) -> f64;
    /// The joints of all constraints, with the state of their node pairs.
    fn joints(&self) -> Vec<JointView<'_>>;
    /// Mean stress change (Pa) of each element of the mesh against its initial stress, from the committed history
    /// variables; zero in absent elements.
    fn stress_changes(&self) -> Vec<Stress>;
    /// Stored hourglass and internal energy of each element set at the present time.
    fn hourglass_shares(&self) -> Vec<HourglassShare>;
}

/// State of the body of a model: motion, stresses, histories and joints, from which stages and runs go on.
pub trait StatefulModel {
    /// Number of time steps taken, those of continued runs included.
    fn steps_taken(&self) -> u64;
    /// The complete state of the body, from which another model of the same mesh continues; additional nodes of
    /// boundaries follow those of the mesh.
    fn state(&mut self) -> State;
    /// Sets the state of the body, from which a run continues as if it had not been interrupted.
    ///
    /// # Errors
    /// A state of other elements, joints or lengths.
    fn set_state(&mut self, state: &State) -> Result<(), ModelError>;
    /// Resets a joint at the present displacement, from which its opening and slip are measured from then on;
    /// returns whether the model has a joint of that name.
    fn renew_joint(&mut self, joint: &str, renewal: Renewal) -> bool;
}

/// Static equilibrium of a model, and the beginning of motion from it.
pub trait StaticModel {
    /// Brings the model into static equilibrium under its loads at its present time. At the end velocities are
    /// zero, and forces that balance the body in addition to its loads are part of its state.
    ///
    /// # Errors
    /// See [`StaticError`]; the model is then in the state of the last converged increment.
    fn equilibrate(
        &mut self,
        options: &StaticOptions,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<StaticReport, StaticError>;
    /// Begins a dynamic stage from the static state that the model started with; without input the body stays at
    /// rest.
    ///
    /// # Errors
    /// [`StaticError::CarriedForcesChanged`] if the forces that hold the body differ from those of the stage before
    /// by more than `tolerance` (0 to 1) times the internal forces; [`StaticError::StressChanges`] if a law would
    /// relax the static stress.
    fn hand_over(&mut self, tolerance: f64) -> Result<HandOverReport, StaticError>;
}

/// Frequencies of a model, which limit its time step.
pub trait ModelFrequencies {
    /// Highest frequency and damping of the model, input of the stability limit of a scheme.
    fn frequency_limits(&mut self) -> FrequencyLimits;
    /// The fibres of the model; none, the default, of models that cannot have fibres.
    fn fibres(&mut self) -> Option<&mut dyn FibreModel> {
        None
    }
}

/// Fibres of a model: nodes whose motion relative to each other has added inertia.
pub trait FibreModel {
    /// Bounds on the frequency of every active element of the mesh by itself, with its own mass, from which
    /// [fibres](Self::set_fibres) are chosen.
    fn element_frequencies(&self) -> Vec<FrequencyBound>;
    /// Sets the fibres of the model, in place of those before, and so its stable step. Those with common nodes, or nodes
    /// that move as one, are one. Static solutions, weight and damping do not know them.
    ///
    /// # Errors
    /// [`EngineError`](crate::EngineError), as the source of [`ModelError::Refused`]: an unknown node or one without
    /// mass, an added inertia out of range, two nodes of joints in one fibre.
    fn set_fibres(&mut self, fibres: &[Fibre]) -> Result<(), ModelError>;
}

/// Division of a model among several processes, and programs of its elements for other processors.
pub trait DistributedModel {
    /// Elements, nodes and messages of each of some ranks that would share this model.
    ///
    /// # Errors
    /// More ranks than the model can be divided into.
    fn rank_forecast(&self, ranks: usize) -> Result<Vec<RankForecast>, ModelError>;
    /// Programs of the elements in dynamic steps of a length (s), [`ProgrammedBlock::program`](crate::ProgrammedBlock::program),
    /// with `forks` forks at most; of equal ones the first alone. In place of those that do not exist the reason.
    fn programs(&self, step: f64, forks: usize) -> Vec<Result<Program, ProgramError>>;
}
