//! Report of the content of a file.

use powerhouse_model::QualityReport;

use super::format::{Encoding, GmshVersion};

/// Physical group of a Gmsh file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GmshGroup {
    /// Name of the group and of its set; `physical_DIMENSION_NUMBER` if it has none.
    pub name: String,
    /// Dimension of its elements: 0 points, 1 bars, 2 facets, 3 solids.
    pub dimension: usize,
    /// Number of the group in the file.
    pub number: i32,
    /// Number of elements of the file in the group; an empty group makes no set.
    pub elements: usize,
}

/// Report of the content of a Gmsh file and of its use in the mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GmshReport {
    /// Version of the format.
    pub version: GmshVersion,
    /// Encoding of the numbers, text or binary.
    pub encoding: Encoding,
    /// Number of nodes in the file.
    pub nodes: usize,
    /// Number of elements of every dimension in the file.
    pub elements: usize,
    /// Number of elements that repeat another one in a second group (version 2.2, and lines of several groups).
    pub merged_elements: usize,
    /// Number of lines, facets and points without a physical group, which are dropped.
    pub dropped_elements: usize,
    /// Number of lines of physical groups that are no bars; their nodes are node sets.
    pub curve_elements: usize,
    /// Number of solids with repeated nodes that were read as the wedges, pyramids and tetrahedra that they are.
    pub collapsed_elements: usize,
    /// Number of elements of the mesh without a physical group: those of the set `all` or
    /// `ungrouped`.
    pub ungrouped_elements: usize,
    /// Number of nodes that no element of the mesh uses, which are dropped.
    pub dropped_nodes: usize,
    /// Number of elements of second order of which only the corners were read.
    pub lowered_elements: usize,
    /// Number of nodes at the middle of an edge that were not at its midpoint, and that were left out or moved there.
    pub curved_nodes: usize,
    /// Largest distance of such a node from the midpoint (m).
    pub largest_curve: f64,
    /// Physical groups by dimension and number.
    pub groups: Vec<GmshGroup>,
    /// Names of the skipped sections.
    pub skipped_sections: Vec<String>,
    /// Quality of the element shapes.
    pub quality: QualityReport,
}
