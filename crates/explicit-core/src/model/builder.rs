//! Assembly of a model from a mesh, element sets, boundary conditions and loads.

use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse_model::{
    BlockFactory, Constraint, DelayedPairs, ElementBlock, ElementChoice, EmbeddedElements,
    EngineError, Mat3, Mesh, ModelError, ModelSpec, NodalLoad, Precision,
};

use super::plan::{GroupPlan, engine_node, engine_nodes, tag};
use super::solids::{Solids, build_blocks};
use super::start::{InitialState, InitialStress};
use super::{BoundConstraint, Model, least_mass};
use crate::applied::AppliedLoads;
use crate::bay::{BayPlan, Carriers, Copies, check_bay, check_constraints};
use crate::delayed::{DelayedSlice, check_delayed, pair_up};
use crate::groups::Groups;
use crate::nodes::{NodalArrays, Nodes};
use crate::partition::Partition;
use crate::ranks::{ABSENT, BlockAssembly, BuiltSolids, Communicator, fingerprint};
use crate::subdomain::{Numbering, Subdomain};
use crate::weight::Weight;

/// Elements per block by default. Large blocks share few nodes: on 132,651 distorted bricks and one
/// thread a step takes 0.87 of the time at 16,384 elements that it takes at 2048. Small blocks occupy
/// every thread.
const BLOCK_SIZES: core::ops::RangeInclusive<usize> = 2048..=16_384;
/// Number of blocks per mesh by default, as far as [`BLOCK_SIZES`] permits.
const BLOCKS: usize = 16;
/// Largest permitted number of threads; starting more would take minutes.
const MOST_THREADS: usize = 4096;

/// Building of a model of this engine from its specification.
pub trait BuildModel {
    /// Checks the input and builds the model.
    ///
    /// # Errors
    /// An [`EngineError`] (as the source of [`ModelError::Refused`]) that names the node, element or
    /// set, or the error of a factory.
    fn build(self) -> Result<Model, ModelError>;
}

impl BuildModel for ModelSpec<'_> {
    fn build(self) -> Result<Model, ModelError> {
        build_on(self, Communicator::default())
    }
}

/// Builds the part of a model that one rank computes.
pub(crate) fn build_on(spec: ModelSpec, team: Communicator) -> Result<Model, ModelError> {
    if !team.is_single() {
        team.check_same("the specification of the model", fingerprint(&spec))?;
    }
    let own = |pairs: &&DelayedPairs| pairs.slowness != 0.0;
    let delayed = spec.delayed.as_ref().filter(own);
    let bay = delayed.filter(|pairs| DelayedPairs::make_bay(spec.mesh, &pairs.pairs));
    if let Some(pairs) = bay {
        check_bay(spec.mesh, pairs)?;
        check_constraints(&spec.constraints)?;
    }
    check_delayed(&spec, team.is_single(), bay.is_some())?;
    let slice = delayed.filter(|_| bay.is_none());
    let slice = slice.map(|pairs| pair_up(spec.mesh, pairs)).transpose()?;
    let pool = match spec.threads {
        Some(threads) => Some(start_threads(threads)?),
        None => None,
    };
    let mesh = spec.mesh;
    let mut start = InitialState {
        state: spec.start,
        ..InitialState::default()
    };
    let copies = bay.is_some().then(|| start.absent(mesh));
    let copies = copies.transpose()?.map(|absent| Copies::new(mesh, &absent));
    let copies = copies.transpose()?;
    let divided = copies.as_ref().map_or(mesh, |copies| &copies.mesh);
    if let Some(copies) = &copies {
        start.node_of = copies.originals().to_vec();
    }
    let precision = coarsest(&spec.sets)?;
    let block_size = spec.block_size.unwrap_or_else(|| {
        let share = mesh.element_count() / BLOCKS;
        share.clamp(*BLOCK_SIZES.start(), *BLOCK_SIZES.end())
    });
    let Solids {
        partition,
        ranks,
        labels,
        blocks,
    } = build_blocks(divided, &spec.sets, &start, block_size, &team)?;
    let mut numbering = Numbering::of(&partition, divided);
    let orphans: Vec<u32> = (partition.orphans.iter())
        .map(|&node| numbering.local_of[node as usize])
        .collect();
    let solids = BuiltSolids {
        ranks,
        labels,
        blocks,
    };
    let assembly = BlockAssembly::of_solids(&team, &partition, solids, &numbering);
    let mut assembly = team.agree(assembly)?;
    let embedded_from = assembly.blocks.len();
    let mut hosts = Vec::new();
    let mut carriers = copies.as_ref().map(|_| Carriers::of(mesh));
    for (host, block) in embedded_blocks(mesh, &partition, &spec.embedded) {
        let nodes = match &mut carriers {
            Some(carriers) => carriers.nodes_of(block.as_ref(), &mut numbering)?,
            None => block_nodes(block.as_ref(), &numbering.local_of)?,
        };
        if assembly.add(block, nodes, host) {
            hosts.push(host);
        }
    }
    let boundary_from = assembly.blocks.len();
    let mut boundary_loads = Vec::new();
    let mut impedance = Vec::new();
    for parts in spec.boundaries {
        let numbers = number_extra(&mut numbering, mesh.node_count(), &parts.blocks);
        for extra in parts.blocks {
            let nodes = block_nodes(extra.block.as_ref(), &numbers)?;
            let first = assembly.first_at(&nodes);
            assembly.add(extra.block, nodes, first);
        }
        impedance.reserve_exact(parts.impedance.len());
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
    let mut added_masses = Vec::with_capacity(spec.added_masses.len());
    for item in &spec.added_masses {
        let of_mesh = &numbering.local_of[..mesh.node_count()];
        let node = engine_node("an added mass", item.node, of_mesh)?;
        if orphans.binary_search(&node).is_ok() {
            let (node, reason) = (tag(mesh, item.node), "it has no active elements");
            return Err(EngineError::AddedMass { node, reason }.into());
        }
        added_masses.push((node, item));
    }
    let mut ranked = assembly.placed(team, &numbering, &spec.constraints, &spec.periodic);
    let orphans = orphans.into_iter().map(|node| ranked.local(node));
    let orphans: Vec<u32> = orphans.filter(|&node| node != ABSENT).collect();
    let (blocks, nodes_of_blocks) = assembly.on_rank(|node| ranked.local(node));
    let here = ranked.numbering(&numbering);
    let (mut mass, mut mass_damping) = if ranked.is_single() {
        lumped(&blocks, &nodes_of_blocks, here.mesh_of.len())
    } else {
        ranked.lumped(&blocks, &nodes_of_blocks)
    };
    let of_mesh = |copies: &Copies| copies.mesh.node_count();
    let carriers_from = copies.as_ref().map_or(usize::MAX, of_mesh);
    let checked = check_masses(mesh, &here, &mass, (&orphans, carriers_from));
    ranked.team.agree(checked.map_err(ModelError::from))?;
    let bay_plan = copies.as_ref().zip(delayed).map(|(copies, delayed)| {
        let elements = (&blocks[..], &nodes_of_blocks[..]);
        BayPlan::new(copies, delayed.slowness, &here, elements, &mass)
    });
    let mut ties = copies
        .as_ref()
        .map_or_else(Vec::new, |copies| copies.ties(&here));
    ties.extend(carriers.iter().flat_map(Carriers::ties));
    // What acts on the nodes of the mesh acts on all of their mass.
    for &[node, copy] in &ties {
        for values in [&mut mass, &mut mass_damping] {
            if let Some(own) = values.get_mut(copy as usize) {
                let own = core::mem::take(own);
                values[node as usize] += own;
            }
        }
    }
    ranked.least_mass = ranked.team.least_of(least_mass(&mass));
    let tables = ranked.take_tables();
    let subdomain = Subdomain::new(mesh, here, orphans, &blocks, nodes_of_blocks, tables);
    let node_count = subdomain.node_count();

    let numbers = numbering.local_of[..mesh.node_count()].to_vec();
    let mut loads = Vec::new();
    for load in spec.loads {
        loads.push(with_engine_nodes(load, &numbers, mesh)?);
    }
    for (acceleration, history) in spec.weights {
        let mass_of = |&number: &u32| mass.get(ranked.local(number) as usize).copied();
        let of_rank = (0..).zip(&numbers);
        let of_rank = of_rank.filter_map(|(node, number)| Some((node, mass_of(number)?)));
        let weight = Box::new(Weight::new(of_rank.unzip(), acceleration, history));
        loads.push(with_engine_nodes(weight, &numbers, mesh)?);
    }
    let own_loads = loads.len();
    loads.append(&mut boundary_loads);
    for node in loads.iter_mut().flat_map(|(_, nodes)| nodes) {
        *node = ranked.local(*node);
    }

    let nodes = 0..numbering.mesh_of.len() as u32;
    let is_here: Vec<bool> = nodes.map(|node| ranked.local(node) != ABSENT).collect();
    let mut plan = GroupPlan::new(mesh, &numbering, &is_here);
    for pairs in &spec.periodic {
        plan.tie(&pairs.pairs)?;
    }
    if let Some(pairs) = &spec.delayed {
        plan.tie(&pairs.pairs)?;
    }
    plan.tie_copies(&ties);
    if let Some(bay) = &bay_plan {
        plan.reduce_masses(&bay.lost);
    }
    for (node, item) in &impedance {
        plan.add_impedance(*node, item, delayed.is_some())?;
    }
    for (node, item) in &added_masses {
        plan.add_mass(*node, item)?;
    }
    for support in &spec.supports {
        plan.hold(support)?;
    }
    let mut all = spec.prescribed.iter().enumerate();
    let conflict = all.try_for_each(|(motion, prescribed)| plan.prescribe(prescribed, motion));
    ranked.team.agree(conflict.map_err(ModelError::from))?;
    let constrained = plan.constrain(&spec.constraints)?;
    let restricted = ranked.restrict(spec.constraints, constrained, &numbers);
    let (constraints, constrained) = ranked.team.agree(restricted)?;
    let masses = (&mass[..], &mass_damping[..]);
    let (mut groups, group_of) = plan.finish(masses, &constrained, |node| ranked.local(node));
    let constrained: Vec<Vec<u32>> = (constrained.into_iter())
        .map(|nodes| nodes.into_iter().map(|node| ranked.local(node)).collect())
        .collect();
    let slice = slice.map(|pairs| DelayedSlice::new(mesh, &pairs, &groups, &subdomain, &blocks));
    let slice = slice.transpose()?;
    let bay = bay_plan.zip(copies.as_ref()).map(|(bay, copies)| {
        let of_nodes = (&mut groups[..], &group_of[..]);
        bay.finish(mesh, of_nodes, (copies, &subdomain), &blocks)
    });
    let bay = bay.transpose()?;
    let groups = Groups::new(groups, &constrained.concat(), &subdomain.slots);
    let constraints = bind(constraints, constrained);

    let kicked = groups.kicked_of(&group_of);
    let loads = AppliedLoads::new(loads, own_loads, &kicked, groups.kicked());
    let with_external = loads.sums.on_plain_nodes();
    let nodes = if precision == Precision::F32 {
        Nodes::F32(NodalArrays::new(
            node_count,
            subdomain.slots.len(),
            with_external,
        ))
    } else {
        Nodes::F64(NodalArrays::new(
            node_count,
            subdomain.slots.len(),
            with_external,
        ))
    };
    let prescribed = spec.prescribed.into_iter();
    let mut model = Model {
        mesh: mesh.clone(),
        partition,
        subdomain,
        blocks,
        nodes,
        mass,
        mass_damping,
        has_added_masses: !added_masses.is_empty() || bay.is_some(),
        group_of,
        groups,
        delayed: slice,
        bay,
        loads,
        prescribed: prescribed.map(|p| p.displacement).collect(),
        constraints,
        initial: InitialStress::default(),
        absent: Vec::new(),
        casts: Vec::new(),
        stage_start: Vec::new(),
        embedded: embedded_from..boundary_from,
        hosts,
        time: 0.0,
        number: 0,
        prepared: None,
        kicked: false,
        uncommitted: false,
        profiler: None,
        ledger: None,
        precision,
        speed_limit: f64::MAX,
        fault: None,
        spectrum: None,
        pool,
        stop: spec.stop,
        static_checkpoints: spec.static_checkpoints,
        static_resume: spec.static_resume,
        device: None,
        ranks: ranked,
    };
    if let Some(state) = start.state {
        model.absent.clone_from(&state.absent);
        model.casts.clone_from(&state.casts);
        let set = model.set_state(&state);
        model.ranks.team.agree(set)?;
    }
    Ok(model)
}

pub(super) type ElementSet = (ElementChoice, Box<dyn BlockFactory>);

/// Lowest precision of any element set; sets with nodes in single precision cannot be combined with others.
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

/// Blocks of embedded elements with the index of their host block in the partition: one of all units of each kind of
/// elements whose hosts belong to the same block, kind by kind in the order of the host blocks. Units without a present
/// host come last.
fn embedded_blocks(
    mesh: &Mesh,
    partition: &Partition,
    embedded: &[Box<dyn EmbeddedElements>],
) -> Vec<(Option<u32>, Box<dyn ElementBlock>)> {
    if embedded.is_empty() {
        return Vec::new();
    }
    let mut block_of = vec![None; mesh.element_count()];
    for (index, block) in (0..).zip(&partition.blocks) {
        for &element in &block.elements {
            block_of[element as usize] = Some(index);
        }
    }
    let mut blocks = Vec::new();
    for elements in embedded {
        let mut units_of: BTreeMap<u32, (Option<u32>, Vec<usize>)> = BTreeMap::new();
        for (unit, host) in elements.hosts().into_iter().enumerate() {
            let host = host.and_then(|host| *block_of.get(host as usize)?);
            let key = host.unwrap_or(u32::MAX);
            let (_, units) = units_of.entry(key).or_insert((host, Vec::new()));
            units.push(unit);
        }
        for (host, units) in units_of.into_values() {
            blocks.push((host, elements.block_of(&units)));
        }
    }
    blocks
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

/// Numbers the additional nodes of the blocks of one boundary; returns the engine numbers of the nodes of the mesh and
/// of these additional ones, which follow them in the boundary's own numbering.
fn number_extra(
    numbering: &mut Numbering,
    mesh_nodes: usize,
    blocks: &[powerhouse_model::ExtraBlock],
) -> Vec<u32> {
    let mut numbers = numbering.local_of[..mesh_nodes].to_vec();
    for _ in blocks.iter().flat_map(|block| &block.nodes) {
        let index = numbering.append();
        numbers.push(numbering.local_of[index as usize]);
    }
    numbers
}

/// Engine numbers of the nodes of a block, which names them by the index in `numbers`.
pub(crate) fn block_nodes(
    block: &dyn ElementBlock,
    numbers: &[u32],
) -> Result<Vec<u32>, EngineError> {
    let local = |&node: &u32| {
        let found = numbers.get(node as usize).copied();
        found.ok_or_else(|| EngineError::BlockNode {
            set: block.label().into(),
            node,
        })
    };
    block.nodes().iter().map(local).collect()
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

/// Mass (kg) and mass damping (kg/s, empty if there is none) of every local node, from blocks and the local numbers of
/// their nodes.
fn lumped(
    blocks: &[Box<dyn ElementBlock>],
    nodes_of_blocks: &[Vec<u32>],
    count: usize,
) -> (Vec<f64>, Vec<f64>) {
    let (mut mass, mut damping) = (vec![0.0; count], vec![0.0; count]);
    for (block, nodes) in blocks.iter().zip(nodes_of_blocks) {
        let mut of_block = vec![0.0; nodes.len()];
        block.add_mass(&mut of_block);
        for (&node, m) in nodes.iter().zip(of_block) {
            mass[node as usize] += m;
            damping[node as usize] += m * block.damping().mass;
        }
    }
    if damping.iter().all(|&c| c == 0.0) {
        damping = Vec::new();
    }
    (mass, damping)
}

/// Refuses nodes without mass that are no orphans; nodes from a mesh index on carry embedded elements in a bay.
fn check_masses(
    mesh: &Mesh,
    numbering: &Numbering,
    mass: &[f64],
    (orphans, carriers_from): (&[u32], usize),
) -> Result<(), EngineError> {
    let is_carrier = |node: usize| numbering.mesh_of[node] as usize >= carriers_from;
    let without = |node: &usize| !(mass[*node].is_finite() && mass[*node] > 0.0);
    let mut without = (0..mass.len()).filter(without);
    let is_orphan = |node: usize| orphans.binary_search(&(node as u32)).is_ok();
    match without.find(|&node| !is_orphan(node) && !is_carrier(node)) {
        None => Ok(()),
        Some(node) => Err(EngineError::NodeWithoutMass {
            node: tag(mesh, numbering.mesh_of[node]),
            mass: mass[node],
        }),
    }
}

/// Assigns the constraints their groups, which are the first ones.
fn bind(constraints: Vec<Box<dyn Constraint>>, nodes: Vec<Vec<u32>>) -> Vec<BoundConstraint> {
    let mut end = 0;
    let bind = |(constraint, nodes): (_, Vec<u32>)| {
        let start = end;
        end += nodes.len();
        BoundConstraint {
            constraint,
            groups: start..end,
            predicted: Vec::new(),
            inverse_mass: vec![Mat3::zeros(); nodes.len()],
            nodes,
        }
    };
    constraints.into_iter().zip(nodes).map(bind).collect()
}
