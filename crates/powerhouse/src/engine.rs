//! The engine that runs a scene unless another one is given, the elements that it computes and the observers of
//! its steps.
//!
//! Scenes and studies know an [`Engine`] alone, which `powerhouse-scene` chooses.

pub use powerhouse_elements::*;
pub use powerhouse_explicit_core::*;
pub use powerhouse_model::{
    BlockFactory, BlockOptions, BlockPart, CheckpointSink, ElementChoice, ElementExtent, Ended,
    EnergyCheck, Engine, EngineError, EngineModel, HandOverReport, HourglassShare, LaneWidth,
    Length, Linearisation, ModelSpec, PeriodicPairs, Precision, Prescribed, Progress, Rayleigh,
    RunFailure, RunOptions, RunReport, SavedRun, SavedSection, StableStep, Stage, StageError,
    StageEvent, StageModel, StageReport, StateError, StaticError, StaticMethod, StaticOptions,
    StaticProgress, StaticReport, StepChoice, StressField, Support,
};
pub use powerhouse_observe as observe;
