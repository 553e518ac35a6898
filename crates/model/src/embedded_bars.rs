//! Bars embedded in solid elements, as observers and engines see them.

use crate::ElementBlock;

/// Name of the history variable of axial forces (N, tension positive) of [embedded bars](EmbeddedBars).
pub const AXIAL_FORCE: &str = "axial_force";

/// Bars embedded in solid elements, such as a set of rock bolts, whose axial forces an observer reads.
///
/// [`StepView::embedded`](crate::StepView::embedded) returns the forces by the name of the set and
/// [`AXIAL_FORCE`], one value a segment, bar by bar.
pub trait EmbeddedBars {
    /// Name of the set.
    fn name(&self) -> &str;
    /// Number of segments of all bars.
    fn segment_count(&self) -> usize;
}

/// Elements embedded in those of a mesh, such as a set of rock bolts: units that act on nodes of the mesh and do not
/// depend on each other, so that an engine divides them into blocks.
///
/// An engine makes one block of all units whose hosts belong to the same block of the mesh: their forces are computed
/// beside those of other blocks, and where that block is.
///
/// The history variables of a block have names of their own, under which a state stores them, with one entry per
/// embedded element by its number among those of all units: a block takes its own from those of all.
pub trait EmbeddedElements: Send {
    /// Name, which is the label of all blocks.
    fn name(&self) -> &str;
    /// Host element (mesh index) of each unit: the one that has its first element; none for a unit without elements.
    fn hosts(&self) -> Vec<Option<u32>>;
    /// A block of some units, by their indices in rising order.
    fn block_of(&self, units: &[usize]) -> Box<dyn ElementBlock>;
}
