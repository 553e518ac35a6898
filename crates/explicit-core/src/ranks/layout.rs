//! Which nodes and forces each rank has, and which it exchanges.

use std::collections::BTreeMap;

use powerhouse_model::ConstraintParts;

use super::exchange::{Exchange, Neighbour};
use crate::gather::SlotTable;
use crate::node_ranges::NodeRanges;

/// Number in place of that of a node that a rank does not have.
pub(crate) const ABSENT: u32 = u32::MAX;

/// The blocks of a model on all ranks. Nodes have their engine numbers, those of a model on one rank.
pub(crate) struct AllBlocks<'a> {
    /// Number of nodes.
    pub(crate) node_count: usize,
    /// Nodes of each block, in the global order of the blocks.
    pub(crate) nodes: &'a [Vec<u32>],
    /// Rank of each block.
    pub(crate) ranks: &'a [u32],
    /// Nodes that have to be on the same ranks, because their motion is computed together.
    pub(crate) parts: &'a ConstraintParts,
}

/// Nodes, slots and messages of one rank.
///
/// A rank has the nodes of its blocks, and all nodes whose motion is computed together with that of one of them. It
/// numbers them in the order of their engine numbers. The force of a node is the sum of one entry (slot) for each block
/// that has it, in the global order of the blocks: those of its own blocks, and those of other ranks, which it receives
/// behind its own.
pub(crate) struct Layout {
    /// Engine numbers of its nodes, in rising order.
    pub(crate) present: Vec<u32>,
    /// Number on this rank of each engine node.
    pub(crate) local_of: Vec<u32>,
    /// Slots of each of its nodes in the order of summation.
    pub(crate) slots: SlotTable,
    /// Ranges of the nodes that its blocks own.
    pub(crate) node_ranges: NodeRanges,
    pub(crate) exchange: Exchange,
}

/// The ranks that have each node: most nodes are on one.
struct Presence {
    first: Vec<u32>,
    others: BTreeMap<u32, Vec<u32>>,
}

impl Presence {
    fn of(all: &AllBlocks) -> Self {
        let mut presence = Self {
            first: vec![ABSENT; all.node_count],
            others: BTreeMap::new(),
        };
        for (nodes, &rank) in all.nodes.iter().zip(all.ranks) {
            for &node in nodes {
                presence.add(node, rank);
            }
        }
        for part in all.parts.iter() {
            let mut ranks: Vec<u32> = part.iter().flat_map(|&node| presence.ranks(node)).collect();
            ranks.sort_unstable();
            ranks.dedup();
            for &node in part {
                ranks.iter().for_each(|&rank| presence.add(node, rank));
            }
        }
        presence
    }
    fn add(&mut self, node: u32, rank: u32) {
        let first = &mut self.first[node as usize];
        if *first == ABSENT {
            *first = rank;
        } else if *first != rank {
            let others = self.others.entry(node).or_default();
            if !others.contains(&rank) {
                others.push(rank);
            }
        }
    }
    fn ranks(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        let first = Some(self.first[node as usize]).filter(|&rank| rank != ABSENT);
        let others = self.others.get(&node).into_iter().flatten();
        first.into_iter().chain(others.copied())
    }
    fn has(&self, node: u32, rank: u32) -> bool {
        self.ranks(node).any(|other| other == rank)
    }
    fn is_shared(&self, node: u32) -> bool {
        self.others.contains_key(&node)
    }
}

impl Layout {
    /// The layout of a rank among `count`.
    pub(crate) fn new(all: &AllBlocks, rank: u32, count: usize) -> Self {
        let presence = Presence::of(all);
        let nodes = 0..all.node_count as u32;
        let present: Vec<u32> = nodes.filter(|&node| presence.has(node, rank)).collect();
        let mut local_of = vec![ABSENT; all.node_count];
        for (local, &node) in (0..).zip(&present) {
            local_of[node as usize] = local;
        }
        let lengths: Vec<usize> = (all.nodes.iter().zip(all.ranks))
            .filter(|(_, owner)| **owner == rank)
            .map(|(nodes, _)| nodes.len())
            .collect();
        let own_slots = lengths.iter().sum();
        let mut incoming = vec![0; count];
        for (nodes, &owner) in all.nodes.iter().zip(all.ranks) {
            if owner != rank {
                let here = nodes
                    .iter()
                    .filter(|node| local_of[**node as usize] != ABSENT);
                incoming[owner as usize] += here.count();
            }
        }
        let mut neighbours = Vec::with_capacity(count);
        let mut end = own_slots;
        for (other, &slots) in incoming.iter().enumerate() {
            end += slots;
            neighbours.push(Neighbour {
                rank: other,
                outgoing: Vec::new(),
                incoming: end - slots..end,
            });
        }
        let mut next: Vec<usize> = neighbours.iter().map(|n| n.incoming.start).collect();
        next[rank as usize] = 0;
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (nodes, &owner) in all.nodes.iter().zip(all.ranks) {
            for &node in nodes {
                let local = local_of[node as usize];
                if local == ABSENT {
                    continue;
                }
                let slot = next[owner as usize];
                next[owner as usize] += 1;
                pairs.push((local, slot as u32));
                if owner == rank && presence.is_shared(node) {
                    for other in presence.ranks(node).filter(|&other| other != rank) {
                        neighbours[other as usize].outgoing.push(slot as u32);
                    }
                }
            }
        }
        neighbours.retain(|n| !(n.outgoing.is_empty() && n.incoming.is_empty()));
        let shared = present.iter().filter(|&&node| presence.is_shared(node));
        Self {
            node_ranges: NodeRanges::of_rank(all.nodes, all.ranks, rank, &local_of),
            exchange: Exchange::new(neighbours, shared.count(), end, &lengths),
            slots: SlotTable::of_pairs(present.len(), pairs.into_iter()),
            present,
            local_of,
        }
    }
}
