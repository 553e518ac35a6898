//! History variables of the pairs of a joint.

use core::ops::Range;
use std::collections::{HashMap, VecDeque};

use powerhouse_model::{ContactLaw, JointHistory, JointPair};

/// History variables of the pairs of one law, those of a pair side by side.
pub(super) struct PairHistories<'a> {
    /// Number of variables per pair.
    pub(super) variables: usize,
    /// Index among the pairs of the joint of the first pair of the law.
    pub(super) first: usize,
    /// Values, from the first pair of the law on.
    pub(super) values: &'a mut [f64],
}

impl<'a> PairHistories<'a> {
    /// Cuts off the values of a range of pairs, and what precedes them.
    pub(super) fn take(&mut self, pairs: &Range<usize>) -> PairHistories<'a> {
        let values = core::mem::take(&mut self.values);
        let (_, from) = values.split_at_mut((pairs.start - self.first) * self.variables);
        let (own, rest) = from.split_at_mut(pairs.len() * self.variables);
        (self.first, self.values) = (pairs.end, rest);
        PairHistories {
            variables: self.variables,
            first: pairs.start,
            values: own,
        }
    }
    /// Copies the values of some pairs, by their indices among the pairs of the joint, to the front of two
    /// lists.
    pub(super) fn gather(&self, pairs: &[u32], rows: &mut [Vec<f64>; 2]) {
        let count = self.variables;
        for (k, &pair) in pairs.iter().enumerate() {
            let start = (pair as usize - self.first) * count;
            for row in &mut *rows {
                row[k * count..(k + 1) * count].copy_from_slice(&self.values[start..start + count]);
            }
        }
    }
    /// Sets the values of some pairs from the front of a list.
    pub(super) fn scatter(&mut self, pairs: &[u32], row: &[f64]) {
        let count = self.variables;
        for (k, &pair) in pairs.iter().enumerate() {
            let start = (pair as usize - self.first) * count;
            self.values[start..start + count].copy_from_slice(&row[k * count..(k + 1) * count]);
        }
    }
}

/// Initial history variables of some pairs of a law, those of a pair side by side.
pub(super) fn initial_history<L: ContactLaw>(law: &L, pairs: usize) -> Vec<f64> {
    let mut of_pair = vec![0.0; law.history().len()];
    law.initial_history(&mut of_pair);
    of_pair.repeat(pairs)
}

/// History variables of a law from those of an earlier run, for its pairs given by their indices in that
/// run; a variable that the run did not have is initial. None if lists do not fit each other.
pub(super) fn restored_history<L: ContactLaw>(
    law: &L,
    earlier: &JointHistory,
    pairs: &[usize],
) -> Option<Vec<f64>> {
    let count = earlier.variables.len();
    if earlier.history.len() != earlier.records.len() * count {
        return None;
    }
    let mut values = initial_history(law, pairs.len());
    let variables = law.history();
    for (v, variable) in variables.iter().enumerate() {
        let Some(of_run) = earlier.variables.iter().position(|n| n == variable.name) else {
            continue;
        };
        for (row, &pair) in values.chunks_exact_mut(variables.len()).zip(pairs) {
            row[v] = earlier.history[pair * count + of_run];
        }
    }
    Some(values)
}

/// Indices in an earlier run of some pairs; none if it did not have the same pairs.
pub(super) fn in_order_of(pairs: &[JointPair], history: &JointHistory) -> Option<Vec<usize>> {
    let mut of_nodes: HashMap<[u32; 2], VecDeque<usize>> = HashMap::new();
    for (index, (nodes, _)) in history.nodes.iter().zip(&history.records).enumerate() {
        of_nodes.entry(*nodes).or_default().push_back(index);
    }
    let next = |pair: &JointPair| of_nodes.get_mut(&pair.nodes)?.pop_front();
    let found: Option<Vec<usize>> = pairs.iter().map(next).collect();
    found.filter(|found| found.len() == history.records.len())
}
