//! Reading of JSON files.

use std::path::Path;

use serde::de::DeserializeOwned;

use crate::StudyError;

/// Reads a value from its JSON file.
///
/// # Errors
/// [`StudyError::Read`], [`StudyError::Outcome`].
pub fn read_json<T: DeserializeOwned>(file: &Path) -> Result<T, StudyError> {
    let text = std::fs::read(file).map_err(|source| StudyError::Read {
        file: file.into(),
        source,
    })?;
    serde_json::from_slice(&text).map_err(|source| StudyError::Outcome {
        file: file.into(),
        source,
    })
}
