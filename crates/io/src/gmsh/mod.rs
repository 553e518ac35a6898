//! Gmsh mesh files: reading of MSH 4.1 and 2 to 2.2, text and binary of either byte order, writing of 4.1 text.
//!
//! | in the file | in the mesh |
//! |---|---|
//! | hexahedra (8 nodes), tetrahedra (4), prisms (6), pyramids (5) | solids `hex8`, `tet4`, `wedge6`, `pyramid5` |
//! | tetrahedra (10) with straight edges | solids `tet10` |
//! | solids with repeated nodes | the wedges, pyramids and tetrahedra that they are |
//! | lines (2) in a physical group | bars `bar2`; with [`MeshOptions::bars`] only of the groups that it names, others are node sets |
//! | triangles (3 or 6), quadrilaterals (4) in a physical group | facets: the sides of the solids on the same nodes, both sides of an interior face |
//! | points in a physical group | nodes |
//! | physical groups of dimension 3 and 1, 2, 0 | element sets, facet sets, node sets |
//! | other elements of second order | with [`MeshOptions::first_order`] those with the same corners, else an error that names the element |
//! | any other element | an error that names the element |
//!
//! A set has the name of its group, or `physical_DIMENSION_NUMBER` if the group has none; groups
//! of one name make one set. An element in several groups is one element of several sets, though
//! version 2.2 writes it once for each. Numbers of nodes and elements are preserved; they may be
//! sparse and in any order.
//!
//! Solids of no group are never lost: they make the set `all` if no solid has a group, else the
//! set `ungrouped`. Lines, facets and points of no group are dropped (in a mesh of lines alone the
//! lines are bars), and so are nodes without an element. The
//! [report](GmshReport) counts what was dropped.
//!
//! Sections without a meaning here (`$Periodic`, `$NodeData`, `$Comments` ...) are skipped.
//! Partitioned meshes are read as one mesh, if one file has all partitions. Nodes with parametric coordinates are errors. The shapes are
//! [checked](powerhouse_model::Mesh::check): an inverted element is an error with its line.
//!
//! The format: Gmsh Reference Manual 4.15, chapter "Gmsh file formats" (Geuzaine and Remacle, 2009,
//! Int. J. Numer. Meth. Engng 79, 1309-1331).
//!
//! # Why so
//! *Two parsers for version 4.1.* [mshio] parses values well and checks little: it drops the
//! numbers of nodes when they are dense and leaves their order to the reader, it accepts
//! inconsistent counts, and it panics at a data size of 5 or a count of 0. So a scanner
//! of this crate first reads every number. It bounds each count by the remaining bytes before any
//! memory is allocated, reads numbers, types, ranges and groups, and stores the offset of each
//! record. mshio is then given an excerpt with a header written here and the two non-empty sections,
//! with nothing at which it panics; its blocks, counts and element numbers are compared with the
//! scanner's. Memory is in proportion to the file.
//!
//! *Version 2.2* is still written by many programs. It is read in one pass, and so are 2 and 2.1, whose content is
//! the same.
//!
//! *Curves are named for many reasons*, to be refined or as the edge of a load, and are bars only where somebody
//! wants bars; else they are sets of their nodes, unless a surface or volume has the name. Lines that cannot be bars, of three nodes, are no fault of a mesh of solids; those of two curves on
//! the same nodes are one bar.
//!
//! *The header of a section is checked.* A total or a range of numbers that disagrees with the
//! records is an error: the file was truncated or edited.
//!
//! *Only the mesh is read.* Geometry (`$Entities`) serves to find the groups.

mod assemble;
mod cursor;
mod error;
mod format;
mod msh2;
mod msh4;
mod raw;
mod read;
mod report;
mod section;
mod shape;
mod values;
mod write;

use std::path::{Path, PathBuf};

use powerhouse_model::Mesh;

use crate::{IoError, MeshOptions};

pub use error::{GmshError, GmshFault, GmshPlace};
pub use format::{ByteOrder, Encoding, GmshVersion};
pub use report::{GmshGroup, GmshReport};
pub use write::write_gmsh;

/// Greatest size of a file (bytes): some fifty million elements.
const LARGEST: u64 = 8 << 30;

/// Mesh of a Gmsh file, with a report of the file's content.
#[derive(Clone, Debug, PartialEq)]
pub struct GmshMesh {
    /// Mesh, whose element shapes are checked.
    pub mesh: Mesh,
    /// Report of the content of the file.
    pub report: GmshReport,
}

/// Reads a Gmsh file of version 4.1 or 2 to 2.2, text or binary.
///
/// # Errors
/// [`GmshError::File`] if it cannot be opened, [`GmshError::Content`] with the line or byte, the
/// section and the node or element of the fault.
pub fn read_gmsh(path: impl AsRef<Path>) -> Result<GmshMesh, GmshError> {
    read_gmsh_with(path, MeshOptions::default())
}

/// Reads a Gmsh file as [`read_gmsh`], with options for elements of second order.
///
/// # Errors
/// As [`read_gmsh`].
pub fn read_gmsh_with(
    path: impl AsRef<Path>,
    options: MeshOptions<'_>,
) -> Result<GmshMesh, GmshError> {
    let path = path.as_ref();
    let bytes = crate::read_whole(path, LARGEST).map_err(IoError::file(path))?;
    parse(&bytes, Some(path.into()), options)
}

/// Reads a Gmsh file from memory, as [`read_gmsh`].
///
/// # Errors
/// [`GmshError::Content`], with the line or byte of the fault.
///
/// ```
/// let file = r#"$MeshFormat
/// 2.2 0 8
/// $EndMeshFormat
/// $PhysicalNames
/// 2
/// 2 5 "base"
/// 3 1 "rock"
/// $EndPhysicalNames
/// $Nodes
/// 4
/// 10 0 0 0
/// 30 1 0 0
/// 20 0 1 0
/// 40 0 0 1
/// $EndNodes
/// $Elements
/// 2
/// 1 2 2 5 1 10 20 30
/// 2 4 2 1 1 10 30 20 40
/// $EndElements
/// "#;
/// let gmsh = powerhouse_io::parse_gmsh(file.as_bytes())?;
/// assert_eq!(gmsh.mesh.node_tags(), [10, 30, 20, 40]);
/// assert_eq!(gmsh.mesh.element_set("rock")?, [0]);
/// assert_eq!(gmsh.mesh.facet_set("base")?.len(), 1);
///
/// let error = powerhouse_io::parse_gmsh(file.replace("20 40", "20 50").as_bytes()).unwrap_err();
/// let message = "line 19 in $Elements: element 2 uses node 50, which does not exist";
/// assert_eq!(error.to_string(), message);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn parse_gmsh(bytes: &[u8]) -> Result<GmshMesh, GmshError> {
    parse(bytes, None, MeshOptions::default())
}

/// Reads a Gmsh file from memory, as [`read_gmsh_with`].
///
/// # Errors
/// As [`parse_gmsh`].
pub fn parse_gmsh_with(bytes: &[u8], options: MeshOptions<'_>) -> Result<GmshMesh, GmshError> {
    parse(bytes, None, options)
}

fn parse(
    bytes: &[u8],
    file: Option<PathBuf>,
    options: MeshOptions<'_>,
) -> Result<GmshMesh, GmshError> {
    let (format, start) = match read::head(bytes) {
        Ok(head) => head,
        Err(located) => return Err(located.complete(bytes, true, file)),
    };
    let content = read::body(bytes, format, start)
        .and_then(|raw| assemble::assemble(raw, format.version, format.encoding, options));
    match content {
        Ok((mesh, report)) => Ok(GmshMesh { mesh, report }),
        Err(located) => {
            let text = format.encoding == Encoding::Text;
            Err(located.complete(bytes, text, file))
        }
    }
}
