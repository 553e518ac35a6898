//! The engine: element kernels, blocks of lanes, explicit integrators, stable step, energy ledger.

mod assembly;

pub use assembly::{BlockFactory, BlockOptions, BlockPart, LaneWidth, Precision, Rayleigh};
