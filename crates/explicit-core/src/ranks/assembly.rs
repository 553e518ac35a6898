//! Assembly of the part of a model that one rank computes.

use std::collections::HashSet;

use powerhouse_model::{
    Constraint, ConstraintParts, ElementBlock, EngineError, ModelError, PeriodicPairs, Quad,
    SavedSection,
};

use super::communicator::Communicator;
use super::exchange::Exchange;
use super::fault::Outcome;
use super::layout::{ABSENT, AllBlocks, Layout};
use super::whole::WholeJoint;
use crate::gather::SlotTable;
use crate::model::block_nodes;
use crate::node_ranges::NodeRanges;
use crate::partition::Partition;
use crate::subdomain::Numbering;

/// Blocks of a model on all ranks, in their global order, of which those of this rank have been built.
pub(crate) struct BlockAssembly {
    rank: u32,
    /// Rank of each block, and engine numbers of its nodes.
    ranks: Vec<u32>,
    nodes: Vec<Vec<u32>>,
    /// The blocks of this rank, and their global numbers.
    pub(crate) blocks: Vec<Box<dyn ElementBlock>>,
    numbers: Vec<u32>,
    /// Names of all element sets, in the order of their first blocks.
    sets: Vec<String>,
}

/// Blocks of a partition.
pub(crate) struct BuiltSolids {
    /// Rank of each block.
    pub(crate) ranks: Vec<u32>,
    /// Name of the element set of each block.
    pub(crate) labels: Vec<String>,
    /// The blocks of this rank.
    pub(crate) blocks: Vec<Box<dyn ElementBlock>>,
}

impl BlockAssembly {
    /// From the blocks of a partition.
    pub(crate) fn of_solids(
        team: &Communicator,
        partition: &Partition,
        built: BuiltSolids,
        numbering: &Numbering,
    ) -> Result<Self, ModelError> {
        let BuiltSolids {
            ranks,
            labels,
            blocks,
        } = built;
        let rank = team.rank() as u32;
        let own = (0..).zip(&ranks).filter(|(_, owner)| **owner == rank);
        let numbers: Vec<u32> = own.map(|(number, _)| number).collect();
        let mut nodes: Vec<Vec<u32>> = (partition.blocks.iter())
            .map(|block| {
                let nodes = block.nodes.iter();
                nodes
                    .map(|&node| numbering.local_of[node as usize])
                    .collect()
            })
            .collect();
        for (&number, block) in numbers.iter().zip(&blocks) {
            let own = block_nodes(block.as_ref(), &numbering.local_of)?;
            let of_partition = &mut nodes[number as usize];
            if !team.is_single() && own != *of_partition {
                // Other ranks expect its forces in the order of the partition.
                let what = format!("a block of set '{}' with nodes of its own", block.label());
                let ranks = team.count();
                return Err(EngineError::OneRankOnly { what, ranks }.into());
            }
            *of_partition = own;
        }
        let mut assembly = Self {
            rank,
            ranks,
            nodes,
            blocks,
            numbers,
            sets: Vec::new(),
        };
        labels.iter().for_each(|label| assembly.name(label));
        Ok(assembly)
    }

    /// Adds the name of an element set, unless it is known.
    fn name(&mut self, label: &str) {
        if !self.sets.iter().any(|set| set == label) {
            self.sets.push(label.into());
        }
    }

    /// The first block that has one of some nodes.
    pub(crate) fn first_at(&self, nodes: &[u32]) -> Option<u32> {
        let mut wanted = nodes.to_vec();
        wanted.sort_unstable();
        let has = |own: &Vec<u32>| own.iter().any(|node| wanted.binary_search(node).is_ok());
        self.nodes.iter().position(has).map(|block| block as u32)
    }

    /// Adds a block with its nodes to the rank of another block, by default rank 0; returns whether that is this rank.
    pub(crate) fn add(
        &mut self,
        block: Box<dyn ElementBlock>,
        nodes: Vec<u32>,
        beside: Option<u32>,
    ) -> bool {
        self.name(block.label());
        let rank = beside.map_or(0, |block| self.ranks[block as usize]);
        let is_own = rank == self.rank;
        if is_own {
            self.numbers.push(self.ranks.len() as u32);
            self.blocks.push(block);
        }
        self.ranks.push(rank);
        self.nodes.push(nodes);
        is_own
    }

    /// The place of this rank among the others, for constraints and periodic pairs whose nodes have mesh indices.
    pub(crate) fn placed(
        &self,
        team: Communicator,
        numbering: &Numbering,
        constraints: &[Box<dyn Constraint>],
        periodic: &[PeriodicPairs],
    ) -> Ranked {
        let layout = (!team.is_single()).then(|| {
            let parts: Vec<ConstraintParts> = constraints
                .iter()
                .map(|c| ConstraintParts::of(c.as_ref()))
                .collect();
            let of_constraints = parts.iter().flat_map(ConstraintParts::iter);
            let tied = periodic.iter().flat_map(|periodic| &periodic.pairs);
            let tied: Vec<[u32; 2]> = tied.map(|&(a, b)| [a, b]).collect();
            let together = of_constraints.chain(tied.iter().map(|pair| &pair[..]));
            // Nodes that do not exist are refused where the parts are assembled.
            let known = |nodes: &[u32]| -> Vec<u32> {
                let engine = nodes.iter().map(|&node| numbering.local(node as usize));
                engine.flatten().map(|node| node as u32).collect()
            };
            let together: Vec<Vec<u32>> = together.map(known).collect();
            let parts = ConstraintParts::merged(together.iter().map(|nodes| &nodes[..]));
            let all = AllBlocks {
                node_count: numbering.mesh_of.len(),
                nodes: &self.nodes,
                ranks: &self.ranks,
                parts: &parts,
            };
            Layout::new(&all, self.rank, team.count())
        });
        Ranked::new(team, layout, (self.numbers.clone(), self.sets.clone()))
    }

    /// The blocks of this rank with the numbers of their nodes on it.
    pub(crate) fn on_rank(
        self,
        on_rank: impl Fn(u32) -> u32,
    ) -> (Vec<Box<dyn ElementBlock>>, Vec<Vec<u32>>) {
        let Self {
            rank,
            ranks,
            nodes,
            blocks,
            ..
        } = self;
        let own = nodes
            .into_iter()
            .zip(ranks)
            .filter(|(_, owner)| *owner == rank);
        let own = own.map(|(nodes, _)| nodes.into_iter().map(&on_rank).collect());
        (blocks, own.collect())
    }
}

/// A rank of a model among the others.
pub(crate) struct Ranked {
    pub(crate) team: Communicator,
    pub(crate) exchange: Exchange,
    /// Global numbers of the blocks of this rank.
    pub(crate) block_numbers: Vec<u32>,
    /// Names of the element sets of all ranks, in the order of their first blocks.
    pub(crate) sets: Vec<String>,
    /// Global numbers of its constraints, and the number of constraints of all ranks.
    pub(crate) constraint_numbers: Vec<u32>,
    constraint_count: usize,
    /// Names of the constraints with parts whose work is not divided among them.
    pub(crate) undivided: Vec<String>,
    /// The joints of the whole body; empty on one rank, which has all.
    pub(crate) joints: Vec<WholeJoint>,
    /// Engine numbers of its nodes; empty on one rank, which has all.
    present: Vec<u32>,
    /// Its number of each engine node; empty on one rank.
    local_of: Vec<u32>,
    tables: Option<(SlotTable, NodeRanges)>,
    /// Least positive mass (kg) of a node of any rank.
    pub(crate) least_mass: f64,
    /// What is known of the end of a run.
    pub(crate) outcome: Outcome,
}

/// Constraints of a rank, and the engine numbers of the nodes of each.
pub(crate) type Restricted = (Vec<Box<dyn Constraint>>, Vec<Vec<u32>>);

impl Ranked {
    fn new(
        team: Communicator,
        layout: Option<Layout>,
        (block_numbers, sets): (Vec<u32>, Vec<String>),
    ) -> Self {
        let mut ranked = Self {
            team,
            exchange: Exchange::default(),
            block_numbers,
            sets,
            constraint_numbers: Vec::new(),
            constraint_count: 0,
            undivided: Vec::new(),
            joints: Vec::new(),
            present: Vec::new(),
            local_of: Vec::new(),
            tables: None,
            least_mass: 1.0,
            outcome: Outcome::default(),
        };
        if let Some(layout) = layout {
            ranked.exchange = layout.exchange;
            (ranked.present, ranked.local_of) = (layout.present, layout.local_of);
            ranked.tables = Some((layout.slots, layout.node_ranges));
        }
        ranked
    }

    /// Whether there is no other rank.
    pub(crate) fn is_single(&self) -> bool {
        self.team.is_single()
    }

    /// Number on this rank of an engine node; [`ABSENT`] for one of other ranks.
    pub(crate) fn local(&self, engine: u32) -> u32 {
        if self.is_single() {
            engine
        } else {
            self.local_of
                .get(engine as usize)
                .copied()
                .unwrap_or(ABSENT)
        }
    }

    /// Engine number of a node of this rank.
    pub(crate) fn engine(&self, local: usize) -> usize {
        self.present.get(local).map_or(local, |&node| node as usize)
    }

    /// The numbers on this rank from those of a model on one rank.
    pub(crate) fn numbering(&self, all: &Numbering) -> Numbering {
        if self.is_single() {
            all.clone()
        } else {
            all.on_rank(&self.present, &self.local_of)
        }
    }

    /// Slots and ranges of the nodes; none on one rank, where they follow from its blocks.
    pub(crate) fn take_tables(&mut self) -> Option<(SlotTable, NodeRanges)> {
        self.tables.take()
    }

    /// Mass (kg) and mass damping (kg/s, empty if there is none) of every node, with the shares of blocks of other ranks.
    pub(crate) fn lumped(
        &mut self,
        blocks: &[Box<dyn ElementBlock>],
        nodes_of_blocks: &[Vec<u32>],
    ) -> (Vec<f64>, Vec<f64>) {
        let mut shares: Vec<Quad<f64>> = Vec::with_capacity(self.exchange.slots);
        for (block, nodes) in blocks.iter().zip(nodes_of_blocks) {
            let mut of_block = vec![0.0; nodes.len()];
            block.add_mass(&mut of_block);
            let damping = block.damping().mass;
            let of_nodes = of_block.into_iter();
            shares.extend(of_nodes.map(|mass| Quad::new(mass, mass * damping, 0.0)));
        }
        shares.resize(self.exchange.slots, Quad::default());
        self.exchange.swap(&self.team, &mut shares);
        let Some((slots, _)) = &self.tables else {
            return (Vec::new(), Vec::new());
        };
        let sums = (0..slots.node_count()).map(|node| slots.sum(node, &shares).values);
        let (mass, mut damping): (Vec<f64>, Vec<f64>) = sums.map(|[m, c, ..]| (m, c)).unzip();
        if damping.iter().all(|&c| c == 0.0) {
            damping = Vec::new();
        }
        (mass, damping)
    }

    /// The constraints with nodes on this rank, restricted to them, and the engine numbers of their nodes.
    pub(crate) fn restrict(
        &mut self,
        constraints: Vec<Box<dyn Constraint>>,
        nodes: Vec<Vec<u32>>,
        numbers: &[u32],
    ) -> Result<Restricted, ModelError> {
        self.constraint_numbers = (0..constraints.len() as u32).collect();
        self.constraint_count = constraints.len();
        if self.is_single() {
            return Ok((constraints, nodes));
        }
        let engine = |node: u32| numbers.get(node as usize).copied().unwrap_or(ABSENT);
        let is_here = |nodes: &[u32]| nodes.iter().all(|&n| self.local(engine(n)) != ABSENT);
        let (mut kept, mut nodes, mut kept_numbers) = (Vec::new(), Vec::new(), Vec::new());
        let (mut joints, mut undivided) = (Vec::new(), Vec::new());
        for (number, mut constraint) in (0..).zip(constraints) {
            let views = constraint.jointed().map(|jointed| jointed.joints());
            joints.extend(views.iter().flatten().map(WholeJoint::of));
            let parts = ConstraintParts::of(constraint.as_ref());
            let parts: Vec<bool> = parts.iter().map(is_here).collect();
            let work = (constraint.divided()).and_then(|divided| divided.divided_work());
            if parts.len() > 1 && work.is_none() {
                undivided.push(constraint.name().into());
            }
            if !parts.contains(&true) {
                continue;
            }
            if parts.contains(&false) {
                match constraint.restricted() {
                    Some(restricted) => restricted.keep_parts(&parts),
                    None => {
                        let what = format!("constraint '{}', of which a part", constraint.name());
                        return Err(self.one_rank_only(what).into());
                    }
                }
            }
            if !is_here(constraint.nodes()) {
                let what = format!("constraint '{}' with nodes of no part", constraint.name());
                return Err(self.one_rank_only(what).into());
            }
            kept_numbers.push(number);
            nodes.push(
                constraint
                    .nodes()
                    .iter()
                    .map(|&node| engine(node))
                    .collect(),
            );
            kept.push(constraint);
        }
        (self.joints, self.undivided) = (joints, undivided);
        self.constraint_numbers = kept_numbers;
        Ok((kept, nodes))
    }

    /// The sections of a saved run of all ranks on rank 0, each name once.
    pub(crate) fn sections_of_all(&self, own: Vec<SavedSection>) -> Vec<SavedSection> {
        if self.is_single() {
            return own;
        }
        let mut all: Vec<SavedSection> = self.team.all_at_first(&own).concat();
        let mut names = HashSet::new();
        all.retain(|section| names.insert(section.name.clone()));
        all
    }

    /// For each constraint of this rank, whether it is true of it on any rank.
    pub(crate) fn of_constraints(&self, own: &[bool]) -> Vec<bool> {
        let mut all = vec![1; self.constraint_count];
        for (&number, own) in self.constraint_numbers.iter().zip(own) {
            all[number as usize] = u64::from(!own);
        }
        self.team.least_of_each(&mut all);
        let numbers = self.constraint_numbers.iter();
        numbers.map(|&number| all[number as usize] == 0).collect()
    }

    /// The error of a part that one rank alone can compute.
    pub(crate) fn one_rank_only(&self, what: impl Into<String>) -> EngineError {
        EngineError::OneRankOnly {
            what: what.into(),
            ranks: self.team.count(),
        }
    }
}
