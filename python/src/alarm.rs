//! Exceptions of functions in Python that a run calls.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;

/// The cancellation flag of a run, and the exception of a function in Python that raised it.
#[derive(Default)]
pub(crate) struct Alarm {
    /// The cancellation flag.
    pub(crate) stop: Arc<AtomicBool>,
    raised: Mutex<Option<PyErr>>,
}

impl Alarm {
    /// Stops the run; the first exception is the one to show.
    pub(crate) fn raise(&self, error: PyErr) {
        let mut raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner);
        raised.get_or_insert(error);
        self.stop.store(true, Ordering::Relaxed);
    }
    /// Whether a function has raised an exception.
    pub(crate) fn is_raised(&self) -> bool {
        let raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner);
        raised.is_some()
    }
    /// The exception, if there is one.
    pub(crate) fn take(&self) -> Option<PyErr> {
        let mut raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner);
        raised.take()
    }
    /// The outcome of a function in Python; none, with the alarm raised, after an exception.
    pub(crate) fn watch<T>(&self, call: impl FnOnce(Python<'_>) -> PyResult<T>) -> Option<T> {
        if self.is_raised() {
            return None;
        }
        match Python::try_attach(call)? {
            Ok(value) => Some(value),
            Err(error) => {
                self.raise(error);
                None
            }
        }
    }
}
