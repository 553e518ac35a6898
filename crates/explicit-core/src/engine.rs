//! The engine as others see it: by the traits of the model crate.

use powerhouse_model::{
    DistributedModel, Engine, EngineModel, Fibre, FibreModel, FrequencyBound, FrequencyLimits,
    HandOverReport, HourglassShare, JointView, Mesh, ModelError, ModelFrequencies, ModelOutput,
    ModelSpec, Observer, Program, ProgramError, Progress, RankForecast, Renewal, RunError,
    RunFailure, RunOptions, RunReport, StableStep, State, StatefulModel, StaticError, StaticModel,
    StaticOptions, StaticProgress, StaticReport, Stress, TimeIntegrator, Vec3,
};

use crate::{BuildModel, Model, run_reporting};

/// Name of this engine in reports.
pub(crate) const NAME: &str = "explicit-core";

/// The explicit engine of this crate: element blocks in parallel on the threads of one machine, with results that
/// are bitwise independent of their number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Explicit;

impl Engine for Explicit {
    fn name(&self) -> &str {
        NAME
    }
    fn build(&self, spec: ModelSpec) -> Result<Box<dyn EngineModel>, ModelError> {
        Ok(Box::new(spec.build()?))
    }
}

impl EngineModel for Model {
    fn mesh(&self) -> &Mesh {
        self.mesh()
    }
    fn time(&self) -> f64 {
        self.time()
    }
    fn displacement(&self, node: u32) -> Vec3 {
        self.displacement(node)
    }
    fn velocity(&self, node: u32) -> Vec3 {
        self.velocity(node)
    }
    fn set_initial(&mut self, displacement: &[Vec3], velocity: &[Vec3]) -> Result<(), ModelError> {
        self.set_initial(displacement, velocity)
    }
    fn stable_step(&mut self, integrator: &dyn TimeIntegrator) -> Result<StableStep, RunError> {
        self.stable_step(integrator)
    }
    fn run(
        &mut self,
        integrator: &dyn TimeIntegrator,
        options: &RunOptions,
        observers: &mut [Box<dyn Observer>],
        progress: &mut (dyn FnMut(Progress) + Send),
    ) -> Result<RunReport, RunFailure> {
        run_reporting(self, integrator, options, observers, progress)
    }
    fn output(&self) -> Option<&dyn ModelOutput> {
        Some(self)
    }
    fn stateful(&mut self) -> Option<&mut dyn StatefulModel> {
        Some(self)
    }
    fn statics(&mut self) -> Option<&mut dyn StaticModel> {
        Some(self)
    }
    fn frequencies(&mut self) -> Option<&mut dyn ModelFrequencies> {
        Some(self)
    }
    fn distributed(&self) -> Option<&dyn DistributedModel> {
        Some(self)
    }
}

impl ModelOutput for Model {
    fn mass(&self, node: u32) -> f64 {
        self.mass(node)
    }
    fn joints(&self) -> Vec<JointView<'_>> {
        self.joints().collect()
    }
    fn stress_changes(&self) -> Vec<Stress> {
        self.stress_changes()
    }
    fn hourglass_shares(&self) -> Vec<HourglassShare> {
        self.hourglass_shares()
    }
}

impl StatefulModel for Model {
    fn steps_taken(&self) -> u64 {
        self.steps_taken()
    }
    fn state(&mut self) -> State {
        self.state()
    }
    fn set_state(&mut self, state: &State) -> Result<(), ModelError> {
        self.set_state(state)
    }
    fn renew_joint(&mut self, joint: &str, renewal: Renewal) -> bool {
        self.renew_joint(joint, renewal)
    }
}

impl StaticModel for Model {
    fn equilibrate(
        &mut self,
        options: &StaticOptions,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<StaticReport, StaticError> {
        self.equilibrate(options, progress)
    }
    fn hand_over(&mut self, tolerance: f64) -> Result<HandOverReport, StaticError> {
        self.hand_over(tolerance)
    }
}

impl ModelFrequencies for Model {
    fn frequency_limits(&mut self) -> FrequencyLimits {
        self.frequency_limits()
    }
    fn fibres(&mut self) -> Option<&mut dyn FibreModel> {
        if self.takes_fibres() {
            Some(self)
        } else {
            None
        }
    }
}

impl FibreModel for Model {
    fn element_frequencies(&self) -> Vec<FrequencyBound> {
        self.element_frequencies().unwrap_or_default()
    }
    fn set_fibres(&mut self, fibres: &[Fibre]) -> Result<(), ModelError> {
        self.set_fibres(fibres)
    }
}

impl DistributedModel for Model {
    fn rank_forecast(&self, ranks: usize) -> Result<Vec<RankForecast>, ModelError> {
        Ok(self.rank_forecast(ranks)?)
    }
    fn programs(&self, step: f64, forks: usize) -> Vec<Result<Program, ProgramError>> {
        let mut programs = Vec::new();
        for block in &self.blocks {
            let program = block.program(step, forks);
            if !programs.contains(&program) {
                programs.push(program);
            }
        }
        programs
    }
}
