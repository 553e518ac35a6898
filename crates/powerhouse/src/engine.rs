//! The engine that runs a scene, the elements that it computes and the observers of its steps.

pub use powerhouse_elements::*;
pub use powerhouse_explicit_core::*;
pub use powerhouse_model::{
    BlockFactory, BlockOptions, BlockPart, ElementExtent, EngineError, LaneWidth, Precision,
    Rayleigh,
};
pub use powerhouse_observe as observe;
