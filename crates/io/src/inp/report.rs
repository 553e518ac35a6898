//! Report of the content of a file.

use powerhouse_model::QualityReport;

/// Report of the content of an Abaqus input file and of its use in the mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct InpReport {
    /// Number of nodes in the file.
    pub nodes: usize,
    /// Number of solids, bars, shells and plane elements in the file.
    pub elements: usize,
    /// Number of the shells and plane elements among them, which are facets of the mesh.
    pub facet_elements: usize,
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
    /// Number of solids with repeated nodes that were read as the wedges, pyramids and tetrahedra that they are.
    pub collapsed_elements: usize,
    /// Number of elements with temperatures or pore pressures as further unknowns, of which the shapes alone were read.
    pub coupled_elements: usize,
    /// Number of nodes with fewer than three coordinates, the others of which are zero.
    pub omitted_coordinates: usize,
    /// Elements that are left out, such as springs, dashpots and masses: type and number.
    pub left_out: Vec<(String, usize)>,
    /// Name of each of several instances, and what was added to its numbers of nodes and elements.
    pub instances: Vec<(String, u64)>,
    /// Names of the sets and surfaces without a member in the mesh, which are left out.
    pub empty_sets: Vec<String>,
    /// Names of the skipped keywords, such as `*MATERIAL`, in alphabetical order.
    pub skipped_keywords: Vec<String>,
    /// Quality of the element shapes.
    pub quality: QualityReport,
}
