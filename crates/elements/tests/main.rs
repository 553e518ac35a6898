//! Blocks of elements, and the programs recorded from their kernels.

mod blocks;
mod element_programs;
