//! The engine of scenes to which none is given: the one place that chooses it.

use std::sync::Arc;

use powerhouse_explicit_core::Explicit;
pub use powerhouse_explicit_core::{ExplicitOnDevice, Leapfrog, OneSided};
use powerhouse_model::Engine;

/// The engine of scenes to which none is given.
pub fn standard_engine() -> Arc<dyn Engine> {
    Arc::new(Explicit)
}
