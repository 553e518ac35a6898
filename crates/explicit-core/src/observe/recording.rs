//! Results that outlive their observer.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What an observer has collected so far, shared with whoever made the observer.
///
/// ```
/// use powerhouse_explicit_core::observe::EnergyHistory;
/// use powerhouse_model::Cadence;
/// let energies = EnergyHistory::new(Cadence::Seconds(0.01))?;
/// let recording = energies.recording();
/// // `energies` goes into a run; afterwards:
/// assert!(recording.read(|table| table.times.is_empty()));
/// # Ok::<(), powerhouse_explicit_core::observe::ObserveError>(())
/// ```
#[derive(Debug, Default)]
pub struct Recording<T>(Arc<Mutex<T>>);

impl<T> Clone for Recording<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Recording<T> {
    pub(super) fn new(value: T) -> Self {
        Self(Arc::new(Mutex::new(value)))
    }
    /// Shows what has been collected; the observer waits meanwhile.
    pub fn read<R>(&self, look: impl FnOnce(&T) -> R) -> R {
        look(&self.lock())
    }
    /// A copy of what has been collected.
    pub fn copy(&self) -> T
    where
        T: Clone,
    {
        self.lock().clone()
    }
    /// Whole rows only are written under the lock, so that a panic elsewhere spoils nothing.
    pub(super) fn lock(&self) -> MutexGuard<'_, T> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
