//! Errors of Gmsh files, with their position.

use std::fmt;
use std::path::PathBuf;

use powerhouse_model::MeshError;
use thiserror::Error;

use crate::IoError;

/// Errors of reading and writing Gmsh files.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GmshError {
    /// The operating system returned an error when the file was read or written.
    #[error(transparent)]
    File(#[from] IoError),
    /// The content of a file that was read is invalid.
    #[error("{}{place}: {fault}", prefix(file))]
    Content {
        /// Path of the file; `None` if the content was parsed from memory.
        file: Option<PathBuf>,
        /// Position of the fault in the file.
        place: GmshPlace,
        /// Fault of the content.
        fault: Box<GmshFault>,
    },
    /// The format cannot represent the name of a set: it is empty, or has a quote or a line break.
    #[error("{}: the set name {name:?} cannot be written to a Gmsh file", file.display())]
    UnwritableName {
        /// Path of the file.
        file: PathBuf,
        /// Name of the set.
        name: String,
    },
    /// The format has no element type for a kind of element.
    #[error("{}: elements of kind {kind} cannot be written to a Gmsh file", file.display())]
    UnwritableElement {
        /// Path of the file.
        file: PathBuf,
        /// Name of the kind of element.
        kind: &'static str,
    },
    /// The element numbers are so large that no numbers are left for the facets and points of sets.
    #[error("{}: no element numbers are left above {largest}", file.display())]
    NumbersExhausted {
        /// Path of the file.
        file: PathBuf,
        /// Largest element number of the mesh.
        largest: u64,
    },
}

fn prefix(file: &Option<PathBuf>) -> String {
    file.as_ref()
        .map(|file| format!("{}: ", file.display()))
        .unwrap_or_default()
}

/// Position in a Gmsh file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GmshPlace {
    /// Name of the section, such as `$Nodes`; empty outside of all sections.
    pub section: String,
    /// Offset in bytes, from 0.
    pub offset: usize,
    /// Number of the line, from 1, if the file is text.
    pub line: Option<usize>,
}

impl fmt::Display for GmshPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "line {line}")?,
            None => write!(f, "byte {}", self.offset)?,
        }
        if !self.section.is_empty() {
            write!(f, " in {}", self.section)?;
        }
        Ok(())
    }
}

/// Faults of the content of a Gmsh file. Nodes and elements are identified by the file's numbers.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GmshFault {
    /// The file has nothing but white space.
    #[error("the file is empty")]
    Empty,
    /// The first section is not `$MeshFormat`.
    #[error("{}", not_gmsh(found, *known))]
    NotGmsh {
        /// Start of the file.
        found: String,
        /// Name of the format that the file has, if it is known.
        known: Option<&'static str>,
    },
    /// The format version is neither 2 to 2.2 nor 4.1.
    #[error(
        "format version {version} is not supported; 2 to 2.2 and 4.1 are (gmsh -save -format msh41)"
    )]
    Version {
        /// Version as written in the file.
        version: String,
    },
    /// The file type is neither text (0) nor binary (1).
    #[error("file type {found} is neither 0 (text) nor 1 (binary)")]
    FileType {
        /// File type as written in the file.
        found: i64,
    },
    /// The data size is not permitted in this version.
    #[error("data size {found} is not permitted here; {permitted} is")]
    DataSize {
        /// Data size as written in the file (bytes).
        found: u64,
        /// Permitted data sizes in words.
        permitted: &'static str,
    },
    /// The byte order mark is not 1 in either byte order.
    #[error("the byte order mark is {found:#010x} instead of 1")]
    ByteOrder {
        /// Mark as a little-endian number.
        found: u32,
    },
    /// There is text other than white space between two sections or after the last one.
    #[error("'{found}' is outside of all sections")]
    Stray {
        /// Start of the text.
        found: String,
    },
    /// A section has no end (`$End...`), as in a file that is cut off.
    #[error("the section {section} has no end ${}", section.replacen('$', "End", 1))]
    NotEnded {
        /// Name of the section.
        section: String,
    },
    /// A required section, `$Nodes` or `$Elements`, is missing.
    #[error("the file has no section {section}")]
    Missing {
        /// Name of the section.
        section: &'static str,
    },
    /// A section occurs twice.
    #[error("the section {section} occurs twice")]
    Repeated {
        /// Name of the section.
        section: &'static str,
    },
    /// The nodes have parametric coordinates, by their mark or in a section of their own.
    #[error("nodes with parametric coordinates are not supported (Mesh.SaveParametric = 0)")]
    Parametric,
    /// The file has the elements of some partitions of a mesh alone.
    #[error(
        "the file has the elements of partition {} alone{}, which is a part of a mesh; save all partitions in one \
         file (in Gmsh Mesh.PartitionSplitMeshFiles = 0)",
        .found.iter().map(i32::to_string).collect::<Vec<_>>().join(", "),
        .count.map_or_else(String::new, |count| format!(" of {count}")),
    )]
    PartOfMesh {
        /// Partitions with elements.
        found: Vec<i32>,
        /// Number of partitions, if the file has it.
        count: Option<u64>,
    },
    /// A word or number of the file is not what the format has there.
    #[error("{what} is expected here, not '{found}'")]
    Expected {
        /// Expected content.
        what: &'static str,
        /// Start of the content of the file there.
        found: String,
    },
    /// Expected content is missing: a complete section of a text file ends before what its counts state, or a binary
    /// file ends within a section or before its byte order mark. A text file that is cut off within a section is
    /// [`NotEnded`](Self::NotEnded), a count too large for the rest of its section [`Count`](Self::Count).
    #[error("the section ends where {what} is expected")]
    Truncated {
        /// Expected content.
        what: &'static str,
    },
    /// A section has more content than its counts state, or its end does not follow its last record.
    #[error("'{found}' follows the last {what} that the counts state")]
    Surplus {
        /// Kind of record, such as node or element.
        what: &'static str,
        /// Start of the additional content.
        found: String,
    },
    /// A count of records is too large for the rest of its section, or of the file if it is binary.
    #[error("{count} {what} do not fit into {room} bytes")]
    Count {
        /// Kind of record, such as nodes or elements.
        what: &'static str,
        /// Stated count.
        count: u64,
        /// Size of the rest (bytes).
        room: usize,
    },
    /// A stated number of physical names, nodes or elements differs from the number found.
    #[error("{stated} {what} are stated, {found} are found")]
    Total {
        /// Kind of record: names, nodes or elements.
        what: &'static str,
        /// Number that the file states.
        stated: u64,
        /// Number of records in the file.
        found: u64,
    },
    /// The least and largest number of nodes or elements that a section of version 4.1 states differ from those of its
    /// records.
    #[error("{what} numbers from {} to {} are stated, {} to {} are found", stated.0, stated.1, found.0, found.1)]
    Range {
        /// Kind of record, node or element.
        what: &'static str,
        /// Stated least and largest number.
        stated: (u64, u64),
        /// Least and largest number of the records.
        found: (u64, u64),
    },
    /// A node or element has the number 0, which the format reserves.
    #[error("a {what} has the number 0")]
    Zero {
        /// Kind of record, node or element.
        what: &'static str,
    },
    /// The dimension of an entity is not 0 to 3, or not that of the element type of its elements (version 4.1).
    #[error("{what} cannot have dimension {dimension}")]
    Dimension {
        /// Kind of entity, or name of the element type.
        what: &'static str,
        /// Dimension as written in the file.
        dimension: i64,
    },
    /// An entity occurs twice in `$Entities` (version 4.1).
    #[error("the entity of dimension {dimension} and number {entity} occurs twice")]
    RepeatedEntity {
        /// Dimension of the entity.
        dimension: usize,
        /// Number of the entity.
        entity: i32,
    },
    /// A physical group has two names in `$PhysicalNames`.
    #[error("the physical group of dimension {dimension} and number {group} has two names")]
    RepeatedGroup {
        /// Dimension of the group.
        dimension: usize,
        /// Number of the group.
        group: i32,
    },
    /// An element has a type of the format that is not supported, such as one of third order.
    #[error(
        "element {element} is a {name}, which is not supported; hex8, tet4, tet10, wedge6, pyramid5, bar2 and their facets are"
    )]
    UnsupportedElement {
        /// Name of the type.
        name: &'static str,
        /// Number of the first such element.
        element: u64,
    },
    /// An element is of second order and is computed as its corners alone, which was not requested.
    #[error(
        "element {element} is {name}, of second order, which is computed only by its corners: `order = 1` reads them alone"
    )]
    SecondOrder {
        /// Name of the type with its article.
        name: &'static str,
        /// Number of the element.
        element: u64,
    },
    /// An element type does not exist in the format.
    #[error("there is no element type {number}")]
    ElementType {
        /// Type as written in the file.
        number: i64,
    },
    /// The file has neither solids nor bars, or facets without a solid; bars are lines in a physical group.
    #[error(
        "the file has no solids, only {facets} facets, {lines} lines and {points} points{}",
        if *facets > 0 {
            ": in Gmsh `Extrude {0, 0, 1} { Surface{:}; Layers{1}; Recombine; }` with a Physical Volume makes a slice of a plane mesh, and \
             `gmsh FILE.geo -3` its solids"
        } else {
            ""
        }
    )]
    NoSolids {
        /// Number of triangles and quadrilaterals.
        facets: usize,
        /// Number of lines.
        lines: usize,
        /// Number of points.
        points: usize,
    },
    /// A point of a named group belongs to no element of the mesh.
    #[error("node {node} of the group '{group}' belongs to no solid and no bar")]
    PointWithoutElement {
        /// Name of the group.
        group: String,
        /// Number of the node.
        node: u64,
    },
    /// The mesh is invalid, as with an inverted element or a number that occurs twice.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The second of two parsers, which reads the values of version 4.1, returned an error although the first had accepted
    /// the content.
    #[error("the values cannot be read: {reason}")]
    Values {
        /// Error of the parser in words.
        reason: String,
    },
    /// The two parsers of a file of version 4.1 have read different records, a fault of the software.
    #[error("two readings of the {what} disagree")]
    Disagreement {
        /// Kind of record.
        what: &'static str,
    },
}

fn not_gmsh(found: &str, known: Option<&str>) -> String {
    const CONVERTED: [&str; 4] = ["MED", "universal", "Nastran", "Medit"];
    if let Some(known) = known {
        let is_converted = CONVERTED.iter().any(|name| known.contains(name));
        let way = if is_converted {
            "`gmsh FILE -save -format msh41 -o mesh.msh` writes it as one, with its groups"
        } else {
            "meshio and `Mesh.from_meshio` of the Python package read many formats"
        };
        return format!("this is {known}, not a Gmsh mesh: {way}");
    }
    let more = match found {
        _ if found.starts_with("powerhouse mesh") => {
            ", as a packed mesh does, whose name ends with .phm"
        }
        _ if found.starts_with('*') => ", as an Abaqus input file does",
        _ => "",
    };
    format!("a Gmsh file starts with $MeshFormat, but this file starts with '{found}'{more}")
}

/// Fault with its position, before the name of the file and the line are known.
#[derive(Debug)]
pub(super) struct Located {
    pub(super) section: String,
    pub(super) offset: usize,
    pub(super) fault: Box<GmshFault>,
}

impl Located {
    pub(super) fn new(section: &str, offset: usize, fault: impl Into<GmshFault>) -> Self {
        Self {
            section: section.into(),
            offset,
            fault: Box::new(fault.into()),
        }
    }
    /// Error with the name of the file and the number of the line, which is counted only now.
    pub(super) fn complete(self, bytes: &[u8], text: bool, file: Option<PathBuf>) -> GmshError {
        let before = &bytes[..self.offset.min(bytes.len())];
        let line = text.then(|| 1 + before.iter().filter(|byte| **byte == b'\n').count());
        GmshError::Content {
            file,
            place: GmshPlace {
                section: self.section,
                offset: self.offset,
                line,
            },
            fault: self.fault,
        }
    }
}

/// Start of some bytes for a message: at most 24 bytes, up to the end of the line.
pub(super) fn snippet(bytes: &[u8]) -> String {
    let line = bytes.split(|byte| *byte == b'\n').next().unwrap_or(bytes);
    let start = &line[..line.len().min(24)];
    start
        .trim_ascii()
        .iter()
        .map(|&byte| match byte {
            b' '..=b'~' => char::from(byte),
            _ => '\u{fffd}',
        })
        .collect()
}
