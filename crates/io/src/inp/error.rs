//! Errors of Abaqus input files, with their position.

use std::fmt;
use std::path::PathBuf;

use powerhouse_model::MeshError;
use thiserror::Error;

use super::shape::NAMES;
use crate::IoError;

/// Errors of reading Abaqus input files.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InpError {
    /// The operating system returned an error when the file was read.
    #[error(transparent)]
    File(#[from] IoError),
    /// The content of a file that was read is invalid, or is not read.
    #[error("{}{place}: {fault}", prefix(file))]
    Content {
        /// Path of the file; `None` if the content was parsed from memory.
        file: Option<PathBuf>,
        /// Position of the fault in the file.
        place: InpPlace,
        /// Fault of the content.
        fault: Box<InpFault>,
    },
}

fn prefix(file: &Option<PathBuf>) -> String {
    file.as_ref()
        .map(|file| format!("{}: ", file.display()))
        .unwrap_or_default()
}

/// Position in an Abaqus input file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InpPlace {
    /// Name of the keyword, such as `*NODE`; empty before the first one.
    pub keyword: String,
    /// Offset in bytes, from 0.
    pub offset: usize,
    /// Number of the line, from 1.
    pub line: usize,
}

impl fmt::Display for InpPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}", self.line)?;
        if !self.keyword.is_empty() {
            write!(f, " in {}", self.keyword)?;
        }
        Ok(())
    }
}

/// Faults of the content of an Abaqus input file. Nodes and elements are identified by the file's numbers.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum InpFault {
    /// The file has nothing but white space and comments.
    #[error("the file is empty")]
    Empty,
    /// There is data before the first keyword line.
    #[error(
        "an Abaqus input file starts with a keyword line, such as *NODE, not with '{found}'{}",
        known.map_or(String::new(), |known| format!(": this is {known}"))
    )]
    NotInp {
        /// Start of the file.
        found: String,
        /// Name of the format that the file has, if it is known.
        known: Option<&'static str>,
    },
    /// A word or number of the file is not what the format has there.
    #[error("{what} is expected here, not '{found}'")]
    Expected {
        /// Expected content.
        what: &'static str,
        /// Start of the content of the file there.
        found: String,
    },
    /// A line has more fields than the format has there.
    #[error("'{found}' follows {what}, after which nothing is permitted")]
    Surplus {
        /// Last permitted content.
        what: &'static str,
        /// Start of the additional content.
        found: String,
    },
    /// A keyword line has no value of a parameter that it needs.
    #[error("{keyword} needs the parameter {parameter}= with a value")]
    MissingParameter {
        /// Name of the keyword.
        keyword: String,
        /// Name of the parameter.
        parameter: &'static str,
    },
    /// A keyword line has a parameter that is not read.
    #[error("the parameter {parameter} of {keyword} is not read; {permitted} may be given")]
    Parameter {
        /// Name of the keyword.
        keyword: String,
        /// Name of the parameter, in capitals.
        parameter: String,
        /// Permitted parameters.
        permitted: String,
    },
    /// A parameter occurs twice in a keyword line.
    #[error("the parameter {parameter} occurs twice")]
    RepeatedParameter {
        /// Name of the parameter, in capitals.
        parameter: String,
    },
    /// A keyword that describes the mesh is not read.
    #[error("{keyword} is not read: {way}")]
    Keyword {
        /// Name of the keyword.
        keyword: String,
        /// What to do instead.
        way: &'static str,
    },
    /// An element type is not read.
    #[error("elements of type {name} are not read; {NAMES} are: leave others out of the file")]
    ElementType {
        /// Type as written in the file.
        name: String,
    },
    /// An element type of second order is computed only by its corners, which was not requested.
    #[error(
        "elements of type {name} are of second order, which are computed only by their corners: `order = 1` reads them alone"
    )]
    SecondOrder {
        /// Name of the type.
        name: &'static str,
    },
    /// An element has fewer nodes than its type.
    #[error("element {element} has {found} nodes; its type {name} has {expected}")]
    NodeCount {
        /// Number of the element.
        element: u64,
        /// Name of the type.
        name: &'static str,
        /// Number of nodes in the file.
        found: usize,
        /// Number of nodes of the type.
        expected: usize,
    },
    /// A number is 0, but numbers of nodes and elements are 1 or more.
    #[error("{what} is 1 or more, not 0")]
    Zero {
        /// Kind of number.
        what: &'static str,
    },
    /// The numbers of a generated set are not from a least to a greatest in whole increments.
    #[error(
        "a generated set goes from a first number up to a last one in equal increments, not from {first} to {last} by {increment}"
    )]
    Generated {
        /// First number.
        first: u64,
        /// Last number.
        last: u64,
        /// Increment of the numbers.
        increment: u64,
    },
    /// A set has a node or element that does not exist.
    #[error("the set '{set}' names {what} {number}, which does not exist")]
    NoSuchMember {
        /// Name of the set or surface.
        set: String,
        /// `node` or `element`.
        what: &'static str,
        /// The number.
        number: u64,
    },
    /// A set of sets or a surface names a set that is not defined before.
    #[error(
        "no {what} set '{name}' is defined before this line; {}",
        defined(available)
    )]
    NoSuchSet {
        /// `node` or `element`.
        what: &'static str,
        /// Requested name.
        name: String,
        /// Names of the first sets defined before, at most twenty.
        available: Vec<String>,
    },
    /// A surface names a face that an element does not have.
    #[error("element {element} of type {name} has no face {face}; it has {}", faces(*sides))]
    NoSuchFace {
        /// Number of the element.
        element: u64,
        /// Name of its type.
        name: &'static str,
        /// The face as a number from 1.
        face: u8,
        /// Number of faces of the element.
        sides: usize,
    },
    /// The sets and surfaces have too many members in total.
    #[error(
        "the sets and surfaces have more than {most} members together, the most for this number of nodes and elements"
    )]
    TooManyMembers {
        /// Largest permitted number.
        most: usize,
    },
    /// The file has no element.
    #[error("the file has no elements; *ELEMENT with types {NAMES} is read")]
    NoElements,
    /// A part, an instance or an assembly has no end, as in a file that is cut off.
    #[error("{keyword} has no end {}", keyword.replacen('*', "*END ", 1))]
    NotEnded {
        /// Name of the keyword.
        keyword: &'static str,
    },
    /// A keyword is not permitted where it is, such as the end of a part that has not begun.
    #[error("{keyword} is permitted only {place}")]
    Misplaced {
        /// Name of the keyword.
        keyword: String,
        /// Where it is permitted.
        place: &'static str,
    },
    /// The file has several assemblies.
    #[error("a second {keyword} is not read: a file has one")]
    Second {
        /// Name of the keyword.
        keyword: &'static str,
    },
    /// The file has several parts and no instance of one.
    #[error("the file has {parts} parts and no *INSTANCE that says where they are")]
    NoInstances {
        /// Number of parts.
        parts: usize,
    },
    /// An instance that is moved has nodes or elements of its own.
    #[error(
        "the instance '{name}' is moved and has nodes or elements of its own: put them into its part"
    )]
    MovedContent {
        /// Name of the instance.
        name: String,
    },
    /// The numbers of nodes and elements of several instances are too large to be kept apart.
    #[error("{most} is too large a number of a node or element in a file of several instances")]
    Numbers {
        /// Largest number.
        most: u64,
    },
    /// A file that is included is not in the folder of the file or below it.
    #[error(
        "the file '{name}' is not in the folder of this file or below it, where alone files are included"
    )]
    IncludedElsewhere {
        /// Name as it is written.
        name: String,
    },
    /// Files include each other, or too many of them.
    #[error("files are included within files {most} times, as where a file includes itself")]
    IncludedTooDeep {
        /// Largest permitted depth.
        most: usize,
    },
    /// The files that are included are too large together.
    #[error("the file and those that it includes have more than {most} bytes")]
    IncludedTooMuch {
        /// Largest permitted size (bytes).
        most: u64,
    },
    /// A shell or plane element is not on a side of a solid.
    #[error(
        "element {element} of type {name} lies on no side of a solid: shells and plane elements are read as facets of solids alone"
    )]
    Shell {
        /// Number of the element.
        element: u64,
        /// Name of its type.
        name: &'static str,
    },
    /// The file has shells or plane elements and no solid.
    #[error(
        "the file has no solids, only {facets} shells or plane elements: extrude them (in Gmsh `Extrude {{0, 0, 1}} {{ Surface{{:}}; Layers{{1}}; Recombine; }}`, \
         with a Physical Volume)"
    )]
    NoSolids {
        /// Number of shells and plane elements.
        facets: usize,
    },
    /// A name is not that of the part or instance of the file.
    #[error("there is no {what} '{name}' before this line")]
    NoSuchPart {
        /// `part` or `instance`.
        what: &'static str,
        /// Requested name.
        name: String,
    },
    /// A set of the assembly has numbers without the instance whose numbers they are.
    #[error(
        "number {number} in the assembly belongs to no instance: give INSTANCE= in the keyword line or write instance.number"
    )]
    NoInstance {
        /// The number.
        number: u64,
    },
    /// Two parts or two instances have one name.
    #[error("there are two {what}s '{name}': rename one of them")]
    SameName {
        /// `part` or `instance`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// Two sets have one name, which is in quotation marks for one of them alone.
    #[error(
        "there are two {what}s '{name}', one of them with its name in quotation marks: rename one of them"
    )]
    AlikeNames {
        /// `node set`, `element set` or `surface`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// The mesh is invalid, as with an inverted element or a number that occurs twice.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

fn defined(available: &[String]) -> String {
    match available {
        [] => "none is defined before it".into(),
        names => format!("those defined are: {}", names.join(", ")),
    }
}

fn faces(sides: usize) -> String {
    match sides {
        0 => "none".into(),
        sides => format!("S1 to S{sides}"),
    }
}

/// Fault with its position, before the name of the file and the line are known.
#[derive(Debug)]
pub(super) struct Located {
    keyword: String,
    offset: usize,
    fault: Box<InpFault>,
}

impl Located {
    pub(super) fn new(keyword: &str, offset: usize, fault: impl Into<InpFault>) -> Self {
        Self {
            keyword: keyword.into(),
            offset,
            fault: Box::new(fault.into()),
        }
    }
    /// Offset in the content (bytes).
    pub(super) fn offset(&self) -> usize {
        self.offset
    }
    /// Error with the name of the file and the number of the line, which is counted only now.
    pub(super) fn complete(self, file: Option<PathBuf>, line: usize) -> InpError {
        InpError::Content {
            file,
            place: InpPlace {
                keyword: self.keyword,
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
    let start = line[..line.len().min(24)].trim_ascii();
    let shown = |&byte: &u8| match byte {
        b' '..=b'~' => char::from(byte),
        _ => '\u{fffd}',
    };
    start.iter().map(shown).collect()
}
