//! Errors of saving and restoring states.

use thiserror::Error;

/// State of a part of a run that cannot be saved or restored.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum StateError {
    /// Bytes that do not encode a state of such a part.
    #[error("its bytes do not encode a state of such a part ({reason})")]
    Unreadable {
        /// Cause of the failure.
        reason: String,
    },
    /// A value that cannot be encoded.
    #[error("it cannot be encoded ({reason})")]
    Unencodable {
        /// Cause of the failure.
        reason: String,
    },
    /// A state of another part: a property differs.
    #[error("it is that of another part: {what} is {found}, and {expected} here")]
    Foreign {
        /// The property that differs, such as the number of elements.
        what: &'static str,
        /// Its value in the saved state.
        found: String,
        /// Its value here.
        expected: String,
    },
    /// A state of a part that has none here.
    #[error("it is saved, but this part has none")]
    Unexpected,
    /// No state of a part that has one here.
    #[error("it is missing")]
    Missing,
    /// A state whose elements are computed in batches of another width here, and cannot be divided so.
    #[error(
        "energies are accounted for in batches of elements, which are {found} wide in the saved state and {expected} here"
    )]
    LaneWidth {
        /// Width of the batches in the saved state.
        found: usize,
        /// Width of the batches here.
        expected: usize,
    },
    /// A state that the engine refuses.
    #[error("it is refused: {reason}")]
    Refused {
        /// Cause of the failure.
        reason: String,
    },
}

impl StateError {
    /// Accepts the saved state of a part without a state, which is empty.
    ///
    /// # Errors
    /// [`StateError::Unexpected`] for a state that is not empty.
    pub fn expect_none(saved: &[u8]) -> Result<(), Self> {
        match saved {
            [] => Ok(()),
            _ => Err(Self::Unexpected),
        }
    }
    /// Accepts a property of a saved state that is the same here.
    ///
    /// # Errors
    /// [`StateError::Foreign`] with the name of a property that differs.
    pub fn expect_same<T: PartialEq + core::fmt::Debug>(
        what: &'static str,
        found: T,
        expected: T,
    ) -> Result<(), Self> {
        if found == expected {
            return Ok(());
        }
        Err(Self::Foreign {
            what,
            found: format!("{found:?}"),
            expected: format!("{expected:?}"),
        })
    }
}
