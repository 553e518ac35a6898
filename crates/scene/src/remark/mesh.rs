//! Remarks about the mesh file.

use std::path::PathBuf;

use super::{Item, Kind};
use crate::Topic;

/// Text about a mesh of what was found in its file.
fn mesh<const N: usize>(found: [Option<String>; N]) -> String {
    let found: Vec<String> = found.into_iter().flatten().collect();
    format!("mesh: {}", found.join("; "))
}

/// Number of some objects of a file and what happens to them, if there are any.
fn counted(count: usize, words: &str) -> Option<String> {
    (count > 0).then(|| format!("{count} {words}"))
}

/// Fact: the mesh file has nodes and elements that were left out of the mesh, or that belong to no physical group.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Number of nodes without elements.
    pub nodes: usize,
    /// Number of lines, facets and points without physical group.
    pub dropped: usize,
    /// Number of solids and bars without physical group or element set, which are in the set `all` or `ungrouped`.
    pub ungrouped: usize,
}

impl Item for MeshFile {
    fn kind(&self) -> Kind {
        Kind::Fact(Topic::Run)
    }
    fn text(&self) -> String {
        mesh([
            counted(self.nodes, "nodes without elements were left out"),
            counted(
                self.dropped,
                "lines, facets and points without physical group were left out",
            ),
            counted(
                self.ungrouped,
                "elements without physical group or element set are in the set 'all' or 'ungrouped'",
            ),
        ])
    }
}

/// Fact: the mesh file has its content in another form than the mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshContent {
    /// Number of lines of physical curves that no part names.
    pub curves: usize,
    /// Number of solids with repeated nodes, which are wedges, pyramids and tetrahedra.
    pub collapsed: usize,
    /// Name of each of several instances, and what was added to its numbers of nodes and elements.
    pub instances: Vec<(String, u64)>,
}

impl Item for MeshContent {
    fn kind(&self) -> Kind {
        Kind::Fact(Topic::Run)
    }
    fn text(&self) -> String {
        let shifts = self.instances.iter();
        let shifts: Vec<String> = shifts
            .map(|(name, shift)| format!("{name} + {shift}"))
            .collect();
        mesh([
            counted(
                self.curves,
                "lines of physical curves that no part names are no bars, but sets of their nodes",
            ),
            counted(
                self.collapsed,
                "solids with repeated nodes are wedges, pyramids or tetrahedra",
            ),
            (!shifts.is_empty())
                .then(|| format!("numbers of nodes and elements: {}", shifts.join(", "))),
        ])
    }
}

/// Warning: the mesh file has what the mesh cannot have.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshLeftOut {
    /// Springs, dashpots, masses and the like: type and number.
    pub left_out: Vec<(String, usize)>,
    /// Number of elements with temperatures or pore pressures as further unknowns.
    pub coupled: usize,
    /// Number of nodes with coordinates that are omitted, and taken as zero.
    pub omitted: usize,
}

impl Item for MeshLeftOut {
    fn kind(&self) -> Kind {
        Kind::Warning(Topic::Run)
    }
    fn text(&self) -> String {
        let types = self.left_out.iter();
        let types: Vec<String> = types
            .map(|(name, count)| format!("{count} {name}"))
            .collect();
        mesh([
            (!types.is_empty()).then(|| format!("elements were left out: {}", types.join(", "))),
            counted(
                self.coupled,
                "elements have temperatures or pore pressures, which are left out",
            ),
            counted(
                self.omitted,
                "nodes have omitted coordinates, which are zero",
            ),
        ])
    }
}

remark! {
    /// Fact: keywords of an Abaqus input file that were skipped, since they do not describe the mesh.
    pub struct MeshKeywords {
        /// Names of the keywords, such as `*MATERIAL`, in alphabetical order.
        pub skipped: Vec<String>,
    }
    Fact(Run),
    "mesh: keywords of the file that do not describe the mesh were skipped: {}{}",
    skipped.join(", "),
    if skipped.iter().any(|keyword| keyword == "*TIE") {
        "; a [[joint]] of law `tied`, whose `facets` are the two surfaces, does what *TIE does"
    } else {
        ""
    }
}

/// Fact: elements of second order that are computed by their corners alone, or whose curved edges are computed as straight.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOrder {
    /// Number of elements of the file of which the corners alone are computed.
    pub lowered: usize,
    /// Number of nodes on curved edges, which were left out or moved to the midpoints.
    pub curved: usize,
    /// Largest distance of such a node from the midpoint (m), in the coordinates of the file.
    pub largest: f64,
}

impl Item for MeshOrder {
    fn kind(&self) -> Kind {
        Kind::Fact(Topic::Run)
    }
    fn text(&self) -> String {
        let way = if self.lowered > 0 {
            "left out"
        } else {
            "moved to the midpoints"
        };
        let curved = format!(
            "nodes on curved edges, up to {:.3e} off the midpoints, were {way}",
            self.largest
        );
        mesh([
            counted(
                self.lowered,
                "elements of second order are computed by their corners alone",
            ),
            counted(self.curved, &curved),
        ])
    }
}

remark! {
    /// Warning: the mesh file of which a packed mesh was made was changed since.
    pub struct OldPackedMesh {
        /// Path of the packed mesh.
        pub packed: PathBuf,
        /// Path of the mesh file.
        pub source: PathBuf,
    }
    Warning(Run),
    "{} was changed since {} was made of it: pack it again, or name the packed mesh that is meant",
    source.display(),
    packed.display()
}
