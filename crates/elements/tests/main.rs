//! Blocks of elements, and the programs recorded from their kernels.

mod blocks;
#[cfg(feature = "programs")]
mod element_programs;
