//! The model: element blocks, nodes, boundary conditions, loads and constraints.

mod builder;
mod dynamics;
mod embedded;
mod fibres;
mod motion;
mod plan;
mod solids;
mod start;

use core::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use powerhouse_model::{
    CheckpointSink, Constraint, ConstraintParts, ElementBlock, JointView, MassDampingRule, Mat3,
    Mesh, ModelSpec, Precision, RunError, SavedRun, TimeFunction, Vec3,
};

use crate::applied::AppliedLoads;
use crate::bay::Bay;
use crate::delayed::DelayedSlice;
use crate::device::DeviceSteps;
use crate::groups::Groups;
use crate::ledger::Ledger;
use crate::node_ranges::NodeSums;
use crate::nodes::Nodes;
use crate::partition::Partition;
use crate::profile::Profiler;
use crate::ranks::Ranked;
use crate::stable_step::Spectrum;
use crate::subdomain::Subdomain;

pub use builder::BuildModel;
pub(crate) use builder::{block_nodes, build_on};
pub(crate) use dynamics::{BlockTerms, block_forces, least_mass};
pub(crate) use motion::{ElementAt, by_element};
use start::InitialStress;

/// A constraint with the node groups on which it acts.
pub(crate) struct BoundConstraint {
    pub(crate) constraint: Box<dyn Constraint>,
    /// Engine nodes, in the constraint's order.
    nodes: Vec<u32>,
    /// Range of the groups of its nodes, in its order.
    groups: Range<usize>,
    /// Velocity (m/s) before the correction, while an energy ledger is open.
    predicted: Vec<Vec3>,
    inverse_mass: Vec<Mat3>,
}

impl BoundConstraint {
    /// Engine nodes, in the constraint's order.
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    /// Range of the groups of its nodes, in its order.
    pub(crate) fn groups(&self) -> Range<usize> {
        self.groups.clone()
    }
    /// Views of its joints.
    pub(crate) fn joints(&self) -> Vec<JointView<'_>> {
        let jointed = self.constraint.jointed();
        jointed.map_or_else(Vec::new, |jointed| jointed.joints())
    }
}

/// An assembled finite element model with its present state: element blocks, nodes, supports, loads, absorbing
/// boundaries, constraints.
///
/// Built by [`Model::builder`]; integrated in time by [`run`](crate::run), or step by step by a
/// [`TimeIntegrator`](powerhouse_model::TimeIntegrator) through its
/// [`Dynamics`](powerhouse_model::Dynamics).
pub struct Model {
    pub(crate) mesh: Mesh,
    partition: Partition,
    pub(crate) subdomain: Subdomain,
    /// The element blocks: those of the partition, in order, then embedded blocks, then those of boundaries.
    pub(crate) blocks: Vec<Box<dyn ElementBlock>>,
    pub(crate) nodes: Nodes,
    /// Lumped mass of each engine node (kg).
    pub(crate) mass: Vec<f64>,
    /// Mass damping of each engine node (kg/s); empty if there is none.
    pub(crate) mass_damping: Vec<f64>,
    /// Whether nodes have added masses, those of other ranks included.
    pub(crate) has_added_masses: bool,
    /// Group of each engine node.
    pub(crate) group_of: Vec<Option<u32>>,
    pub(crate) groups: Groups,
    /// The slice, if the body is one whose sides are delayed against each other.
    pub(crate) delayed: Option<DelayedSlice>,
    /// The bay, if the body is one of an endless row under waves along y.
    pub(crate) bay: Option<Bay>,
    pub(crate) loads: AppliedLoads,
    prescribed: Vec<Box<dyn TimeFunction>>,
    pub(crate) constraints: Vec<BoundConstraint>,
    pub(crate) initial: InitialStress,
    /// Mesh indices of inactive elements (excavated, or yet to be cast).
    pub(crate) absent: Vec<u32>,
    /// Elements cast in the course of the stages, with their reference configurations.
    pub(crate) casts: Vec<powerhouse_model::Cast>,
    /// Displacement (m) at the start of the stage, one per mesh node and additional node; empty
    /// where it is zero.
    pub(crate) stage_start: Vec<Vec3>,
    /// Range of the embedded blocks, such as bolts.
    embedded: core::ops::Range<usize>,
    /// Index in the partition of the host block of each of them.
    hosts: Vec<Option<u32>>,
    pub(crate) time: f64,
    pub(crate) number: u64,
    /// Rule of mass damping and length of step (s) of the present matrices.
    pub(crate) prepared: Option<(MassDampingRule, f64)>,
    /// Whether the kick of the plain nodes is pending; it shares a pass with the drift.
    kicked: bool,
    /// Whether the history variables of a completed step are still to be committed.
    pub(crate) uncommitted: bool,
    /// Measurement of the parts of time steps, while one is under way.
    pub(crate) profiler: Option<Box<Profiler>>,
    /// The energy ledger, while one is open.
    pub(crate) ledger: Option<Box<Ledger>>,
    /// Lowest precision of any element set.
    pub(crate) precision: Precision,
    /// Bound on each component of velocity (m/s).
    pub(crate) speed_limit: f64,
    /// Divergence found by the last pass over the nodes.
    pub(crate) fault: Option<RunError>,
    /// Highest frequency and damping, once computed.
    pub(crate) spectrum: Option<Spectrum>,
    pool: Option<Arc<rayon::ThreadPool>>,
    /// Cancellation flag of static solutions.
    stop: Option<Arc<AtomicBool>>,
    /// Receiver of the states of static solutions, and the state from which the next one goes on.
    pub(crate) static_checkpoints: Option<Arc<dyn CheckpointSink>>,
    pub(crate) static_resume: Option<Arc<SavedRun>>,
    /// The device that takes steps beside the host.
    pub(crate) device: Option<DeviceSteps>,
    /// The place of this model among those of other ranks.
    pub(crate) ranks: Ranked,
}

/// Indices of the blocks of each label, in the order of the labels' first blocks.
pub(crate) fn blocks_by_label(blocks: &[Box<dyn ElementBlock>]) -> Vec<(&str, Vec<usize>)> {
    let mut sets: Vec<(&str, Vec<usize>)> = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        match sets.iter_mut().find(|(label, _)| *label == block.label()) {
            Some((_, of_set)) => of_set.push(index),
            None => sets.push((block.label(), vec![index])),
        }
    }
    sets
}

impl core::fmt::Debug for Model {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Model")
            .field("nodes", &self.mass.len())
            .field("blocks", &self.blocks.len())
            .field("groups", &self.groups.groups.len())
            .field("time", &self.time)
            .field("number", &self.number)
            .finish_non_exhaustive()
    }
}

impl Model {
    /// The specification of a model of a mesh, which [`BuildModel::build`] turns into the model.
    pub fn builder(mesh: &Mesh) -> ModelSpec<'_> {
        ModelSpec::new(mesh)
    }
    /// The mesh of the model.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }
    /// Present time (s), that of the displacement.
    pub fn time(&self) -> f64 {
        self.time
    }
    /// Number of time steps taken, those of continued runs included.
    pub fn steps_taken(&self) -> u64 {
        self.number
    }
    /// Lumped mass (kg) of a mesh node.
    ///
    /// # Panics
    /// If the node is out of range.
    pub fn mass(&self, node: u32) -> f64 {
        self.mass[self.engine(node)]
    }
    /// Number of element blocks, the units of parallel work.
    pub fn block_count(&self) -> usize {
        self.blocks.len()
    }
    /// Partition of the active elements of the mesh into blocks.
    pub fn partition(&self) -> &Partition {
        &self.partition
    }

    /// Parts of all constraints and periodic pairs: nodes of the mesh (mesh indices) whose motion must be computed together.
    /// Parts of constraints that periodic pairs connect are one.
    pub fn constraint_parts(&self) -> ConstraintParts {
        let constraints = self.constraints.iter();
        let parts: Vec<ConstraintParts> = constraints
            .map(|c| ConstraintParts::of(c.constraint.as_ref()))
            .collect();
        let mesh_of = &self.subdomain.numbering.mesh_of;
        let groups = self.groups.groups.iter();
        let tied: Vec<Vec<u32>> = groups
            .filter(|group| group.members.len() > 1)
            .map(|group| group.members.iter().map(|&n| mesh_of[n as usize]).collect())
            .collect();
        let of_constraints = parts.iter().flat_map(ConstraintParts::iter);
        ConstraintParts::merged(of_constraints.chain(tied.iter().map(|nodes| &nodes[..])))
    }

    /// For each block of embedded elements, such as bolts, its label and the index in the
    /// [partition](Self::partition) of the block that has its hosts; none if they are absent.
    pub fn embedded_hosts(&self) -> impl ExactSizeIterator<Item = (&str, Option<u32>)> {
        let blocks = self.blocks[self.embedded.clone()].iter();
        let labels = blocks.map(|block| block.label());
        labels.zip(self.hosts.iter().copied())
    }

    pub(crate) fn engine(&self, node: u32) -> usize {
        self.subdomain.numbering.local_of[node as usize] as usize
    }

    /// Sums over the nodes of the body.
    pub(crate) fn node_sums(&self) -> NodeSums<'_> {
        NodeSums {
            ranges: &self.subdomain.node_ranges,
            team: &self.ranks.team,
        }
    }

    /// The values of the prescribed motions at the present time (m).
    pub(crate) fn prescribed_values(&self) -> Vec<f64> {
        self.prescribed.iter().map(|f| f.value(self.time)).collect()
    }

    /// Whether the cancellation flag of static solutions is set.
    pub(crate) fn is_stopped(&self) -> bool {
        (self.stop.as_ref()).is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Runs work in the model's thread pool, or in the global one: from a thread outside of both, every parallel pass
    /// would have to wake the pool.
    pub(crate) fn in_pool<R: Send>(&mut self, work: impl FnOnce(&mut Self) -> R + Send) -> R {
        match self.pool.clone() {
            Some(pool) if pool.current_thread_index().is_none() => pool.install(|| work(self)),
            None if rayon::current_thread_index().is_none() => rayon::scope(|_| work(self)),
            _ => work(self),
        }
    }
}
