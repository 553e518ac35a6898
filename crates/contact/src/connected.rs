//! Sets of pairs that share nodes.

use std::collections::BTreeMap;

/// Sets of nodes that pairs connect, each in rising order.
pub(crate) fn connected_nodes(pairs: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut neighbours: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &[i, j] in pairs {
        neighbours.entry(i).or_default().push(j);
        neighbours.entry(j).or_default().push(i);
    }
    let mut groups = Vec::new();
    while let Some((&start, _)) = neighbours.first_key_value() {
        let mut group = Vec::new();
        let mut open = vec![start];
        while let Some(node) = open.pop() {
            if let Some(next) = neighbours.remove(&node) {
                group.push(node);
                open.extend(next);
            }
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups
}

/// Indices of pairs that nodes connect, set by set, in the order of the first pair of each.
pub(crate) fn connected_pairs(pairs: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut group_of = BTreeMap::new();
    for (group, nodes) in connected_nodes(pairs).iter().enumerate() {
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
