//! Shared access to the results of observers.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use powerhouse_model::{StateError, decode, encode};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Shared access to the results of an observer, during and after a run.
///
/// ```
/// use powerhouse_observe::EnergyHistory;
/// use powerhouse_model::Cadence;
/// let energies = EnergyHistory::new(Cadence::Seconds(0.01))?;
/// let recording = energies.recording();
/// // `energies` goes into a run; afterwards:
/// assert!(recording.read(|table| table.times.is_empty()));
/// # Ok::<(), powerhouse_observe::ObserveError>(())
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
    /// Calls a function with the results so far and returns its value; the observer is blocked meanwhile.
    pub fn read<R>(&self, reader: impl FnOnce(&T) -> R) -> R {
        reader(&self.lock())
    }
    /// Copies the results recorded so far, also while the run goes on.
    pub fn copy(&self) -> T
    where
        T: Clone,
    {
        self.lock().clone()
    }
    /// The results recorded so far as bytes.
    pub(super) fn save(&self) -> Result<Vec<u8>, StateError>
    where
        T: Serialize,
    {
        encode(&*self.lock())
    }
    /// Restores results that were [saved](Self::save), if `check` accepts them in place of the present ones.
    pub(super) fn restore(
        &self,
        saved: &[u8],
        check: impl FnOnce(&T, &T) -> Result<(), StateError>,
    ) -> Result<(), StateError>
    where
        T: DeserializeOwned,
    {
        let found: T = decode(saved)?;
        let mut present = self.lock();
        check(&found, &present)?;
        *present = found;
        Ok(())
    }
    /// Locks the results. Only complete rows are written under the lock, so that the data stay valid after a panic.
    pub(super) fn lock(&self) -> MutexGuard<'_, T> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
