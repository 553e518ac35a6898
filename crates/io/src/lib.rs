//! Files in and out: Gmsh meshes, accelerograms, VTU, CSV and JSON.

mod atomic;
mod error;
pub mod gmsh;
mod picture;
mod plot;
mod records;
mod scale;
mod summary;
mod table;
mod vtu;
mod xml;

pub use atomic::write_whole;
pub use error::IoError;
pub use gmsh::{GmshError, GmshMesh, parse_gmsh, read_gmsh, write_gmsh};
pub use picture::{
    ColourMap, Deformation, Picture, PictureField, PictureView, SectionPlane, write_picture,
};
pub use plot::{Plot, PlotCurve, PlotPanel, write_plot};
pub use records::{
    AccelerationUnit, CountRule, LengthRule, Record, RecordError, RecordFault, RecordOptions,
    common_length, parse_record, read_record,
};
pub use summary::write_summary;
pub use table::{TableColumn, read_table, write_table};
pub use vtu::{FieldPrecision, PvdCollection, VtuField, VtuWriter};
