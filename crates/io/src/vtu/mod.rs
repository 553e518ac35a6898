//! Results for ParaView: VTU files of one instant each, and a PVD collection of them.
//!
//! The data follow the XML as raw bytes, compressed by zlib in blocks, as in the VTK file
//! formats page (Kitware, *VTK XML file formats*, appended data).

mod collection;
mod encode;
mod writer;

pub use collection::PvdCollection;
pub use writer::{FieldPrecision, VtuField, VtuNumbers, VtuWriter};
