//! Results for ParaView: VTU files of one instant each, and a PVD collection of them, written and read.
//!
//! The data follow the XML as raw bytes, compressed by zlib in blocks, as in the VTK file
//! formats page (Kitware, *VTK XML file formats*, appended data).

mod collection;
mod decode;
mod encode;
#[cfg(feature = "vtkhdf")]
mod one_file;
mod reader;
mod writer;

pub use collection::{PvdCollection, PvdEntry, read_pvd};
#[cfg(feature = "vtkhdf")]
pub use one_file::VtkHdf;
pub use reader::{FieldNumbers, FieldOfFile, VtuGrid, read_vtu};
pub use writer::{FieldPrecision, VtuField, VtuNumbers, VtuWriter};
