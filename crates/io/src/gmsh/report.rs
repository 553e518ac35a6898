//! What a file held.

use powerhouse_model::QualityReport;

use super::format::{Encoding, GmshVersion};

/// A physical group of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GmshGroup {
    /// Its name, which is that of the set; `physical_DIMENSION_NUMBER` if it has none.
    pub name: String,
    /// 0 points, 1 bars, 2 facets, 3 solids.
    pub dimension: usize,
    /// Its number.
    pub number: i32,
    /// How many elements of the file belong to it; a group without any makes no set.
    pub elements: usize,
}

/// What a file held, and what became of it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GmshReport {
    /// Version of the format.
    pub version: GmshVersion,
    /// Text or binary.
    pub encoding: Encoding,
    /// Nodes in the file.
    pub nodes: usize,
    /// Elements of every dimension in the file.
    pub elements: usize,
    /// Elements that stood once more for a second group (version 2.2).
    pub merged_elements: usize,
    /// Lines, facets and points of no physical group.
    pub dropped_elements: usize,
    /// Elements of the mesh that belong to no physical group: those of the set `all` or
    /// `ungrouped`.
    pub ungrouped_elements: usize,
    /// Nodes that no element of the mesh uses.
    pub dropped_nodes: usize,
    /// The physical groups, by dimension and number.
    pub groups: Vec<GmshGroup>,
    /// Sections that were passed over.
    pub skipped_sections: Vec<String>,
    /// Shapes of the elements.
    pub quality: QualityReport,
}
