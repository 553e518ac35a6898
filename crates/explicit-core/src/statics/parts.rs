//! Sets that are joined step by step.

/// Numbers from zero on, each in one of several sets.
pub(super) struct Parts(Vec<u32>);

impl Parts {
    /// So many numbers, each a set of its own.
    pub(super) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }
    /// The least number of the set that a number belongs to.
    pub(super) fn root(&mut self, mut node: u32) -> u32 {
        while self.0[node as usize] != node {
            let above = self.0[self.0[node as usize] as usize];
            self.0[node as usize] = above;
            node = above;
        }
        node
    }
    /// Makes two sets one.
    pub(super) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
