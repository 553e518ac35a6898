//! Reading and writing of files: meshes, tables, VTU results, plots and pictures.
//!
//! | read | written |
//! |---|---|
//! | Gmsh meshes, [`read_gmsh`] | Gmsh meshes, [`write_gmsh`] |
//! | meshes of Abaqus input files, [`read_inp`] | |
//! | | tables as CSV, [`write_table`]; any summary as JSON, [`write_summary`] |
//! | tables, [`read_table`] | fields for ParaView, [`VtuWriter`] and [`PvdCollection`] |
//! | these fields, [`read_vtu`], [`read_pvd`] | all of a run in one file, `VtkHdf` (feature `vtkhdf`) |
//! | motions of stations, [`read_station_motions`] | |
//! | | curves as SVG, [`write_plot`]; the mesh as PNG, [`write_picture`], moving, [`AnimationFile`] |
//!
//! The crate is independent of scenes, waves and engines: it reads and writes samples, meshes and
//! columns of numbers, with their units.
//!
//! # Features
//! All but `h5drm` and `vtkhdf` are on by default; tables (CSV) are always there. A program that needs one format compiles what that
//! format needs: `default-features = false, features = ["vtu"]`.
//!
//! | feature | what it adds | crates it brings |
//! |---|---|---|
//! | `gmsh` | Gmsh meshes, read and written | `mshio` |
//! | `inp` | meshes of Abaqus input files | none |
//! | `vtu` | VTU and PVD files | `flate2`, `roxmltree` |
//! | `plots` | plots as SVG | none |
//! | `pictures` | pictures as PNG | `png` |
//! | `json` | summaries as JSON | `serde`, `serde_json` |
//! | `free-space` | free space of a file system | `nix` (Unix) |
//! | `h5drm` | motions of stations in H5DRM files | `hdf5-pure`, `flate2` |
//! | `vtkhdf` | all instants of a run in one VTKHDF file; with `vtu` | `hdf5-pure` |
//!
//! # Why so
//! *All input is validated*: files come from other programs, other people and damaged disks. An error
//! states file, line or byte, value and permitted range. Memory is allocated in proportion to the size
//! of the file, never to a count that the file states.
//!
//! *Files are written atomically.* Each is written under a temporary name and renamed when it is
//! complete ([`write_whole`]); a collection of snapshots is valid after each of them, so that an
//! interrupted run leaves readable output.
//!
//! *Pictures and plots without another program.* They show quickly whether a result is plausible, on
//! any machine. For more there are ParaView and the CSV files.

mod atomic;
mod date;
#[cfg(any(feature = "gmsh", feature = "inp"))]
mod degenerate;
mod error;
#[cfg(feature = "gmsh")]
pub mod gmsh;
#[cfg(feature = "inp")]
pub mod inp;
mod known_format;
mod memory;
#[cfg(feature = "packed")]
mod packed;
#[cfg(feature = "pictures")]
mod picture;
#[cfg(feature = "plots")]
mod plot;
#[cfg(any(feature = "pictures", feature = "plots"))]
mod scale;
#[cfg(any(feature = "gmsh", feature = "inp"))]
mod second_order;
mod section_file;
mod stations;
#[cfg(feature = "json")]
mod summary;
mod table;
#[cfg(feature = "vtu")]
mod vtu;
mod whole;
#[cfg(any(feature = "vtu", feature = "plots"))]
mod xml;

#[cfg(feature = "free-space")]
pub use atomic::free_space;
pub use atomic::write_whole;
pub use date::utc_date;
pub use error::IoError;
#[cfg(feature = "gmsh")]
pub use gmsh::{
    GmshError, GmshMesh, parse_gmsh, parse_gmsh_with, read_gmsh, read_gmsh_with, write_gmsh,
};
#[cfg(feature = "inp")]
pub use inp::{InpError, InpMesh, parse_inp, parse_inp_with, read_inp, read_inp_with};
pub use known_format::{is_inp, known_format};
pub use memory::{available_memory, peak_memory};
#[cfg(feature = "packed")]
pub use packed::{
    PackedMesh, PackedMeshError, PackedMeshFault, PackedSource, is_packed_mesh, read_packed_mesh,
    write_packed_mesh,
};
#[cfg(feature = "pictures")]
pub use picture::{
    AnimationFile, ColourMap, Deformation, FacetField, Picture, PictureField, PictureView,
    SectionPlane, colour_range, shown_number, shown_unit, write_picture,
};
#[cfg(feature = "plots")]
pub use plot::{Plot, PlotCurve, PlotPanel, write_plot};
#[cfg(any(feature = "gmsh", feature = "inp"))]
pub use second_order::MeshOptions;
pub use section_file::{
    FileSection, SectionFault, SectionFileError, parse_sections, read_sections, write_sections,
};
pub use stations::{
    StationFileError, StationFileFault, StationForm, StationMotions, read_station_motions,
};
#[cfg(feature = "json")]
pub use summary::write_summary;
pub use table::{
    GrowingColumn, GrowingTable, TableColumn, csv_cell, parse_table, read_table, write_noted_table,
    write_table,
};
#[cfg(feature = "vtkhdf")]
pub use vtu::VtkHdf;
#[cfg(feature = "vtu")]
pub use vtu::{
    FieldNumbers, FieldOfFile, FieldPrecision, PvdCollection, PvdEntry, VtuField, VtuGrid,
    VtuNumbers, VtuWriter, read_pvd, read_vtu,
};
pub use whole::{Unread, file_checksum, read_whole};
