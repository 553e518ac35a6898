//! Reading the meshes of Abaqus input files.

mod assembly;
mod kinds;
mod lenient;
mod malformed;
mod mutated;
mod parts;
mod sample;
mod sets;
