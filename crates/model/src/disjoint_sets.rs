//! Disjoint sets (union-find).

/// A partition of the numbers from zero on into disjoint sets that can be merged, such as connected parts of a body.
///
/// ```
/// use powerhouse_model::DisjointSets;
/// let mut sets = DisjointSets::new(3);
/// sets.join(2, 1);
/// assert_eq!([sets.root(0), sets.root(1), sets.root(2)], [0, 1, 1]);
/// ```
#[derive(Clone, Debug)]
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// `count` numbers, each a set of its own.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }
    /// The representative of a number's set, its smallest number.
    ///
    /// # Panics
    /// If the number is beyond the count.
    pub fn root(&mut self, mut node: u32) -> u32 {
        while self.0[node as usize] != node {
            let above = self.0[self.0[node as usize] as usize];
            self.0[node as usize] = above;
            node = above;
        }
        node
    }
    /// Merges the sets of two numbers; the smaller representative remains.
    ///
    /// # Panics
    /// If a number is beyond the count.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
