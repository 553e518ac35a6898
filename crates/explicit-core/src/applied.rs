//! Loads as the engine applies them: evaluated side by side, summed in a fixed order.

use powerhouse_model::{NodalLoad, Quad, Vec3};
use rayon::prelude::*;

use crate::gather::CHUNK;
use crate::nodes::Storage;

/// Places of forces that act on the same key (node or group), in rising order of keys and loads.
#[derive(Default)]
struct Places {
    keys: Vec<u32>,
    offsets: Vec<u32>,
    places: Vec<u32>,
}

impl Places {
    /// From pairs of key and place; with `all` keys from zero to it, else those that occur.
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
            places: pairs.into_iter().map(|(_, place)| place).collect(),
        }
    }
    #[inline]
    fn sum(&self, key_place: usize, forces: &[Vec3]) -> Vec3 {
        let range = self.offsets[key_place] as usize..self.offsets[key_place + 1] as usize;
        let places = self.places[range].iter();
        places.fold(Vec3::zeros(), |sum, &place| sum + forces[place as usize])
    }
}

/// All loads of a model.
#[derive(Default)]
pub(crate) struct AppliedLoads {
    loads: Vec<Box<dyn NodalLoad>>,
    /// How many of them are the model's own; boundaries bring the others.
    own: usize,
    /// Forces (N) that act beside the loads, one per engine node; empty if there are none.
    standing: Vec<Vec3>,
    pub(crate) sums: LoadSums,
}

/// Forces of all loads, one load behind the other, and what they act on.
#[derive(Default)]
pub(crate) struct LoadSums {
    /// Engine node of each force.
    nodes: Vec<u32>,
    /// Forces (N) at the time of the last evaluation.
    forces: Vec<Vec3>,
    /// How many forces each load has, the standing ones last.
    lengths: Vec<usize>,
    plain: Places,
    grouped: Places,
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
        let nodes: Vec<u32> = loads.iter().flat_map(|(_, nodes)| nodes).copied().collect();
        Self {
            loads: loads.into_iter().map(|(load, _)| load).collect(),
            own,
            standing: Vec::new(),
            sums: LoadSums::new(nodes, lengths, group_of, group_count),
        }
    }

    /// Whether there are loads or forces beside them.
    pub(crate) fn any(&self) -> bool {
        !(self.loads.is_empty() && self.standing.is_empty())
    }

    /// Forces (N) that act beside the loads, one per engine node; empty if there are none.
    pub(crate) fn standing(&self) -> &[Vec3] {
        &self.standing
    }

    /// Lets forces act beside the loads from now on.
    pub(crate) fn set_standing(
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
        self.sums = LoadSums::new(nodes, lengths, group_of, group_count);
        self.standing = forces;
        self.sums.put_standing(&self.standing);
    }

    /// The model's own loads (N) at a time (s), added by engine node; neither those of boundaries nor
    /// the standing forces.
    pub(crate) fn add_own(&mut self, time: f64, forces: &mut [Vec3]) {
        self.evaluate(time);
        let count: usize = self.sums.lengths[..self.own].iter().sum();
        let own = self.sums.nodes[..count].iter().zip(&self.sums.forces);
        for (&node, force) in own {
            forces[node as usize] += force;
        }
    }

    /// The loads (N) at a time (s), added by engine node, without the standing forces.
    pub(crate) fn add_all(&mut self, time: f64, forces: &mut [Vec3]) {
        self.evaluate(time);
        let standing = self.sums.lengths.last().copied().unwrap_or(0);
        let count = self.sums.nodes.len() - standing;
        let all = self.sums.nodes[..count].iter().zip(&self.sums.forces);
        for (&node, force) in all {
            forces[node as usize] += force;
        }
    }

    /// Evaluates every load at a time (s).
    pub(crate) fn evaluate(&mut self, time: f64) {
        let buffers = split(&mut self.sums.forces, &self.sums.lengths);
        self.loads
            .par_iter_mut()
            .zip(buffers)
            .with_max_len(1)
            .for_each(|(load, forces)| {
                forces.fill(Vec3::zeros());
                load.add_forces(time, forces);
            });
    }
}

impl LoadSums {
    fn new(
        nodes: Vec<u32>,
        lengths: Vec<usize>,
        group_of: &[Option<u32>],
        group_count: usize,
    ) -> Self {
        let (mut plain, mut grouped) = (Vec::new(), Vec::new());
        for (place, &node) in nodes.iter().enumerate() {
            match group_of[node as usize] {
                Some(group) => grouped.push((group, place as u32)),
                None => plain.push((node, place as u32)),
            }
        }
        Self {
            forces: vec![Vec3::zeros(); nodes.len()],
            nodes,
            lengths,
            plain: Places::new(plain, None),
            grouped: Places::new(grouped, Some(group_count as u32)),
        }
    }

    /// Takes over the standing forces; evaluating the loads leaves them as they are.
    fn put_standing(&mut self, standing: &[Vec3]) {
        let count = self.lengths.last().copied().unwrap_or(0);
        let first = self.nodes.len() - count;
        for (force, &node) in self.forces[first..].iter_mut().zip(&self.nodes[first..]) {
            *force = standing[node as usize];
        }
    }

    /// Whether any plain node is loaded.
    pub(crate) fn on_plain_nodes(&self) -> bool {
        !self.plain.keys.is_empty()
    }

    /// Writes the sums at plain nodes.
    pub(crate) fn write_plain<S: Storage>(&self, external: &mut [Quad<S>]) {
        let keys = &self.plain.keys;
        external
            .par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, external)| {
                let start = chunk * CHUNK;
                let first = keys.partition_point(|&node| (node as usize) < start);
                let end = start + external.len();
                for (place, &node) in keys.iter().enumerate().skip(first) {
                    if node as usize >= end {
                        break;
                    }
                    let sum = self.plain.sum(place, &self.forces);
                    external[node as usize - start] = Quad::from_vector(&sum);
                }
            });
    }

    /// The sum on a group (N).
    #[inline]
    pub(crate) fn on_group(&self, group: usize) -> Vec3 {
        self.grouped.sum(group, &self.forces)
    }

    /// The power (W) of all loads at velocities (m/s), summed in a fixed order.
    pub(crate) fn power(&self, velocity: impl Fn(usize) -> Vec3 + Sync) -> f64 {
        let chunks: Vec<f64> = (self.nodes.par_chunks(CHUNK))
            .zip(self.forces.par_chunks(CHUNK))
            .map(|(nodes, forces)| {
                let pairs = nodes.iter().zip(forces);
                pairs.map(|(&n, f)| f.dot(&velocity(n as usize))).sum()
            })
            .collect();
        chunks.iter().sum()
    }
}

/// Cuts a buffer into consecutive pieces.
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
