//! The engine with a graphics processor.

use std::sync::Arc;

use powerhouse_model::Engine;

/// The engine with a graphics processor.
///
/// # Errors
/// A program that was compiled without it.
pub(crate) fn gpu_engine() -> Result<Arc<dyn Engine>, &'static str> {
    #[cfg(feature = "gpu")]
    return Ok(Arc::new(powerhouse_scene::internal::ExplicitOnDevice::new(
        Arc::new(powerhouse_device::CudaDevices),
    )));
    #[cfg(not(feature = "gpu"))]
    Err(
        "this program was compiled without graphics processors: compile it with `--features gpu`, or leave out `engine`",
    )
}
