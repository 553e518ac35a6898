//! States of parts of a model as bytes.

use crate::StateError;

/// State of a part of a model between two steps as bytes, from which an equal part goes on in a resumed run.
pub trait SavedState {
    /// The present state as bytes.
    ///
    /// # Errors
    /// A state that cannot be saved.
    fn save_state(&self) -> Result<Vec<u8>, StateError>;
    /// Restores a state that an equal part [saved](Self::save_state).
    ///
    /// # Errors
    /// A state of another part.
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError>;
}
