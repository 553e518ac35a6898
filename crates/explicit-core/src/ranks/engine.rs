//! The engine on several ranks as others see it: by the traits of the model crate.

use powerhouse_model::{
    Engine, EngineModel, FrequencyLimits, HandOverReport, HourglassShare, JointView, Mesh,
    ModelError, ModelFrequencies, ModelOutput, ModelSpec, Observer, Progress, RankError, Ranks,
    Renewal, RunError, RunFailure, RunOptions, RunReport, StableStep, State, StatefulModel,
    StaticError, StaticModel, StaticOptions, StaticProgress, StaticReport, Stress, TimeIntegrator,
    Vec3,
};

use super::communicator::{Communicator, rank_failure};
use super::model::RankModel;
use super::whole::{JointValues, vector};

/// The explicit engine on several ranks: each of them builds and computes a part of every model.
///
/// Every rank runs the same program: it builds models from equal specifications and calls the same methods of them in the
/// same order. A model has the mass and motion of the whole body on rank 0, and those of its own nodes on the others, where the
/// rest is NaN; states, stresses and joints are those of the whole body on every rank. Observers are called on rank 0 alone, with the
/// state of the whole body.
///
/// ```
/// use powerhouse_explicit_core::{Explicit, ExplicitOnRanks};
/// use powerhouse_model::{Engine, ThreadRanks};
/// let names = ThreadRanks::run(2, |ranks| {
///     let engine = ExplicitOnRanks::new(Box::new(ranks));
///     Ok((engine.name().to_owned(), engine.rank(), engine.rank_count()))
/// });
/// let expected = |rank| Ok((Explicit.name().to_owned(), rank, 2));
/// assert_eq!(names, [expected(0), expected(1)]);
/// ```
pub struct ExplicitOnRanks {
    team: Communicator,
}

impl ExplicitOnRanks {
    /// The engine of one rank among others.
    pub fn new(ranks: Box<dyn Ranks>) -> Self {
        Self {
            team: Communicator::new(ranks),
        }
    }
    /// Number of this rank, from 0.
    pub fn rank(&self) -> usize {
        self.team.rank()
    }
    /// Number of ranks.
    pub fn rank_count(&self) -> usize {
        self.team.count()
    }
    /// Checks that a value is the same on all ranks, such as a checksum of their input.
    ///
    /// # Errors
    /// [`EngineError::RanksDiffer`](powerhouse_model::EngineError::RanksDiffer) with the name of the value, and a failure of
    /// the communication.
    pub fn check_same(&self, what: &'static str, value: u64) -> Result<(), ModelError> {
        self.team.check_same(what, value)
    }

    /// Reports whether this rank has failed, with a message; the same for all ranks.
    ///
    /// # Errors
    /// The failure of another rank, the lowest one, with its message; a failure of the communication.
    pub fn agree(&self, failure: Option<&str>) -> Result<(), ModelError> {
        let own = failure.map_or(Ok(()), |text| Err(ModelError::refused("this rank", text)));
        match (self.team.agree(own), failure) {
            (Err(error), None) => Err(error),
            _ => Ok(()),
        }
    }
    /// The bytes of rank 0 on all ranks.
    ///
    /// # Errors
    /// A failure of the communication.
    pub fn of_first(&self, bytes: Vec<u8>) -> Result<Vec<u8>, RankError> {
        let bytes = self.team.of_rank(0, bytes);
        self.team.check().map(|()| bytes)
    }
    /// A number of each rank, in their order, on all ranks.
    ///
    /// # Errors
    /// A failure of the communication.
    pub fn of_all(&self, own: u64) -> Result<Vec<u64>, ModelError> {
        self.team.all(&own)
    }
    /// Whether something is true on all ranks.
    ///
    /// # Errors
    /// A failure of the communication.
    pub fn all(&self, own: bool) -> Result<bool, RankError> {
        let least = self.team.least(u64::from(own));
        self.team.check().map(|()| least == 1)
    }
}

impl Engine for ExplicitOnRanks {
    fn name(&self) -> &str {
        crate::NAME
    }
    fn is_on_all(&self, own: bool) -> Result<bool, ModelError> {
        let found = self.all(own);
        found.map_err(|failure| rank_failure(&failure))
    }
    fn build(&self, spec: ModelSpec) -> Result<Box<dyn EngineModel>, ModelError> {
        let part = RankModel::build_on(spec, self.team.clone())?;
        Ok(Box::new(WholeModel::of(part)?))
    }
}

/// Motion of a node that this rank does not know.
const UNKNOWN: Vec3 = Vec3::new(f64::NAN, f64::NAN, f64::NAN);

/// A model of which each rank computes a part, with the state of the whole body on rank 0. The other ranks know the motion
/// of their own nodes; that of others is NaN there.
struct WholeModel {
    part: RankModel,
    /// Lumped mass (kg) of each mesh node; empty on other ranks than 0.
    mass: Vec<f64>,
    /// Displacement (m) and velocity (m/s) of each mesh node; empty on other ranks than 0.
    motion: Vec<[f64; 6]>,
    joints: Vec<JointValues>,
}

impl WholeModel {
    fn of(part: RankModel) -> Result<Self, ModelError> {
        let model = part.local();
        let mass = model.of_all_nodes_at_first(|node| [model.mass[node]]);
        let mut whole = Self {
            mass: mass.into_iter().map(|[mass]| mass).collect(),
            motion: Vec::new(),
            joints: Vec::new(),
            part,
        };
        whole.refresh()?;
        Ok(whole)
    }

    /// Gathers the motion of the body on rank 0, and the state of its joints on every rank.
    fn refresh(&mut self) -> Result<(), ModelError> {
        let model = self.part.local();
        self.motion = model.of_all_nodes_at_first(|node| {
            let (u, v) = (model.displacement_of(node), model.velocity_of(node));
            [u.x, u.y, u.z, v.x, v.y, v.z]
        });
        self.joints = model.all_joints()?;
        Ok(())
    }

    /// The same after an operation, whose result comes first.
    fn refreshed<T, E: From<RankError>>(&mut self, result: Result<T, E>) -> Result<T, E> {
        let refreshed = self.refresh();
        let value = result?;
        let team = &self.part.local().ranks.team;
        let failed = |error: ModelError| match team.check() {
            Err(failure) => failure,
            Ok(()) => RankError::Failed {
                rank: team.rank(),
                reason: error.to_string(),
            },
        };
        refreshed.map_err(failed)?;
        Ok(value)
    }
}

impl EngineModel for WholeModel {
    fn mesh(&self) -> &Mesh {
        self.part.local().mesh()
    }
    fn time(&self) -> f64 {
        self.part.time()
    }
    fn displacement(&self, node: u32) -> Vec3 {
        match self.part.rank() {
            0 => vector(&self.motion[node as usize], 0),
            _ => self.part.displacement(node).unwrap_or(UNKNOWN),
        }
    }
    fn velocity(&self, node: u32) -> Vec3 {
        match self.part.rank() {
            0 => vector(&self.motion[node as usize], 3),
            _ => self.part.velocity(node).unwrap_or(UNKNOWN),
        }
    }
    fn set_initial(&mut self, displacement: &[Vec3], velocity: &[Vec3]) -> Result<(), ModelError> {
        self.part.set_initial(displacement, velocity)?;
        self.refresh()
    }
    fn stable_step(&mut self, integrator: &dyn TimeIntegrator) -> Result<StableStep, RunError> {
        self.part.stable_step(integrator)
    }
    fn run(
        &mut self,
        integrator: &dyn TimeIntegrator,
        options: &RunOptions,
        observers: &mut [Box<dyn Observer>],
        progress: &mut (dyn FnMut(Progress) + Send),
    ) -> Result<RunReport, RunFailure> {
        let report = self.part.run(integrator, options, observers, progress)?;
        self.refreshed(Ok(report))
            .map_err(|error: RunError| RunFailure {
                error,
                report: None,
            })
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
}

impl ModelOutput for WholeModel {
    fn mass(&self, node: u32) -> f64 {
        match self.part.rank() {
            0 => self.mass[node as usize],
            _ => self.part.mass(node).unwrap_or(f64::NAN),
        }
    }
    fn joints(&self) -> Vec<JointView<'_>> {
        let joints = self.part.local().ranks.joints.iter();
        let views = joints.zip(&self.joints);
        views.map(|(joint, values)| joint.view(values)).collect()
    }
    fn stress_changes(&self) -> Vec<Stress> {
        self.part.local().stress_changes()
    }
    fn hourglass_shares(&self) -> Vec<HourglassShare> {
        self.part.local().hourglass_shares()
    }
}

impl StatefulModel for WholeModel {
    fn steps_taken(&self) -> u64 {
        self.part.steps_taken()
    }
    fn state(&mut self) -> State {
        self.part.local_mut().state()
    }
    fn set_state(&mut self, state: &State) -> Result<(), ModelError> {
        let model = self.part.local_mut();
        let set = model.set_state(state);
        model.ranks.team.agree(set)?;
        self.refresh()
    }
    fn renew_joint(&mut self, joint: &str, renewal: Renewal) -> bool {
        self.part.local_mut().renew_joint(joint, renewal);
        // The joints are those of before where the communication has failed, which the next operation reports.
        let _ = self.refresh();
        ModelOutput::joints(self)
            .iter()
            .any(|view| view.name == joint)
    }
}

impl StaticModel for WholeModel {
    fn equilibrate(
        &mut self,
        options: &StaticOptions,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<StaticReport, StaticError> {
        let found = self.part.local_mut().equilibrate(options, progress);
        self.refreshed(found)
    }
    fn hand_over(&mut self, tolerance: f64) -> Result<HandOverReport, StaticError> {
        let found = self.part.local_mut().hand_over(tolerance);
        self.refreshed(found)
    }
}

impl ModelFrequencies for WholeModel {
    fn frequency_limits(&mut self) -> FrequencyLimits {
        self.part.local_mut().frequency_limits()
    }
}
