//! Bars embedded in solid elements, as observers see them.

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
