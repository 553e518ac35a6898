//! Loads as the engine applies them: evaluated side by side, summed in a fixed order.
//!
//! Loads that do not change with time are evaluated, summed and written once; their work follows from
//! the displacement when somebody asks for it. The weight of a body at rest costs its steps nothing.

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
    fn of(&self, key_place: usize) -> &[u32] {
        &self.places[self.offsets[key_place] as usize..self.offsets[key_place + 1] as usize]
    }
    #[inline]
    fn sum(&self, key_place: usize, forces: &[Vec3]) -> Vec3 {
        let places = self.of(key_place).iter();
        places.fold(Vec3::zeros(), |sum, &place| sum + forces[place as usize])
    }
}

/// All loads of a model.
#[derive(Default)]
pub(crate) struct AppliedLoads {
    loads: Vec<Box<dyn NodalLoad>>,
    /// How many of them are the model's own; boundaries bring the others.
    own: usize,
    /// Nodal forces (N) carried over from a static solution, one per engine node; empty if there are none.
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
    /// Whether these are the same at all times.
    constant: Vec<bool>,
    plain: Places,
    grouped: Places,
    /// Which keys of `plain` have forces that change.
    changing: Vec<u32>,
    /// Whether the forces of constant loads are known.
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
        let mut constant: Vec<bool> = loads.iter().map(|(load, _)| load.is_constant()).collect();
        constant.push(true);
        let nodes: Vec<u32> = loads.iter().flat_map(|(_, nodes)| nodes).copied().collect();
        Self {
            loads: loads.into_iter().map(|(load, _)| load).collect(),
            own,
            standing: Vec::new(),
            sums: LoadSums::new(nodes, lengths, constant, (group_of, group_count)),
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

    /// Sets the nodal forces (N) that are carried over from a static solution, reactions and residual, and
    /// act beside the loads from now on.
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
        let constant = core::mem::take(&mut self.sums.constant);
        self.sums = LoadSums::new(nodes, lengths, constant, (group_of, group_count));
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

    /// Evaluates the loads at a time (s): those that change, and the others if they are not known yet.
    pub(crate) fn evaluate(&mut self, time: f64) {
        let all = !core::mem::replace(&mut self.sums.known, true);
        let constant = &self.sums.constant;
        let buffers = split(&mut self.sums.forces, &self.sums.lengths);
        let wanted: Vec<_> = (self.loads.iter_mut().zip(buffers))
            .zip(constant)
            .filter(|(_, constant)| all || !**constant)
            .map(|(load, _)| load)
            .collect();
        wanted
            .into_par_iter()
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
        constant: Vec<bool>,
        (group_of, group_count): (&[Option<u32>], usize),
    ) -> Self {
        let (mut plain, mut grouped) = (Vec::new(), Vec::new());
        for (place, &node) in nodes.iter().enumerate() {
            match group_of[node as usize] {
                Some(group) => grouped.push((group, place as u32)),
                None => plain.push((node, place as u32)),
            }
        }
        let plain = Places::new(plain, None);
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
            grouped: Places::new(grouped, Some(group_count as u32)),
            changing,
            known: false,
            written: false,
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

    /// Writes the sums at plain nodes; those that stay as they are were written by the first call.
    pub(crate) fn write_plain<S: Storage>(&mut self, external: &mut [Quad<S>]) {
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
                    *external = Quad::from_vector(&sum);
                }
            });
    }

    /// The sum on a group (N).
    #[inline]
    pub(crate) fn on_group(&self, group: usize) -> Vec3 {
        self.grouped.sum(group, &self.forces)
    }

    /// The power (W) of the loads that change, at velocities (m/s), summed in a fixed order.
    pub(crate) fn power(&self, velocity: impl Fn(usize) -> Vec3 + Sync) -> f64 {
        self.product(false, velocity)
    }

    /// What the constant loads would do (J) over displacements (m): the difference of two of these is
    /// their work between.
    pub(crate) fn potential(&self, displacement: impl Fn(usize) -> Vec3 + Sync) -> f64 {
        self.product(true, displacement)
    }

    /// The product of the forces of loads that are constant, or of those that are not, with vectors at
    /// their nodes.
    fn product(&self, constant: bool, vector: impl Fn(usize) -> Vec3 + Sync) -> f64 {
        let (mut sum, mut start) = (0.0, 0);
        for (&length, &is_constant) in self.lengths.iter().zip(&self.constant) {
            let own = start..start + length;
            start = own.end;
            if is_constant != constant {
                continue;
            }
            let chunks: Vec<f64> = (self.nodes[own.clone()].par_chunks(CHUNK))
                .zip(self.forces[own].par_chunks(CHUNK))
                .map(|(nodes, forces)| {
                    let pairs = nodes.iter().zip(forces);
                    pairs.map(|(&n, f)| f.dot(&vector(n as usize))).sum()
                })
                .collect();
            sum += chunks.iter().sum::<f64>();
        }
        sum
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
