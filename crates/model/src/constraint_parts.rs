//! Parts of constraints: nodes that must be corrected together.

use crate::{Constraint, DisjointSets};

/// Parts of constraints: disjoint sets of nodes (mesh indices), in a fixed order.
///
/// To correct the nodes of a part a constraint reads and changes no node of another one, so that parts can be
/// corrected side by side, and each where all its nodes are.
///
/// ```
/// use powerhouse_model::ConstraintParts;
/// // Two pairs that share a node, and one by itself.
/// let parts = ConstraintParts::connected_by(&[[4, 9], [2, 7], [9, 5]]);
/// assert_eq!(parts.iter().collect::<Vec<_>>(), [&[2, 7][..], &[4, 5, 9]]);
/// // Where nodes 0 to 6 are present, nodes of both parts are missing.
/// let here = |node| node < 7;
/// assert_eq!(parts.divided(here), Some(0));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ConstraintParts {
    /// Nodes of all parts, part by part.
    nodes: Vec<u32>,
    /// End of each part in `nodes`.
    ends: Vec<u32>,
}

impl ConstraintParts {
    /// The parts of a constraint: those into which it is [divided](Constraint::divided), or one of all its nodes.
    pub fn of(constraint: &dyn Constraint) -> Self {
        let divided = constraint.divided().map(|divided| divided.parts());
        divided.unwrap_or_else(|| Self::whole(constraint.nodes()))
    }

    /// One part of all these nodes; no part without nodes.
    pub fn whole(nodes: &[u32]) -> Self {
        let mut parts = Self::default();
        parts.push(nodes.iter().copied());
        parts
    }

    /// The parts that node pairs connect, see [`merged`](Self::merged).
    pub fn connected_by(pairs: &[[u32; 2]]) -> Self {
        Self::merged(pairs.iter().map(|pair| &pair[..]))
    }

    /// The parts of nodes of some sets: sets that share a node are in the same part. Nodes of a part are in rising order, parts in the
    /// order of their first nodes.
    pub fn merged<'n>(sets: impl IntoIterator<Item = &'n [u32]>) -> Self {
        let sets: Vec<&[u32]> = sets.into_iter().collect();
        let mut nodes = sets.concat();
        nodes.sort_unstable();
        nodes.dedup();
        let index = |node: u32| nodes.partition_point(|&other| other < node) as u32;
        let mut joined = DisjointSets::new(nodes.len());
        for set in sets {
            for pair in set.windows(2) {
                joined.join(index(pair[0]), index(pair[1]));
            }
        }
        // The root of a set is its first node.
        let roots: Vec<u32> = (0..nodes.len() as u32).map(|i| joined.root(i)).collect();
        let mut order: Vec<u32> = (0..nodes.len() as u32).collect();
        order.sort_by_key(|&i| roots[i as usize]);
        let mut parts = Self::default();
        for part in order.chunk_by(|&a, &b| roots[a as usize] == roots[b as usize]) {
            parts.push(part.iter().map(|&i| nodes[i as usize]));
        }
        parts
    }

    /// Adds a part; none without nodes.
    fn push(&mut self, nodes: impl Iterator<Item = u32>) {
        let before = self.nodes.len();
        self.nodes.extend(nodes);
        if self.nodes.len() > before {
            self.ends.push(self.nodes.len() as u32);
        }
    }

    /// Number of parts.
    pub fn len(&self) -> usize {
        self.ends.len()
    }
    /// Whether there are no parts.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }
    /// Nodes of all parts, part by part.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    /// Nodes of each part.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        let mut start = 0;
        self.ends.iter().map(move |&end| {
            let part = &self.nodes[start..end as usize];
            start = end as usize;
            part
        })
    }
    /// The first part of which some nodes are present and others are not: it could be corrected nowhere.
    pub fn divided(&self, present: impl Fn(u32) -> bool) -> Option<usize> {
        self.iter().position(|part| {
            let here = part.iter().filter(|&&node| present(node)).count();
            here > 0 && here < part.len()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sets are joined over any chain of shared nodes, whatever their order, and a part is divided only where some of
    /// its nodes are present.
    #[test]
    fn sets_that_share_nodes_are_one_part() {
        let sets: [&[u32]; 5] = [&[8, 3], &[6], &[], &[1, 9, 8], &[2, 4]];
        let expected: [&[u32]; 3] = [&[1, 3, 8, 9], &[2, 4], &[6]];
        let parts = ConstraintParts::merged(sets);
        assert_eq!(parts.iter().collect::<Vec<_>>(), expected);
        let reversed = ConstraintParts::merged(sets.into_iter().rev());
        assert_eq!(parts, reversed);
        assert_eq!((parts.len(), parts.nodes().len()), (3, 7));
        assert_eq!(parts.divided(|_| true), None);
        assert_eq!(parts.divided(|node| node == 6), None);
        assert_eq!(parts.divided(|node| node != 4), Some(1));
        assert!(ConstraintParts::whole(&[]).is_empty());
        assert_eq!(ConstraintParts::whole(&[5, 2]).nodes(), [5, 2]);
    }
}
