//! The specification of a model, from which an engine builds it.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::{
    AddedMass, BlockFactory, BoundaryParts, CheckpointSink, Constraint, DelayedPairs,
    EmbeddedElements, Mesh, NodalLoad, PeriodicPairs, Prescribed, SavedRun, State, Support,
    TimeFunction, Vec3,
};

/// A selection of elements: a named set, or mesh indices.
#[derive(Clone, Debug, PartialEq)]
pub enum ElementChoice {
    /// The elements of a named set of the mesh.
    Set(String),
    /// The elements with these mesh indices.
    Elements(Vec<u32>),
}

impl From<&str> for ElementChoice {
    fn from(name: &str) -> Self {
        Self::Set(name.into())
    }
}
impl From<Vec<u32>> for ElementChoice {
    fn from(elements: Vec<u32>) -> Self {
        Self::Elements(elements)
    }
}

/// Specification of a model: elements, boundary conditions, loads, constraints and initial state, from which an
/// [`Engine`](crate::Engine) builds and checks the model.
///
/// The methods that add an item are chained:
/// ```
/// use powerhouse_model::{Mesh, ModelSpec, Support, Vec3};
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(2.0), [2, 2, 2], "rock")?;
/// let floor = mesh.nodes_of_facets(mesh.facet_set("bottom")?);
/// let spec = ModelSpec::new(&mesh).support(Support::fixed(floor)).threads(1);
/// assert_eq!((spec.supports.len(), spec.threads), (1, Some(1)));
/// # Ok::<(), powerhouse_model::MeshError>(())
/// ```
#[non_exhaustive]
pub struct ModelSpec<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Elements with the factory of their blocks; every element of the mesh that is not absent belongs to exactly
    /// one entry.
    pub sets: Vec<(ElementChoice, Box<dyn BlockFactory>)>,
    /// Supports.
    pub supports: Vec<Support>,
    /// Periodic pairs.
    pub periodic: Vec<PeriodicPairs>,
    /// Delayed pairs of all nodes of a slice; none for any other body.
    pub delayed: Option<DelayedPairs>,
    /// Prescribed motions.
    pub prescribed: Vec<Prescribed>,
    /// Nodal loads.
    pub loads: Vec<Box<dyn NodalLoad>>,
    /// Weights: acceleration (m/s2) by which the lumped mass is multiplied, and a function of time.
    pub weights: Vec<(Vec3, Box<dyn TimeFunction>)>,
    /// Springs, dashpots, loads and blocks of absorbing boundaries.
    pub boundaries: Vec<BoundaryParts>,
    /// Added masses of nodes; those of one node add up.
    pub added_masses: Vec<AddedMass>,
    /// Constraints, such as joints.
    pub constraints: Vec<Box<dyn Constraint>>,
    /// Embedded elements, such as bolts, which act on nodes of the mesh.
    pub embedded: Vec<Box<dyn EmbeddedElements>>,
    /// Initial state; none for a body at rest at time zero.
    pub start: Option<State>,
    /// Number of threads; none for all of the machine.
    pub threads: Option<usize>,
    /// Cancellation flag of static solutions.
    pub stop: Option<Arc<AtomicBool>>,
    /// Receiver of the states of a static solution.
    pub static_checkpoints: Option<Arc<dyn CheckpointSink>>,
    /// State from which a static solution goes on.
    pub static_resume: Option<Arc<SavedRun>>,
    /// Number of elements per block; none for the engine's choice.
    pub block_size: Option<usize>,
}

impl<'a> ModelSpec<'a> {
    /// The specification of a model of a mesh, without elements.
    pub fn new(mesh: &'a Mesh) -> Self {
        Self {
            mesh,
            sets: Vec::new(),
            supports: Vec::new(),
            periodic: Vec::new(),
            delayed: None,
            prescribed: Vec::new(),
            loads: Vec::new(),
            weights: Vec::new(),
            boundaries: Vec::new(),
            added_masses: Vec::new(),
            constraints: Vec::new(),
            embedded: Vec::new(),
            start: None,
            threads: None,
            stop: None,
            static_checkpoints: None,
            static_resume: None,
            block_size: None,
        }
    }
    /// Sets the initial state, such as that of the stage before: elements that are
    /// [absent](State::absent) in it are inactive and their nodes have no mass; the strain of
    /// [cast](State::casts) elements is measured from their own reference configuration.
    #[must_use]
    pub fn start(mut self, state: State) -> Self {
        self.start = Some(state);
        self
    }
    /// Adds elements, by set or by mesh index, with the factory of their blocks. Every element of the mesh must
    /// belong to exactly one set; absent elements may be left out.
    #[must_use]
    pub fn elements(
        mut self,
        choice: impl Into<ElementChoice>,
        factory: Box<dyn BlockFactory>,
    ) -> Self {
        self.sets.push((choice.into(), factory));
        self
    }
    /// Adds a support (fixed or roller-supported nodes).
    #[must_use]
    pub fn support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }
    /// Adds periodic pairs: pairs of nodes with a common motion.
    #[must_use]
    pub fn periodic(mut self, pairs: PeriodicPairs) -> Self {
        self.periodic.push(pairs);
        self
    }
    /// Makes the body a slice with delayed pairs, to which all its nodes belong.
    #[must_use]
    pub fn delayed(mut self, pairs: DelayedPairs) -> Self {
        self.delayed = Some(pairs);
        self
    }
    /// Adds a prescribed motion of nodes.
    #[must_use]
    pub fn prescribed(mut self, prescribed: Prescribed) -> Self {
        self.prescribed.push(prescribed);
        self
    }
    /// Adds a nodal load.
    #[must_use]
    pub fn load(mut self, load: Box<dyn NodalLoad>) -> Self {
        self.loads.push(load);
        self
    }
    /// Adds the weight: lumped mass times an acceleration (m/s2) times a function of time.
    #[must_use]
    pub fn gravity(mut self, acceleration: Vec3, history: Box<dyn TimeFunction>) -> Self {
        self.weights.push((acceleration, history));
        self
    }
    /// Adds the springs, dashpots, loads and blocks of an absorbing boundary.
    #[must_use]
    pub fn boundary(mut self, parts: BoundaryParts) -> Self {
        self.boundaries.push(parts);
        self
    }
    /// Adds added masses of nodes with elements, in addition to those that the nodes have already.
    #[must_use]
    pub fn added_masses(mut self, masses: impl IntoIterator<Item = AddedMass>) -> Self {
        self.added_masses.extend(masses);
        self
    }
    /// Adds a constraint, such as joints, which corrects predicted velocities.
    #[must_use]
    pub fn constraint(mut self, constraint: Box<dyn Constraint>) -> Self {
        self.constraints.push(constraint);
        self
    }
    /// Adds embedded elements, which act on nodes of the mesh, such as bolts. If the initial state has no history
    /// variables of theirs, they are installed at the present displacement, without force but for their pretension.
    #[must_use]
    pub fn embed(mut self, elements: Box<dyn EmbeddedElements>) -> Self {
        self.embedded.push(elements);
        self
    }
    /// Sets the number of threads, 1 to 4096, by default all of the machine; the results are bitwise the same.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }
    /// Sets the cancellation flag of static solutions: soon after it becomes true they end with
    /// [`StaticError::Interrupted`](crate::StaticError::Interrupted). Dynamic runs have
    /// [`RunOptions::stop`](crate::RunOptions::stop).
    #[must_use]
    pub fn stop_on(mut self, flag: Arc<AtomicBool>) -> Self {
        self.stop = Some(flag);
        self
    }
    /// Sets the receiver of the states of a static solution, taken when it asks for one and when the cancellation flag is
    /// set: between load increments, and between the steps of a dynamic relaxation. In a state `done` is the number of
    /// those steps, `time` the load factor.
    #[must_use]
    pub fn static_checkpoints(mut self, sink: Arc<dyn CheckpointSink>) -> Self {
        self.static_checkpoints = Some(sink);
        self
    }
    /// Sets the state of an interrupted static solution of an equal model, from which the next one goes on to the same
    /// bits.
    #[must_use]
    pub fn resume_statics(mut self, saved: Arc<SavedRun>) -> Self {
        self.static_resume = Some(saved);
        self
    }
    /// Sets the number of elements per block, at least one; by default a sixteenth of the mesh, but 2048 to 16,384.
    /// Results depend on it by rounding.
    #[must_use]
    pub fn block_size(mut self, elements: usize) -> Self {
        self.block_size = Some(elements.max(1));
        self
    }
}

impl core::fmt::Debug for ModelSpec<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("ModelSpec")
            .field("elements", &self.mesh.element_count())
            .field("sets", &self.sets.len())
            .field("supports", &self.supports.len())
            .field("loads", &self.loads.len())
            .field("constraints", &self.constraints.len())
            .finish_non_exhaustive()
    }
}
