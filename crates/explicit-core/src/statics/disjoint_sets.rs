//! Disjoint sets (union-find).

/// A partition of the numbers from zero on into disjoint sets that can be merged.
pub(crate) struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// `count` numbers, each a set of its own.
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }
    /// The representative of a number's set.
    pub(crate) fn root(&mut self, mut node: u32) -> u32 {
        while self.0[node as usize] != node {
            let above = self.0[self.0[node as usize] as usize];
            self.0[node as usize] = above;
            node = above;
        }
        node
    }
    /// Merges the sets of two numbers; the smaller representative remains.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
