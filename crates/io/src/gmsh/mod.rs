//! Gmsh meshes: MSH 4.1 and 2.2, text and binary of either byte order in, 4.1 text out.
//!
//! | in the file | in the mesh |
//! |---|---|
//! | hexahedra (8 nodes), tetrahedra (4), prisms (6) | solids `hex8`, `tet4`, `wedge6` |
//! | lines (2) in a physical group | bars `bar2` |
//! | triangles (3), quadrilaterals (4) in a physical group | facets: the sides of the solids on the same nodes, inside the body both of them |
//! | points in a physical group | nodes |
//! | physical groups of dimension 3 and 1, 2, 0 | element sets, facet sets, node sets |
//! | any other element | an error that names it |
//!
//! A set has the name of its group, or `physical_DIMENSION_NUMBER` if the group has none; groups
//! of one name make one set. An element in several groups is one element of several sets, though
//! version 2.2 writes it once for each. Numbers of nodes and elements are kept; they may be
//! sparse and in any order.
//!
//! Solids of no group are never lost: they make the set `all` if no solid has a group, else the
//! set `ungrouped`. Lines, facets and points of no group are dropped (a mesh of lines alone is
//! kept as one of bars), and so are the nodes that are left without an element. The
//! [report](GmshReport) counts what was dropped.
//!
//! Sections that mean nothing here (`$Periodic`, `$NodeData`, `$Comments` ...) are passed over.
//! Partitioned meshes and nodes with parametric coordinates are refused. The shapes are
//! [checked](powerhouse_model::Mesh::check): an inverted element is an error with its line.
//!
//! The format: Gmsh Reference Manual 4.15, chapter "Gmsh file formats" (Geuzaine and Remacle, 2009,
//! Int. J. Numer. Meth. Engng 79, 1309-1331).
//!
//! # Why so
//! *Two readings of version 4.1.* [mshio] parses values well and checks little: it forgets the
//! numbers of nodes when they are dense and leaves the reader to assume an order, it accepts
//! counts that disagree, it stops with a panic at a data size of 5 or a count of 0. So a scanner
//! of our own walks through every number first. It bounds each count by the bytes that are left
//! before any memory is taken, takes numbers, types, ranges and groups, and notes where each
//! record stands. mshio then sees an excerpt with a head that we wrote and the two sections that
//! hold something, nothing that could make it panic; its blocks, counts and element numbers are
//! compared with the scanner's. Memory stays in proportion to the file.
//!
//! *Version 2.2* is still what many programs write. One pass reads it.
//!
//! *The head of a section is believed.* A total or a range of numbers that disagrees with what
//! follows is an error: the file was cut or edited.
//!
//! *Only the mesh is kept.* Geometry (`$Entities`) serves to find the groups.

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

use crate::IoError;

pub use error::{GmshError, GmshFault, GmshPlace};
pub use format::{ByteOrder, Encoding, GmshVersion};
pub use report::{GmshGroup, GmshReport};
pub use write::write_gmsh;

/// The largest file (bytes): some fifty million elements.
const LARGEST: u64 = 8 << 30;

/// A mesh and what its file held.
#[derive(Clone, Debug, PartialEq)]
pub struct GmshMesh {
    /// The mesh; its shapes are checked.
    pub mesh: Mesh,
    /// What the file held.
    pub report: GmshReport,
}

/// Reads a Gmsh file of version 4.1 or 2.2, text or binary.
///
/// # Errors
/// [`GmshError::File`] if it cannot be opened, [`GmshError::Content`] with the line or byte, the
/// section and the node or element at fault.
pub fn read_gmsh(path: impl AsRef<Path>) -> Result<GmshMesh, GmshError> {
    let path = path.as_ref();
    let bytes = crate::read_whole(path, LARGEST).map_err(IoError::file(path))?;
    parse(&bytes, Some(path.into()))
}

/// Reads a Gmsh file from memory, as [`read_gmsh`].
///
/// # Errors
/// [`GmshError::Content`].
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
    parse(bytes, None)
}

fn parse(bytes: &[u8], file: Option<PathBuf>) -> Result<GmshMesh, GmshError> {
    let (format, start) = match read::head(bytes) {
        Ok(head) => head,
        Err(located) => return Err(located.complete(bytes, true, file)),
    };
    let content = read::body(bytes, format, start)
        .and_then(|raw| assemble::assemble(&raw, format.version, format.encoding));
    match content {
        Ok((mesh, report)) => Ok(GmshMesh { mesh, report }),
        Err(located) => {
            let text = format.encoding == Encoding::Text;
            Err(located.complete(bytes, text, file))
        }
    }
}
