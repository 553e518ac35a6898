//! Applied nodal loads: evaluated in parallel, summed in a fixed order.
//!
//! Constant loads are evaluated, summed and written once; their work follows from
//! the displacement and is computed on demand, so that a constant weight costs no time per step.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use powerhouse_model::{NodalLoad, Quad, Vec3};
use rayon::prelude::*;

use crate::gather::CHUNK;
use crate::nodes::Storage;
use crate::ranks::ABSENT;

/// Indices of the forces that act on the same key (node or group), as offsets and a flat list, in rising order of
/// keys and loads.
#[derive(Default)]
struct ForceTable {
    keys: Vec<u32>,
    offsets: Vec<u32>,
    indices: Vec<u32>,
}

impl ForceTable {
    /// From pairs of key and force index; with `all` the keys from zero to it, else those that occur.
    fn new(mut pairs: Vec<(u32, u32)>, all: Option<u32>) -> Self {
        pairs.sort_unstable();
        let keys = match all {
            Some(count) => (0..count).collect(),
            None => {
                let mut keys: Vec<u32> = pairs.iter().map(|&(key, _)| key).collect();
                keys.dedup();
                keys
            }
        };
        let start = |key: u32| pairs.partition_point(|&(k, _)| k < key) as u32;
        let mut offsets: Vec<u32> = keys.iter().map(|&key| start(key)).collect();
        offsets.push(pairs.len() as u32);
        Self {
            keys,
            offsets,
            indices: pairs.into_iter().map(|(_, index)| index).collect(),
        }
    }
    #[inline]
    fn of(&self, key: usize) -> &[u32] {
        &self.indices[self.offsets[key] as usize..self.offsets[key + 1] as usize]
    }
    #[inline]
    fn sum(&self, key: usize, forces: &[Vec3]) -> Vec3 {
        let indices = self.of(key).iter();
        indices.fold(Vec3::zeros(), |sum, &index| sum + forces[index as usize])
    }
}

/// All applied loads of a model, with the forces carried over from a static solution.
#[derive(Default)]
pub(crate) struct AppliedLoads {
    loads: Vec<Box<dyn NodalLoad>>,
    /// Number of loads that do not belong to absorbing boundaries; these come first.
    own: usize,
    /// Whether each load acts on a node of this rank; the others are not evaluated.
    here: Vec<bool>,
    /// Nodal forces (N) carried over from a static solution, one per engine node; empty if there are none.
    carried: Vec<Vec3>,
    pub(crate) sums: LoadSums,
}

/// Forces of all loads, load by load, with the nodes and groups on which they act.
#[derive(Default)]
pub(crate) struct LoadSums {
    /// Local number of the node of each force; [`ABSENT`] for a node of other ranks.
    nodes: Vec<u32>,
    /// Forces (N) at the time of the last evaluation.
    forces: Vec<Vec3>,
    /// Number of forces of each load; the carried forces count as the last load.
    lengths: Vec<usize>,
    /// Whether each load is constant in time.
    constant: Vec<bool>,
    plain: ForceTable,
    grouped: ForceTable,
    /// Indices into the keys of `plain` with forces that change in time.
    changing: Vec<u32>,
    /// Whether the forces of constant loads have been evaluated.
    known: bool,
    /// Whether all sums at plain nodes have been written.
    written: bool,
}

impl AppliedLoads {
    /// From loads with the engine numbers of their nodes, of which the first `own` do not belong to
    /// boundaries; `group_of` gives the group of a node.
    pub(crate) fn new(
        loads: Vec<(Box<dyn NodalLoad>, Vec<u32>)>,
        own: usize,
        group_of: &[Option<u32>],
        group_count: usize,
    ) -> Self {
        let mut lengths: Vec<usize> = loads.iter().map(|(_, nodes)| nodes.len()).collect();
        lengths.push(0);
        let is_here = |nodes: &[u32]| nodes.iter().any(|&node| node != ABSENT);
        let here = loads.iter().map(|(_, nodes)| is_here(nodes)).collect();
        let mut constant: Vec<bool> = loads.iter().map(|(load, _)| load.is_constant()).collect();
        constant.push(true);
        let nodes: Vec<u32> = loads.iter().flat_map(|(_, nodes)| nodes).copied().collect();
        Self {
            loads: loads.into_iter().map(|(load, _)| load).collect(),
            own,
            here,
            carried: Vec::new(),
            sums: LoadSums::new(nodes, lengths, constant, (group_of, group_count)),
        }
    }

    /// All loads, without carried forces.
    pub(crate) fn all(&self) -> &[Box<dyn NodalLoad>] {
        &self.loads
    }
    /// Whether each of them acts on a node of this rank.
    pub(crate) fn here(&self) -> &[bool] {
        &self.here
    }
    /// The same, mutable.
    pub(crate) fn all_mut(&mut self) -> &mut [Box<dyn NodalLoad>] {
        &mut self.loads
    }

    /// Whether there are loads or carried forces.
    pub(crate) fn any(&self) -> bool {
        !(self.loads.is_empty() && self.carried.is_empty())
    }

    /// Forces (N) carried over from a static solution, one per engine node; empty if there are none.
    pub(crate) fn carried(&self) -> &[Vec3] {
        &self.carried
    }

    /// Sets the nodal forces (N) carried over from a static solution (reactions and residual), which are
    /// applied in addition to the loads.
    pub(crate) fn set_carried(
        &mut self,
        forces: Vec<Vec3>,
        group_of: &[Option<u32>],
        group_count: usize,
    ) {
        let before = self.sums.lengths.pop().unwrap_or(0);
        if forces.is_empty() && before == 0 {
            self.sums.lengths.push(0);
            return;
        }
        let mut nodes = core::mem::take(&mut self.sums.nodes);
        nodes.truncate(nodes.len() - before);
        let held = (0..).zip(&forces).filter(|(_, f)| **f != Vec3::zeros());
        let held: Vec<u32> = held.map(|(node, _)| node).collect();
        nodes.extend_from_slice(&held);
        let mut lengths = core::mem::take(&mut self.sums.lengths);
        lengths.push(held.len());
        let constant = core::mem::take(&mut self.sums.constant);
        self.sums = LoadSums::new(nodes, lengths, constant, (group_of, group_count));
        self.carried = forces;
        self.sums.put_carried(&self.carried);
    }

    /// Assigns the loads to other groups of the nodes.
    pub(crate) fn regroup(&mut self, group_of: &[Option<u32>], group_count: usize) {
        let LoadSums {
            nodes,
            lengths,
            constant,
            ..
        } = core::mem::take(&mut self.sums);
        self.sums = LoadSums::new(nodes, lengths, constant, (group_of, group_count));
        self.sums.put_carried(&self.carried);
    }

    /// Adds the loads (N) at a time (s) by engine node, without those of absorbing boundaries and without the
    /// carried forces.
    pub(crate) fn add_own(&mut self, time: f64, forces: &mut [Vec3]) {
        self.evaluate(time, None);
        let count: usize = self.sums.lengths[..self.own].iter().sum();
        let own = self.sums.nodes[..count].iter().zip(&self.sums.forces);
        for (&node, force) in own {
            if let Some(sum) = forces.get_mut(node as usize) {
                *sum += force;
            }
        }
    }

    /// Adds the loads (N) at a time (s) by local node, without the carried forces.
    pub(crate) fn add_all(&mut self, time: f64, forces: &mut [Vec3]) {
        self.evaluate(time, None);
        let carried = self.sums.lengths.last().copied().unwrap_or(0);
        let count = self.sums.nodes.len() - carried;
        let all = self.sums.nodes[..count].iter().zip(&self.sums.forces);
        for (&node, force) in all {
            if let Some(sum) = forces.get_mut(node as usize) {
                *sum += force;
            }
        }
    }

    /// Evaluates the loads at a time (s): those that change in time, and at the first call the constant ones. Adds
    /// their processor time (ns) to `spent`.
    pub(crate) fn evaluate(&mut self, time: f64, spent: Option<&AtomicU64>) {
        let all = !core::mem::replace(&mut self.sums.known, true);
        let constant = &self.sums.constant;
        let buffers = split(&mut self.sums.forces, &self.sums.lengths);
        let wanted: Vec<_> = (self.loads.iter_mut().zip(buffers))
            .zip(constant.iter().zip(&self.here))
            .filter(|(_, (constant, here))| **here && (all || !**constant))
            .map(|(load, _)| load)
            .collect();
        wanted
            .into_par_iter()
            .with_max_len(1)
            .for_each(|(load, forces)| {
                let start = spent.map(|_| Instant::now());
                forces.fill(Vec3::zeros());
                load.add_forces(time, forces);
                if let (Some(spent), Some(start)) = (spent, start) {
                    spent.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
                }
            });
    }
}

impl LoadSums {
    fn new(
        nodes: Vec<u32>,
        lengths: Vec<usize>,
        constant: Vec<bool>,
        (group_of, group_count): (&[Option<u32>], usize),
    ) -> Self {
        let (mut plain, mut grouped) = (Vec::new(), Vec::new());
        for (index, &node) in nodes.iter().enumerate() {
            match group_of.get(node as usize) {
                Some(&Some(group)) => grouped.push((group, index as u32)),
                Some(None) => plain.push((node, index as u32)),
                // A node of other ranks.
                None => {}
            }
        }
        let plain = ForceTable::new(plain, None);
        let of_load = (constant.iter().zip(&lengths))
            .flat_map(|(&constant, &length)| core::iter::repeat_n(!constant, length));
        let changes: Vec<bool> = of_load.collect();
        let changing = (0..plain.keys.len() as u32)
            .filter(|&key| plain.of(key as usize).iter().any(|&p| changes[p as usize]))
            .collect();
        Self {
            forces: vec![Vec3::zeros(); nodes.len()],
            nodes,
            lengths,
            constant,
            plain,
            grouped: ForceTable::new(grouped, Some(group_count as u32)),
            changing,
            known: false,
            written: false,
        }
    }

    /// Stores the carried forces; evaluating the loads does not change them.
    fn put_carried(&mut self, carried: &[Vec3]) {
        let count = self.lengths.last().copied().unwrap_or(0);
        let first = self.nodes.len() - count;
        for (force, &node) in self.forces[first..].iter_mut().zip(&self.nodes[first..]) {
            *force = carried[node as usize];
        }
    }

    /// Whether any plain node is loaded.
    pub(crate) fn on_plain_nodes(&self) -> bool {
        !self.plain.keys.is_empty()
    }

    /// Writes the sums at plain nodes: all at the first call, then those that change in time.
    pub(crate) fn write_plain<S: Storage>(&mut self, external: &mut [[S; 4]]) {
        let every: Vec<u32>;
        let wanted = if core::mem::replace(&mut self.written, true) {
            &self.changing
        } else {
            every = (0..self.plain.keys.len() as u32).collect();
            &every
        };
        let node_of = |key: u32| self.plain.keys[key as usize] as usize;
        external
            .par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, external)| {
                let start = chunk * CHUNK;
                let first = wanted.partition_point(|&key| node_of(key) < start);
                for &key in &wanted[first..] {
                    let Some(external) = external.get_mut(node_of(key) - start) else {
                        break;
                    };
                    let sum = self.plain.sum(key as usize, &self.forces);
                    *external = Quad::from_vector(&sum).values;
                }
            });
    }

    /// Local numbers of the plain nodes with forces that change in time.
    pub(crate) fn changing_nodes(&self) -> Vec<u32> {
        let keys = self.changing.iter();
        keys.map(|&key| self.plain.keys[key as usize]).collect()
    }

    /// Groups with forces that change in time.
    pub(crate) fn changing_groups(&self) -> Vec<u32> {
        let constant: Vec<bool> = self.places().map(|(_, constant)| constant).collect();
        let count = self.grouped.offsets.len() as u32 - 1;
        let changes = |&group: &u32| {
            let indices = self.grouped.of(group as usize).iter();
            indices.clone().any(|&index| !constant[index as usize])
        };
        (0..count).filter(changes).collect()
    }

    /// The sums at plain nodes (N), one per node; empty if there are none.
    pub(crate) fn at_plain_nodes(&self, nodes: usize) -> Vec<Vec3> {
        if !self.on_plain_nodes() {
            return Vec::new();
        }
        let mut sums = vec![Vec3::zeros(); nodes];
        for (key, &node) in self.plain.keys.iter().enumerate() {
            sums[node as usize] = self.plain.sum(key, &self.forces);
        }
        sums
    }

    /// Appends the sums at the nodes of [`changing_nodes`](Self::changing_nodes) (N).
    pub(crate) fn append_changing(&self, out: &mut Vec<Vec3>) {
        let keys = self.changing.iter();
        out.extend(keys.map(|&key| self.plain.sum(key as usize, &self.forces)));
    }

    /// Whether any force acts on a group.
    pub(crate) fn acts_on(&self, group: usize) -> bool {
        !self.grouped.of(group).is_empty()
    }

    /// The sum of forces on a group (N).
    #[inline]
    pub(crate) fn on_group(&self, group: usize) -> Vec3 {
        self.grouped.sum(group, &self.forces)
    }

    /// Local number of the node of each force, and whether the force is constant in time.
    pub(crate) fn places(&self) -> impl Iterator<Item = (u32, bool)> + '_ {
        let of_load = (self.constant.iter().zip(&self.lengths))
            .flat_map(|(&constant, &length)| core::iter::repeat_n(constant, length));
        self.nodes.iter().copied().zip(of_load)
    }

    /// Sum of products of the forces of some indices with vectors at their nodes, in the order of the indices.
    pub(crate) fn product(
        &self,
        indices: &[u32],
        vector: impl Fn(usize) -> Vec3,
        of: impl Fn(&Vec3, &Vec3) -> f64,
    ) -> f64 {
        let terms = indices.iter().map(|&index| {
            let (node, force) = (self.nodes[index as usize], self.forces[index as usize]);
            of(&force, &vector(node as usize))
        });
        terms.sum()
    }
}

/// Divides a buffer into consecutive parts of given lengths.
pub(crate) fn split<'a, T>(buffer: &'a mut [T], lengths: &[usize]) -> Vec<&'a mut [T]> {
    let mut rest = buffer;
    lengths
        .iter()
        .map(|&length| {
            let (own, others) = core::mem::take(&mut rest).split_at_mut(length);
            rest = others;
            own
        })
        .collect()
}
