//! Report of the content of a file.

use powerhouse_model::QualityReport;

/// Report of the content of an Abaqus input file and of its use in the mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct InpReport {
    /// Number of nodes in the file.
    pub nodes: usize,
    /// Number of elements in the file, all of which are in the mesh.
    pub elements: usize,
    /// Whether an element belongs to a set of the file that is not internal.
    pub has_element_sets: bool,
    /// Number of elements that belong to no such set: those of the set `all` or `ungrouped`.
    pub ungrouped_elements: usize,
    /// Number of nodes that no element of the mesh uses, which are dropped.
    pub dropped_nodes: usize,
    /// Number of elements of second order of which only the corners were read.
    pub lowered_elements: usize,
    /// Number of nodes at the middle of an edge that were not at its midpoint, and that were left out or moved there.
    pub curved_nodes: usize,
    /// Largest distance of such a node from the midpoint (m).
    pub largest_curve: f64,
    /// Names of the sets and surfaces without a member in the mesh, which are left out.
    pub empty_sets: Vec<String>,
    /// Names of the skipped keywords, such as `*MATERIAL`, in alphabetical order.
    pub skipped_keywords: Vec<String>,
    /// Quality of the element shapes.
    pub quality: QualityReport,
}
