//! Files in and out: Gmsh meshes, accelerograms, VTU, CSV and JSON.
