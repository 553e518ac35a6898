//! Sets of pairs that share nodes.

use std::collections::BTreeMap;

use powerhouse_model::ConstraintParts;

/// Indices of pairs in the same part, part by part, in the order of the first pair of each.
pub(crate) fn connected_pairs(pairs: &[[u32; 2]], parts: &ConstraintParts) -> Vec<Vec<u32>> {
    let mut group_of = BTreeMap::new();
    for (group, nodes) in parts.iter().enumerate() {
        group_of.extend(nodes.iter().map(|&node| (node, group)));
    }
    let mut index_of = BTreeMap::new();
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for (pair, [first, _]) in pairs.iter().enumerate() {
        let next = groups.len();
        let group = *index_of.entry(group_of[first]).or_insert(next);
        if group == next {
            groups.push(Vec::new());
        }
        groups[group].push(pair as u32);
    }
    groups
}
