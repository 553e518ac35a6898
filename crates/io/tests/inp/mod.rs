//! Reading the meshes of Abaqus input files.

mod kinds;
mod malformed;
mod mutated;
mod parts;
mod sample;
mod sets;
