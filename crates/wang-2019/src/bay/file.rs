//! Reading of a bay from a file.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{Bay, BayDimensions, BaySize, RockEnds};
use crate::BayError;

/// Largest size of the file of a bay (bytes).
const LARGEST: u64 = 1 << 20;

/// Keys of the file of a bay.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BayFile {
    #[serde(default)]
    size: BaySize,
    #[serde(default)]
    dimensions: BayDimensions,
    ends: Option<RockEnds>,
}

impl Bay {
    /// Reads a bay from a TOML file.
    ///
    /// The keys are `size` (default `coarse`) and the tables `[dimensions]` and `[ends]` with the fields of
    /// [`BayDimensions`] (defaults as in the paper) and [`RockEnds`].
    ///
    /// # Errors
    /// [`BayError::Read`], [`BayError::File`] with the line, [`BayError::Parameter`].
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, BayError> {
        let path = path.as_ref();
        let unread = |source| BayError::Read {
            file: path.into(),
            source,
        };
        let bytes = powerhouse::io::read_whole(path, LARGEST).map_err(unread)?;
        let text = String::from_utf8(bytes)
            .map_err(|error| unread(std::io::Error::new(std::io::ErrorKind::InvalidData, error)))?;
        Self::from_toml(&text, path)
    }

    /// Bay of a text in TOML, with the keys of [`from_file`](Self::from_file). `path` is used in messages.
    ///
    /// # Errors
    /// [`BayError::File`] with the line, [`BayError::Parameter`].
    pub fn from_toml(text: &str, path: impl Into<PathBuf>) -> Result<Self, BayError> {
        let read: BayFile = toml::from_str(text).map_err(|source| BayError::File {
            file: path.into(),
            source: Box::new(source),
        })?;
        let bay = Self {
            dimensions: read.dimensions,
            cells: read.size.cells(),
            ends: read.ends,
        };
        bay.check()?;
        Ok(bay)
    }
}
