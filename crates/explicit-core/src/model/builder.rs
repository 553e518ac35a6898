//! From a mesh and what the user says about it to a model.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use powerhouse_model::{
    BoundaryParts, BuildBlock, Constraint, ElementBlock, Mat3, Mesh, ModelError, NodalLoad,
    Numbering, State, TimeFunction, Vec3,
};

use super::plan::{GroupPlan, engine_node, engine_nodes, tag};
use super::solids::{Solids, build_blocks, places};
use super::start::Start;
use super::{Bound, Model};
use crate::applied::AppliedLoads;
use crate::gather::{Gather, SlotTable};
use crate::groups::Groups;
use crate::loads::Weight;
use crate::nodes::{NodalArrays, Nodes};
use crate::{BlockFactory, EngineError, PeriodicPairs, Precision, Prescribed, Support};

/// Which elements: a named set, or mesh indices.
#[derive(Clone, Debug, PartialEq)]
pub enum ElementChoice {
    /// A named element set of the mesh.
    Set(String),
    /// Mesh indices.
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

/// Elements per block. Large blocks have few nodes between them: on 132,651 distorted bricks and one
/// thread a step takes 0.87 of the time at 16,384 elements that it takes at 2048. Small ones leave
/// work for every thread.
const PART_SIZES: core::ops::RangeInclusive<usize> = 2048..=16_384;
/// Blocks that a mesh is cut into, as far as [`PART_SIZES`] permits.
const PARTS: usize = 16;
/// More threads than any machine has; starting them would take minutes.
const MOST_THREADS: usize = 4096;

/// Collects what a [`Model`] is made of; all of it is checked in [`build`](Self::build).
pub struct ModelBuilder<'a> {
    mesh: &'a Mesh,
    sets: Vec<ElementSet>,
    supports: Vec<Support>,
    periodic: Vec<PeriodicPairs>,
    prescribed: Vec<Prescribed>,
    loads: Vec<Box<dyn NodalLoad>>,
    weights: Vec<(Vec3, Box<dyn TimeFunction>)>,
    boundaries: Vec<BoundaryParts>,
    constraints: Vec<Box<dyn Constraint>>,
    embedded: Vec<BuildBlock>,
    start: Start,
    threads: Option<usize>,
    stop: Option<Arc<AtomicBool>>,
    part_size: Option<usize>,
}

impl<'a> ModelBuilder<'a> {
    pub(super) fn new(mesh: &'a Mesh) -> Self {
        Self {
            mesh,
            sets: Vec::new(),
            supports: Vec::new(),
            periodic: Vec::new(),
            prescribed: Vec::new(),
            loads: Vec::new(),
            weights: Vec::new(),
            boundaries: Vec::new(),
            constraints: Vec::new(),
            embedded: Vec::new(),
            start: Start::default(),
            threads: None,
            stop: None,
            part_size: None,
        }
    }
    /// Starts from a state, such as that of the stage before: elements that are
    /// [absent](State::absent) in it are left out, their nodes have no mass; the strain of
    /// [cast](State::casts) elements counts from where they were cast.
    #[must_use]
    pub fn start(mut self, state: State) -> Self {
        self.start = Start { state: Some(state) };
        self
    }
    /// Elements, by set or by mesh index, and what computes them. Every element of the mesh must
    /// be given once, absent ones too unless nothing is to compute them.
    #[must_use]
    pub fn elements(
        mut self,
        choice: impl Into<ElementChoice>,
        factory: Box<dyn BlockFactory>,
    ) -> Self {
        self.sets.push((choice.into(), factory));
        self
    }
    /// Nodes that are held.
    #[must_use]
    pub fn support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }
    /// Nodes that move as one.
    #[must_use]
    pub fn periodic(mut self, pairs: PeriodicPairs) -> Self {
        self.periodic.push(pairs);
        self
    }
    /// Nodes whose motion is given.
    #[must_use]
    pub fn prescribed(mut self, prescribed: Prescribed) -> Self {
        self.prescribed.push(prescribed);
        self
    }
    /// A load.
    #[must_use]
    pub fn load(mut self, load: Box<dyn NodalLoad>) -> Self {
        self.loads.push(load);
        self
    }
    /// Weight: lumped mass times an acceleration (m/s2) times a function of time.
    #[must_use]
    pub fn gravity(mut self, acceleration: Vec3, history: Box<dyn TimeFunction>) -> Self {
        self.weights.push((acceleration, history));
        self
    }
    /// Springs, dashpots, loads and blocks of a boundary.
    #[must_use]
    pub fn boundary(mut self, parts: BoundaryParts) -> Self {
        self.boundaries.push(parts);
        self
    }
    /// A condition that corrects predicted velocities.
    #[must_use]
    pub fn constraint(mut self, constraint: Box<dyn Constraint>) -> Self {
        self.constraints.push(constraint);
        self
    }
    /// A block that joins nodes of the mesh, made once they are numbered, such as that of
    /// [bolts](crate::BoltSet::block). Its history variables have names of their own, so that a state can
    /// carry it. If the state that the model starts from knows nothing of it, it is installed now:
    /// free of force, but for what it brings along, at the present displacement.
    #[must_use]
    pub fn embed(mut self, build: BuildBlock) -> Self {
        self.embedded.push(build);
        self
    }
    /// Computes with this many threads of the model's own instead of all; the results have the
    /// same bits. 1 to 4096.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }
    /// Ends static solutions with [`StaticError::Interrupted`](crate::StaticError::Interrupted) soon after
    /// a flag is raised, such as that of an interrupt. Runs have
    /// [observers](powerhouse_model::Observer) to end them.
    #[must_use]
    pub fn stop_on(mut self, flag: Arc<AtomicBool>) -> Self {
        self.stop = Some(flag);
        self
    }
    /// Elements per block, at least one, instead of a sixteenth of the mesh (2048 to 16,384). Bits of
    /// results depend on it.
    #[must_use]
    pub fn part_size(mut self, elements: usize) -> Self {
        self.part_size = Some(elements.max(1));
        self
    }

    /// Checks everything and makes the model.
    ///
    /// # Errors
    /// An [`EngineError`] (as the source of [`ModelError::Refused`]) names the node, element or
    /// set; a factory's own error comes through as it is.
    pub fn build(self) -> Result<Model, ModelError> {
        let pool = match self.threads {
            Some(threads) => Some(start_threads(threads)?),
            None => None,
        };
        let mesh = self.mesh;
        let precision = coarsest(&self.sets)?;
        let part_size = self.part_size.unwrap_or_else(|| {
            let share = mesh.element_count() / PARTS;
            share.clamp(*PART_SIZES.start(), *PART_SIZES.end())
        });
        let Solids {
            mut numbering,
            mut blocks,
            orphans,
        } = build_blocks(mesh, &self.sets, &self.start, part_size)?;
        let place_of_element = places(mesh, &blocks);
        let embedded_from = blocks.len();
        let embedded = self.embedded.into_iter();
        blocks.extend(embedded.map(|build| build(&numbering)));
        let boundary_from = blocks.len();
        let mut boundary_loads = Vec::new();
        let mut impedance = Vec::new();
        for parts in self.boundaries {
            let (numbers, extra) = build_extra(&mut numbering, mesh.node_count(), parts.blocks);
            blocks.extend(extra);
            for item in parts.impedance {
                let node = engine_node("a boundary", item.node, &numbers)?;
                if orphans.binary_search(&node).is_err() {
                    impedance.push((node, item));
                }
            }
            for load in parts.loads {
                boundary_loads.push(with_engine_nodes(load, &numbers, mesh)?);
            }
        }
        let node_count = numbering.mesh_of.len();
        let slots = slot_table(&blocks, node_count)?;
        let (mass, mass_damping) = lumped(mesh, &numbering, &blocks, &orphans)?;

        let numbers = numbering.engine_of[..mesh.node_count()].to_vec();
        let mut loads = Vec::new();
        for load in self.loads {
            loads.push(with_engine_nodes(load, &numbers, mesh)?);
        }
        for (acceleration, history) in self.weights {
            let of_mesh = numbers.iter().map(|&n| mass[n as usize]).collect();
            let weight = Box::new(Weight::new(of_mesh, acceleration, history));
            loads.push(with_engine_nodes(weight, &numbers, mesh)?);
        }
        let own_loads = loads.len();
        loads.append(&mut boundary_loads);

        let mut plan = GroupPlan::new(mesh, &numbering, node_count);
        for pairs in &self.periodic {
            plan.tie(pairs)?;
        }
        for (node, item) in &impedance {
            plan.impede(*node, item)?;
        }
        for support in &self.supports {
            plan.hold(support)?;
        }
        for (motion, prescribed) in self.prescribed.iter().enumerate() {
            plan.drive(prescribed, motion)?;
        }
        let constrained = plan.constrain(&self.constraints)?;
        let (groups, group_of) = plan.finish(&mass, &mass_damping, &constrained);
        let groups = Groups::new(groups, &constrained.concat(), &slots);
        let constraints = bind(self.constraints, constrained);

        let kicked = groups.kicked_of(&group_of);
        let loads = AppliedLoads::new(loads, own_loads, &kicked, groups.kicked());
        let with_external = loads.sums.on_plain_nodes();
        let nodes = if precision == Precision::F32 {
            Nodes::F32(NodalArrays::new(node_count, slots.len(), with_external))
        } else {
            Nodes::F64(NodalArrays::new(node_count, slots.len(), with_external))
        };
        let mut model = Model {
            mesh: mesh.clone(),
            lengths: blocks.iter().map(|block| block.nodes().len()).collect(),
            gather: Gather::new(&slots),
            numbering,
            blocks,
            slots,
            nodes,
            mass,
            mass_damping,
            group_of,
            groups,
            loads,
            prescribed: self
                .prescribed
                .into_iter()
                .map(|p| p.displacement)
                .collect(),
            constraints,
            initial_stress: Vec::new(),
            orphans,
            absent: Vec::new(),
            casts: Vec::new(),
            stage_start: Vec::new(),
            embedded: embedded_from..boundary_from,
            time: 0.0,
            number: 0,
            prepared: None,
            kicked: false,
            uncommitted: false,
            ledger: None,
            precision,
            speed_limit: f64::MAX,
            fault: None,
            place_of_element,
            spectrum: None,
            pool,
            stop: self.stop,
        };
        if let Some(state) = self.start.state {
            model.absent.clone_from(&state.absent);
            model.casts.clone_from(&state.casts);
            model.set_state(&state)?;
        }
        Ok(model)
    }
}

pub(super) type ElementSet = (ElementChoice, Box<dyn BlockFactory>);

/// The coarsest arithmetic of any set; nodes in single precision suit no other sets.
fn coarsest(sets: &[ElementSet]) -> Result<Precision, EngineError> {
    let with = |wanted: &dyn Fn(Precision) -> bool| {
        let mut factories = sets.iter().map(|(_, factory)| factory.as_ref());
        let found = factories.find(|factory| wanted(factory.options().precision));
        found.map(|factory| factory.label())
    };
    let single = with(&|precision| precision == Precision::F32);
    let other = with(&|precision| precision != Precision::F32);
    match (other, single) {
        (Some(double), Some(single)) => Err(EngineError::MixedNodes {
            first: double.into(),
            second: single.into(),
        }),
        (None, Some(_)) => Ok(Precision::F32),
        _ if with(&|precision| precision == Precision::Mixed).is_some() => Ok(Precision::Mixed),
        _ => Ok(Precision::F64),
    }
}

fn start_threads(threads: usize) -> Result<Arc<rayon::ThreadPool>, EngineError> {
    let refused = EngineError::Threads { threads };
    if threads == 0 || threads > MOST_THREADS {
        return Err(refused);
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map(Arc::new)
        .map_err(|_| refused)
}

/// Numbers the additional nodes of one boundary and makes its blocks. In the numbering that they
/// see, and in the boundary's other parts, the additional nodes follow those of the mesh.
fn build_extra(
    numbering: &mut Numbering,
    mesh_nodes: usize,
    blocks: Vec<powerhouse_model::ExtraBlock>,
) -> (Vec<u32>, Vec<Box<dyn ElementBlock>>) {
    let mut seen = Numbering::new(numbering.engine_of[..mesh_nodes].to_vec(), Vec::new());
    for _ in blocks.iter().flat_map(|block| &block.nodes) {
        let engine = numbering.mesh_of.len() as u32;
        seen.engine_of.push(engine);
        numbering.mesh_of.push(numbering.engine_of.len() as u32);
        numbering.engine_of.push(engine);
    }
    seen.mesh_of = numbering.mesh_of.clone();
    let built = blocks.into_iter().map(|b| (b.build)(&seen)).collect();
    (seen.engine_of, built)
}

fn with_engine_nodes(
    load: Box<dyn NodalLoad>,
    numbers: &[u32],
    mesh: &Mesh,
) -> Result<(Box<dyn NodalLoad>, Vec<u32>), EngineError> {
    let part = format!("load '{}'", load.name());
    let nodes = engine_nodes(&part, load.nodes(), numbers, mesh)?;
    Ok((load, nodes))
}

fn slot_table(
    blocks: &[Box<dyn ElementBlock>],
    node_count: usize,
) -> Result<SlotTable, EngineError> {
    for block in blocks {
        let outside = block.nodes().iter().find(|&&n| n as usize >= node_count);
        if let Some(&node) = outside {
            return Err(EngineError::BlockNode {
                set: block.label().into(),
                node,
            });
        }
    }
    Ok(SlotTable::new(
        node_count,
        blocks.iter().map(|block| block.nodes()),
    ))
}

/// Mass (kg) and mass damping (kg/s, empty if there is none) of every engine node.
fn lumped(
    mesh: &Mesh,
    numbering: &Numbering,
    blocks: &[Box<dyn ElementBlock>],
    orphans: &[u32],
) -> Result<(Vec<f64>, Vec<f64>), EngineError> {
    let count = numbering.mesh_of.len();
    let (mut mass, mut damping) = (vec![0.0; count], vec![0.0; count]);
    for block in blocks {
        let mut of_block = vec![0.0; block.nodes().len()];
        block.add_mass(&mut of_block);
        for (&node, m) in block.nodes().iter().zip(of_block) {
            mass[node as usize] += m;
            damping[node as usize] += m * block.mass_damping();
        }
    }
    let without = |node: &usize| !(mass[*node].is_finite() && mass[*node] > 0.0);
    let mut without = (0..count).filter(without);
    let fault = without.find(|&node| orphans.binary_search(&(node as u32)).is_err());
    if let Some(node) = fault {
        return Err(EngineError::NodeWithoutMass {
            node: tag(mesh, numbering.mesh_of[node]),
            mass: mass[node],
        });
    }
    if damping.iter().all(|&c| c == 0.0) {
        damping.clear();
    }
    Ok((mass, damping))
}

/// The constraints with their groups, which come first among all.
fn bind(constraints: Vec<Box<dyn Constraint>>, nodes: Vec<Vec<u32>>) -> Vec<Bound> {
    let mut end = 0;
    let bind = |(constraint, nodes): (_, Vec<u32>)| {
        let start = end;
        end += nodes.len();
        Bound {
            constraint,
            groups: start..end,
            predicted: Vec::new(),
            inverse_mass: vec![Mat3::zeros(); nodes.len()],
            nodes,
        }
    };
    constraints.into_iter().zip(nodes).map(bind).collect()
}
