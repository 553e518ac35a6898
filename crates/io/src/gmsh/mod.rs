//! Gmsh meshes.

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

pub use error::{GmshError, GmshFault, GmshPlace};
pub use format::{ByteOrder, Encoding, GmshVersion};
pub use report::{GmshGroup, GmshReport};
pub use write::write_gmsh;

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
/// [`GmshError`], with the line or byte at fault.
pub fn read_gmsh(path: impl AsRef<Path>) -> Result<GmshMesh, GmshError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| GmshError::File {
        file: path.into(),
        source,
    })?;
    parse(&bytes, Some(path.into()))
}

/// Reads a Gmsh file from memory, as [`read_gmsh`].
///
/// # Errors
/// [`GmshError`], with the line or byte at fault.
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
