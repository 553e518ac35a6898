//! Loads as the engine applies them: evaluated side by side, summed in a fixed order.

use powerhouse_model::{NodalLoad, Quad, Vec3};
use rayon::prelude::*;

use crate::gather::CHUNK;
use crate::nodes::Storage;

/// Which load, and which of its entries.
type Entry = (u32, u32);

/// Entries of some keys (nodes or groups), in rising order of keys and of loads.
#[derive(Default)]
struct Entries {
    keys: Vec<u32>,
    offsets: Vec<u32>,
    entries: Vec<Entry>,
}

impl Entries {
    fn new(mut all: Vec<(u32, Entry)>) -> Self {
        all.sort_unstable();
        let mut list = Self::default();
        for (key, entry) in all {
            if list.keys.last() != Some(&key) {
                list.keys.push(key);
                list.offsets.push(list.entries.len() as u32);
            }
            list.entries.push(entry);
        }
        list.offsets.push(list.entries.len() as u32);
        list
    }
    fn sum(&self, place: usize, forces: &[Vec<Vec3>]) -> Vec3 {
        let range = self.offsets[place] as usize..self.offsets[place + 1] as usize;
        self.entries[range]
            .iter()
            .map(|&(load, index)| forces[load as usize][index as usize])
            .sum()
    }
}

/// All loads of a model.
#[derive(Default)]
pub(crate) struct AppliedLoads {
    loads: Vec<Box<dyn NodalLoad>>,
    pub(crate) sums: LoadSums,
}

/// Forces of all loads, and which of them act on what.
#[derive(Default)]
pub(crate) struct LoadSums {
    /// Forces of each load (N) at the time of the last evaluation.
    forces: Vec<Vec<Vec3>>,
    plain: Entries,
    grouped: Entries,
    /// Place in `grouped` of each group, or `NONE`.
    place_of_group: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl AppliedLoads {
    /// From loads with the engine numbers of their nodes; `group_of` gives the group of a node.
    pub(crate) fn new(
        loads: Vec<(Box<dyn NodalLoad>, Vec<u32>)>,
        group_of: &[Option<u32>],
        group_count: usize,
    ) -> Self {
        let (mut plain, mut grouped) = (Vec::new(), Vec::new());
        for (load, (_, nodes)) in loads.iter().enumerate() {
            for (index, &node) in nodes.iter().enumerate() {
                let entry = (load as u32, index as u32);
                match group_of[node as usize] {
                    Some(group) => grouped.push((group, entry)),
                    None => plain.push((node, entry)),
                }
            }
        }
        let grouped = Entries::new(grouped);
        let mut place_of_group = vec![NONE; group_count];
        for (place, &group) in grouped.keys.iter().enumerate() {
            place_of_group[group as usize] = place as u32;
        }
        let forces = loads
            .iter()
            .map(|(_, nodes)| vec![Vec3::zeros(); nodes.len()])
            .collect();
        let sums = LoadSums {
            forces,
            plain: Entries::new(plain),
            grouped,
            place_of_group,
        };
        Self {
            loads: loads.into_iter().map(|(load, _)| load).collect(),
            sums,
        }
    }

    /// Evaluates every load at a time (s).
    pub(crate) fn evaluate(&mut self, time: f64) {
        self.loads
            .par_iter_mut()
            .zip(&mut self.sums.forces)
            .with_max_len(1)
            .for_each(|(load, forces)| {
                forces.fill(Vec3::zeros());
                load.add_forces(time, forces);
            });
    }
}

impl LoadSums {
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
        match self.place_of_group[group] {
            NONE => Vec3::zeros(),
            place => self.grouped.sum(place as usize, &self.forces),
        }
    }
}
