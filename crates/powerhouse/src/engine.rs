//! The engine that runs a scene unless another one is given, the elements that it computes and the observers of
//! its steps.
//!
//! Scenes and studies know an [`Engine`] alone; this is the one place that chooses it.

use std::sync::Arc;

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

/// The engine with a graphics processor.
///
/// # Errors
/// A program that was compiled without it.
#[cfg(feature = "scene-files")]
pub(crate) fn gpu_engine() -> Result<Arc<dyn Engine>, &'static str> {
    #[cfg(feature = "gpu")]
    return Ok(Arc::new(ExplicitOnDevice::new(Arc::new(
        powerhouse_device::CudaDevices,
    ))));
    #[cfg(not(feature = "gpu"))]
    Err(
        "this program was compiled without graphics processors: compile it with `--features gpu`, or leave out `engine`",
    )
}

/// The engine of scenes and registries to which none is given.
pub(crate) fn standard_engine() -> Arc<dyn Engine> {
    Arc::new(Explicit)
}
