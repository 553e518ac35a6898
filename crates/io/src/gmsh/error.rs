//! What can be wrong with a Gmsh file, and where.

use std::fmt;
use std::path::PathBuf;

use powerhouse_model::MeshError;
use thiserror::Error;

use crate::IoError;

/// A Gmsh file that could not be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GmshError {
    /// The operating system refused.
    #[error(transparent)]
    File(#[from] IoError),
    /// The file's content is at fault.
    #[error("{}{place}: {fault}", prefix(file))]
    Content {
        /// The file; none if it was parsed from memory.
        file: Option<PathBuf>,
        /// Where in it.
        place: GmshPlace,
        /// What is wrong.
        fault: Box<GmshFault>,
    },
    /// A set name that the format cannot hold: it is empty, or has a quote or a line break.
    #[error("{}: the set name {name:?} cannot be written to a Gmsh file", file.display())]
    UnwritableName {
        /// The file.
        file: PathBuf,
        /// The name.
        name: String,
    },
    /// An element kind that the format has no type for here.
    #[error("{}: elements of kind {kind} cannot be written to a Gmsh file", file.display())]
    UnwritableElement {
        /// The file.
        file: PathBuf,
        /// The kind.
        kind: &'static str,
    },
    /// Element numbers so large that the facets and points of the sets find none above them.
    #[error("{}: no element numbers are left above {largest}", file.display())]
    NumbersExhausted {
        /// The file.
        file: PathBuf,
        /// The largest element number of the mesh.
        largest: u64,
    },
}

fn prefix(file: &Option<PathBuf>) -> String {
    file.as_ref()
        .map(|file| format!("{}: ", file.display()))
        .unwrap_or_default()
}

/// A place in a Gmsh file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GmshPlace {
    /// The section, such as `$Nodes`; empty outside of all sections.
    pub section: String,
    /// The byte, from 0.
    pub offset: usize,
    /// The line, from 1, if the file is text.
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

/// What is wrong with the content of a Gmsh file. Nodes and elements go by the file's numbers.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GmshFault {
    /// Nothing but white space.
    #[error("the file is empty")]
    Empty,
    /// The first section is another one than `$MeshFormat`.
    #[error("a Gmsh file starts with $MeshFormat, this one with '{found}'")]
    NotGmsh {
        /// How the file starts.
        found: String,
    },
    /// A version other than 2.2 and 4.1.
    #[error("format version {version} is not read; 2.2 and 4.1 are (gmsh -save -format msh41)")]
    Version {
        /// As it stands in the file.
        version: String,
    },
    /// A file type other than text (0) and binary (1).
    #[error("file type {found} is neither 0 (text) nor 1 (binary)")]
    FileType {
        /// As it stands in the file.
        found: i64,
    },
    /// A width of numbers that does not exist in this format.
    #[error("data size {found} is not possible here; {permitted} is")]
    DataSize {
        /// As it stands in the file.
        found: u64,
        /// What could stand there.
        permitted: &'static str,
    },
    /// The mark of the byte order is no 1 in either order.
    #[error("the byte order mark is {found:#010x} instead of 1")]
    ByteOrder {
        /// The mark, read with the lowest byte first.
        found: u32,
    },
    /// Text that belongs to no section.
    #[error("'{found}' stands outside of all sections")]
    Stray {
        /// How it starts.
        found: String,
    },
    /// A section without its end.
    #[error("the section {section} has no end ${}", section.replacen('$', "End", 1))]
    NotEnded {
        /// The section.
        section: String,
    },
    /// A section that is needed and not there.
    #[error("the file has no section {section}")]
    Missing {
        /// The section.
        section: &'static str,
    },
    /// A section that stands twice.
    #[error("the section {section} stands twice")]
    Repeated {
        /// The section.
        section: &'static str,
    },
    /// Nodes with parameters on their surfaces.
    #[error("nodes with parametric coordinates are not read (Mesh.SaveParametric = 0)")]
    Parametric,
    /// A mesh divided among processors.
    #[error("the mesh is partitioned; save it undivided")]
    Partitioned,
    /// Another thing than expected.
    #[error("{what} should stand here, not '{found}'")]
    Expected {
        /// What should stand there.
        what: &'static str,
        /// What does.
        found: String,
    },
    /// The section ends too early.
    #[error("the section ends where {what} should stand")]
    Truncated {
        /// What should stand there.
        what: &'static str,
    },
    /// More in a section than its counts announce.
    #[error("'{found}' stands after the last {what} that the counts announce")]
    Surplus {
        /// Nodes, elements ...
        what: &'static str,
        /// How it starts.
        found: String,
    },
    /// A count that the file is too small for.
    #[error("{count} {what} do not fit into {room} bytes")]
    Count {
        /// Nodes, elements ...
        what: &'static str,
        /// How many are announced.
        count: u64,
        /// How many bytes are left.
        room: usize,
    },
    /// A total that disagrees with its parts.
    #[error("{stated} {what} are announced, {found} are there")]
    Total {
        /// Nodes, elements ...
        what: &'static str,
        /// The total.
        stated: u64,
        /// The sum of the parts.
        found: u64,
    },
    /// Least and largest number in the head of a section, against what follows.
    #[error("{what} numbers from {} to {} are announced, {} to {} are there", stated.0, stated.1, found.0, found.1)]
    Range {
        /// Nodes or elements.
        what: &'static str,
        /// As announced.
        stated: (u64, u64),
        /// As they are.
        found: (u64, u64),
    },
    /// A number 0, which the format reserves.
    #[error("a {what} has the number 0")]
    Zero {
        /// Node or element.
        what: &'static str,
    },
    /// A dimension that does not exist, or not for this element.
    #[error("{what} cannot have dimension {dimension}")]
    Dimension {
        /// A node block, or the element's name.
        what: &'static str,
        /// As it stands in the file.
        dimension: i64,
    },
    /// An entity that stands twice.
    #[error("the entity of dimension {dimension} and number {entity} stands twice")]
    RepeatedEntity {
        /// Its dimension.
        dimension: usize,
        /// Its number.
        entity: i32,
    },
    /// A physical group with two names.
    #[error("the physical group of dimension {dimension} and number {group} has two names")]
    RepeatedGroup {
        /// Its dimension.
        dimension: usize,
        /// Its number.
        group: i32,
    },
    /// An element type that this software does not compute with.
    #[error("element {element} is a {name}; hex8, tet4, wedge6, bar2 and their facets are read")]
    UnsupportedElement {
        /// The type.
        name: &'static str,
        /// The first such element.
        element: u64,
    },
    /// An element type that is not in the list of the format.
    #[error("there is no element type {number}")]
    ElementType {
        /// As it stands in the file.
        number: i64,
    },
    /// Nothing to compute with.
    #[error("no solids and no bars, only {facets} facets, {lines} lines and {points} points")]
    NoSolids {
        /// Triangles and quadrilaterals.
        facets: usize,
        /// Lines of no physical group.
        lines: usize,
        /// Points.
        points: usize,
    },
    /// A point of a named group away from the mesh.
    #[error("node {node} of the group '{group}' belongs to no solid and no bar")]
    PointWithoutElement {
        /// The group.
        group: String,
        /// The node.
        node: u64,
    },
    /// A mesh at fault.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The parser of values refused what the scanner had passed.
    #[error("the values cannot be read: {reason}")]
    Values {
        /// The parser's reason.
        reason: String,
    },
    /// The parser of values and the scanner disagree.
    #[error("two readings of the {what} disagree")]
    Disagreement {
        /// Of what.
        what: &'static str,
    },
}

/// A fault with its place, before the file's name and the line are known.
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
    /// Completes the error; lines are counted only now.
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

/// The start of some bytes for a message: at most 24, up to the end of the line.
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
