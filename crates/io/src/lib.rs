//! Files in and out: Gmsh meshes, accelerograms, VTU, CSV and JSON.

mod gmsh;

pub use gmsh::{
    ByteOrder, Encoding, GmshError, GmshFault, GmshGroup, GmshMesh, GmshPlace, GmshReport,
    GmshVersion, parse_gmsh, read_gmsh, write_gmsh,
};
