//! Reading and writing Gmsh files.

mod curves;
mod files;
mod malformed;
mod meaning;
mod mutated;
mod orders;
mod round_trip;
mod sample;
mod structure;
