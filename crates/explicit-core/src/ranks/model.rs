//! The part of a model that one rank computes.

use powerhouse_model::{
    FrequencyLimits, ModelError, ModelSpec, Observer, Progress, RankError, Ranks, RunError,
    RunFailure, RunOptions, RunReport, StableStep, TimeIntegrator, Vec3,
};

use super::communicator::{Communicator, rank_failure};
use super::exchange::Traffic;
use crate::model::build_on;
use crate::partition::Partition;
use crate::{Model, run_reporting};

/// The part of a model that one of several ranks computes: it has the blocks that the
/// [distribution](crate::Distribution) gives to this rank, and exchanges forces with the others in every step.
///
/// Every rank builds it from an equal specification and calls the same methods in the same order. The motion of a node is
/// the same to the bit on every rank that has it, and as in a [`Model`] on one rank, with any number of ranks and threads.
/// The specification should name the block size: there must be a block for each rank, and results depend on it by rounding.
///
/// What can be computed on several ranks: all elements, laws, boundary conditions, loads, absorbing boundaries, embedded
/// elements and constraints; dynamic runs with the stable step and the energy balance, as far as constraints [divide their
/// work](powerhouse_model::DividedConstraint::divided_work); all observers that declare [what they
/// read](powerhouse_model::Observer::reach); checkpoints, which rank 0 receives every sixteenth step at most. Not so profiles.
///
/// ```
/// use powerhouse_elements::SolidKernel;
/// use powerhouse_explicit_core::*;
/// use powerhouse_model::*;
/// # #[derive(Clone)]
/// # struct Linear(ElasticMedium);
/// # impl ConstitutiveLaw for Linear {
/// #     const LINEAR: bool = true;
/// #     fn name(&self) -> &str { "linear" }
/// #     fn medium(&self) -> ElasticMedium { self.0 }
/// #     fn history(&self) -> &'static [HistoryVariable] { &[] }
/// #     fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
/// #         let one = input.strain.0[0].constant(1.0);
/// #         Stress::elastic(one.constant(self.0.lambda()), one.constant(self.0.shear()), &input.strain)
/// #     }
/// # }
/// let size = Vec3::new(8.0, 2.0, 2.0);
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [8, 2, 2], "rock")?;
/// let law = Linear(ElasticMedium::new(9.0e9, 0.27, 2750.0)?);
/// let spec = || {
///     ModelSpec::new(&mesh)
///         .elements("rock", SolidKernel::ONE_POINT.factory("rock", law.clone(), BlockOptions::default()))
///         .gravity(Vec3::new(0.0, 0.0, -9.81), Box::new(Constant(1.0)))
///         .support(Support::fixed(mesh.nodes_of_set("bottom").unwrap()))
///         .block_size(4)
/// };
/// let options = RunOptions::steps(50);
/// let mut alone = spec().build()?;
/// run(&mut alone, &Leapfrog, &options, &mut [], &mut |_| {})?;
/// let nodes = 0..mesh.node_count() as u32;
/// let expected: Vec<Vec3> = nodes.clone().map(|node| alone.displacement(node)).collect();
/// let equal = ThreadRanks::run(3, |ranks| {
///     let mut part = RankModel::build(spec(), Box::new(ranks)).unwrap();
///     part.run(&Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
///     assert!(part.traffic().bytes > 0);
///     let mut here = nodes.clone().filter(|&node| part.has(node));
///     Ok(here.all(|node| part.displacement(node) == Some(expected[node as usize])))
/// });
/// assert_eq!(equal, [true; 3].map(Ok));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct RankModel {
    model: Model,
}

impl RankModel {
    /// Builds the part of a rank. With several ranks a model without a number of threads has one.
    ///
    /// # Errors
    /// As [`BuildModel::build`](crate::BuildModel::build), on all ranks if on one; also
    /// [`EngineError::TooManyRanks`](powerhouse_model::EngineError::TooManyRanks),
    /// [`EngineError::MoreRanksThanElements`](powerhouse_model::EngineError::MoreRanksThanElements),
    /// [`EngineError::RanksDiffer`](powerhouse_model::EngineError::RanksDiffer) for ranks with other elements,
    /// [`EngineError::OneRankOnly`](powerhouse_model::EngineError::OneRankOnly), and a failure of the communication.
    pub fn build(spec: ModelSpec, ranks: Box<dyn Ranks>) -> Result<Self, ModelError> {
        Self::build_on(spec, Communicator::new(ranks))
    }

    /// The same with ranks that further models use.
    pub(super) fn build_on(mut spec: ModelSpec, team: Communicator) -> Result<Self, ModelError> {
        if !team.is_single() {
            spec.threads = spec.threads.or(Some(1));
        }
        let model = build_on(spec, team)?;
        let team = &model.ranks.team;
        team.check().map_err(|failure| rank_failure(&failure))?;
        Ok(Self { model })
    }

    /// The part of the model.
    pub(super) fn local(&self) -> &Model {
        &self.model
    }
    /// The part of the model, to be changed on all ranks alike.
    pub(super) fn local_mut(&mut self) -> &mut Model {
        &mut self.model
    }
    /// Number of this rank.
    pub fn rank(&self) -> usize {
        self.model.ranks.team.rank()
    }
    /// Number of ranks.
    pub fn rank_count(&self) -> usize {
        self.model.ranks.team.count()
    }
    /// Number of element blocks of this rank.
    pub fn block_count(&self) -> usize {
        self.model.block_count()
    }
    /// Number of nodes of this rank, those that it shares with others included.
    pub fn node_count(&self) -> usize {
        self.model.mass.len()
    }
    /// Partition of the elements of all ranks into blocks.
    pub fn partition(&self) -> &Partition {
        self.model.partition()
    }
    /// Messages and bytes that this rank has sent.
    pub fn traffic(&self) -> Traffic {
        self.model.ranks.exchange.traffic
    }
    /// Present time (s), that of the displacement.
    pub fn time(&self) -> f64 {
        self.model.time()
    }
    /// Number of time steps taken.
    pub fn steps_taken(&self) -> u64 {
        self.model.steps_taken()
    }

    /// Whether this rank has a mesh node.
    pub fn has(&self, node: u32) -> bool {
        self.node(node).is_some()
    }
    /// Lumped mass (kg) of a mesh node; none if this rank does not have it.
    pub fn mass(&self, node: u32) -> Option<f64> {
        self.node(node).map(|local| self.model.mass[local])
    }
    /// Displacement (m) of a mesh node at [`time`](Self::time); none if this rank does not have it.
    pub fn displacement(&self, node: u32) -> Option<Vec3> {
        self.node(node)
            .map(|local| self.model.displacement_of(local))
    }
    /// Velocity (m/s) of a mesh node, half a step before [`time`](Self::time); none if this rank does not have it.
    pub fn velocity(&self, node: u32) -> Option<Vec3> {
        self.node(node).map(|local| self.model.velocity_of(local))
    }
    fn node(&self, node: u32) -> Option<usize> {
        self.model.subdomain.numbering.local(node as usize)
    }

    /// Sets the initial motion, as [`Model::set_initial`] does; every rank is given that of all mesh nodes.
    ///
    /// # Errors
    /// As [`Model::set_initial`].
    pub fn set_initial(
        &mut self,
        displacement: &[Vec3],
        velocity: &[Vec3],
    ) -> Result<(), ModelError> {
        self.model.set_initial(displacement, velocity)
    }

    /// Highest frequency and damping of the model on all ranks.
    ///
    /// # Errors
    /// A failure of the communication.
    pub fn frequency_limits(&mut self) -> Result<FrequencyLimits, RankError> {
        let limits = self.model.frequency_limits();
        self.model.ranks.team.check().map(|()| limits)
    }

    /// The stable step of the model on all ranks, as [`Model::stable_step`] finds it.
    ///
    /// # Errors
    /// As [`Model::stable_step`], and a failure of the communication.
    pub fn stable_step(&mut self, integrator: &dyn TimeIntegrator) -> Result<StableStep, RunError> {
        self.model.stable_step(integrator)
    }

    /// Integrates the model in time, as [`run_reporting`] does; all ranks are given the same options.
    ///
    /// Observers are called on rank 0 alone, with the state of the whole body; all ranks need equal ones, of which others
    /// read cadence and fields. The cancellation flag of any rank stops all of them after the same step, within 16 steps. A failure of any rank is
    /// a failure of all, with the same error.
    ///
    /// # Errors
    /// As [`run`](crate::run); with several ranks also [`RunError::OneRankOnly`], [`RunError::RanksDiffer`] and
    /// [`RunError::Ranks`].
    pub fn run(
        &mut self,
        integrator: &dyn TimeIntegrator,
        options: &RunOptions,
        observers: &mut [Box<dyn Observer>],
        progress: &mut (dyn FnMut(Progress) + Send),
    ) -> Result<RunReport, RunFailure> {
        if let Err(error) = self.check_options(options, observers) {
            let report = None;
            return Err(RunFailure { error, report });
        }
        run_reporting(&mut self.model, integrator, options, observers, progress)
    }

    /// Refuses what one rank alone supports.
    fn check_options(
        &self,
        options: &RunOptions,
        observers: &[Box<dyn Observer>],
    ) -> Result<(), RunError> {
        let ranks = self.rank_count();
        let balanced = options.energy.is_some() || observers.iter().any(|o| o.fields().energy);
        let undivided = balanced && !self.model.ranks.undivided.is_empty();
        let refused = [
            ("a profile", options.profile),
            (
                "an energy balance with a constraint that does not divide its work",
                undivided,
            ),
        ];
        match refused.into_iter().find(|(_, used)| *used) {
            Some((what, _)) if ranks > 1 => Err(RunError::OneRankOnly { what, ranks }),
            _ => Ok(()),
        }
    }
}
