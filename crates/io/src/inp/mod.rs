//! Abaqus input files: reading of meshes, with their sets and surfaces.
//!
//! | in the file | in the mesh |
//! |---|---|
//! | `C3D8`, `C3D8R`, `C3D8I` | solids `hex8` |
//! | `C3D6`, `C3D5`, `C3D4` | solids `wedge6`, `pyramid5`, `tet4` |
//! | `C3D10`, `C3D10M` with straight edges | solids `tet10` |
//! | `T3D2` | bars `bar2` |
//! | `C3D20`, `C3D20R`, `C3D15` | with [`MeshOptions::first_order`] those with the same corners, else an error |
//! | these with other letters behind them, as `C3D8H`, `C3D8T`, `C3D8RP` | the same solids; those with temperatures or pore pressures are counted |
//! | solids with repeated nodes | the wedges, pyramids and tetrahedra that they are |
//! | shells, membranes and plane elements (`S4`, `M3D4`, `CPS3` ...) on sides of solids | facet sets of their element sets |
//! | springs, dashpots, masses, connectors | left out, and counted |
//! | any other type | an error with the line and the types that are read |
//! | `ELSET` of `*ELEMENT`, `*ELSET` | element sets |
//! | `NSET` of `*NODE`, `*NSET` | node sets |
//! | `*SURFACE` of `TYPE=ELEMENT`, by faces `S1` to `S6` | facet sets: the named side of each element alone |
//!
//! Keywords, parameters and names are the same in capitals and small letters, unless a name is in quotation marks; a set
//! has its name as it is first written. Comments (`**`), continued lines, numbers such as `1.E3` and `1D3`, `GENERATE` and
//! sets of sets are read. Numbers of nodes and elements are preserved.
//!
//! Elements of no set are never lost: they make the set `all` if no element has one, else the set `ungrouped`; sets that
//! the file calls `INTERNAL` do not count. Nodes without an element are dropped, from node sets too; the
//! [report](InpReport) counts them, and lists sets that are empty and keywords that were skipped: all that
//! do not describe the mesh, such as `*MATERIAL` and `*STEP`, and surfaces of another type.
//!
//! Each `*INSTANCE` of a `*PART` is at its place, translated and then turned. The first keeps the numbers of its
//! nodes and elements; those of the second, third and so on are larger by one, two and so on times a power of ten
//! that no number reaches ([`InpReport::instances`]), and each of several instances is an element set of its name. A
//! set has its name, unless another instance or the assembly has one of that name: then the name of the instance
//! comes before it, as in
//! `Part-1-1.Set-1`. Nodes of the assembly itself, which are reference points, are dropped. Files that the file
//! includes (`*INCLUDE`) are read from its folder and below it. Generation of nodes and elements (`*NGEN`, `*ELGEN`
//! ...) and elements of the assembly itself are errors with the line and a way out, and so is every parameter without
//! a meaning here. The shapes are [checked](powerhouse_model::Mesh::check): an inverted element is an error with its
//! line.
//!
//! The format: Abaqus 2016 documentation, "Input syntax rules", "Node definition", "Element definition", "Surface
//! definition" and "Three-dimensional solid element library" (Dassault Systemes, 2015).
//!
//! # Why so
//! *Two passes.* Sets may be written before the nodes and elements that they name. The first pass reads nodes and elements
//! and keeps where the lines of each set are, the second reads those. Nothing is kept of a set that a few bytes describe.
//!
//! *Sets have a largest size.* A line with `GENERATE` and a set of sets have many members in a few bytes. The members of all
//! sets together are limited, in proportion to the nodes and elements; each number is looked up before it is kept.
//!
//! *Strict where the format is lenient.* A member that does not exist is not ignored, and a second definition of a
//! node does not replace the first: a file that has any of these was probably cut off or edited. Omitted coordinates
//! are zero, as the format has it, but counted.
//!
//! *Numbers of instances differ by a power of ten*, so that 2000017 is the node 17 of the third instance in
//! every message.

mod assemble;
mod blocks;
mod error;
mod include;
mod keyword;
mod line;
mod parts;
mod placed;
mod read;
mod report;
mod sets;
mod shape;

use std::path::Path;

use powerhouse_model::Mesh;

use crate::{IoError, MeshOptions};

use include::Content;

pub use error::{InpError, InpFault, InpPlace};
pub use report::InpReport;

/// Greatest size of a file (bytes): some fifty million elements.
const LARGEST: u64 = 8 << 30;

/// Mesh of an Abaqus input file, with a report of the file's content.
#[derive(Clone, Debug, PartialEq)]
pub struct InpMesh {
    /// Mesh, whose element shapes are checked.
    pub mesh: Mesh,
    /// Report of the content of the file.
    pub report: InpReport,
}

/// Reads the mesh of an Abaqus input file.
///
/// # Errors
/// [`InpError::File`] if it cannot be opened, [`InpError::Content`] with the line, the keyword and the fault.
pub fn read_inp(path: impl AsRef<Path>) -> Result<InpMesh, InpError> {
    read_inp_with(path, MeshOptions::default())
}

/// Reads the mesh of an Abaqus input file as [`read_inp`], with options for elements of second order.
///
/// # Errors
/// As [`read_inp`].
pub fn read_inp_with(
    path: impl AsRef<Path>,
    options: MeshOptions<'_>,
) -> Result<InpMesh, InpError> {
    let path = path.as_ref();
    let bytes = crate::read_whole(path, LARGEST).map_err(IoError::file(path))?;
    let content = Content::read(&bytes, path, LARGEST)?;
    parse(&content, options)
}

/// Reads the mesh of an Abaqus input file from memory, as [`read_inp`].
///
/// # Errors
/// [`InpError::Content`], with the line of the fault.
///
/// ```
/// let file = "\
/// *NODE
/// 10, 0, 0, 0
/// 30, 1, 0, 0
/// 20, 0, 1, 0
/// 40, 0, 0, 1
/// *ELEMENT, TYPE=C3D4, ELSET=rock
/// 2, 10, 30, 20, 40
/// *SURFACE, NAME=base
/// rock, S1
/// ";
/// let inp = powerhouse_io::parse_inp(file.as_bytes())?;
/// assert_eq!(inp.mesh.node_tags(), [10, 30, 20, 40]);
/// assert_eq!(inp.mesh.element_set("rock")?, [0]);
/// assert_eq!(inp.mesh.facet_set("base")?.len(), 1);
///
/// let error = powerhouse_io::parse_inp(file.replace("20, 40", "20, 50").as_bytes()).unwrap_err();
/// let message = "line 7 in *ELEMENT: element 2 uses node 50, which does not exist";
/// assert_eq!(error.to_string(), message);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn parse_inp(bytes: &[u8]) -> Result<InpMesh, InpError> {
    parse_inp_with(bytes, MeshOptions::default())
}

/// Reads the mesh of an Abaqus input file from memory, as [`read_inp_with`].
///
/// # Errors
/// As [`parse_inp`].
pub fn parse_inp_with(bytes: &[u8], options: MeshOptions<'_>) -> Result<InpMesh, InpError> {
    parse(&Content::of_bytes(bytes, None), options)
}

fn parse(content: &Content<'_>, options: MeshOptions<'_>) -> Result<InpMesh, InpError> {
    let bytes = &content.bytes[..];
    let read = read::read(bytes, options).and_then(|raw| assemble::assemble(bytes, raw, options));
    let (mesh, report) = read.map_err(|located| content.complete(located))?;
    Ok(InpMesh { mesh, report })
}
