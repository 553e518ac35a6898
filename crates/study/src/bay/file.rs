//! Reading of a bay from a file.

use std::path::Path;

use serde::Deserialize;

use super::{Bay, BayDimensions, BaySize, RockEnds};
use crate::StudyError;

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
    /// [`StudyError::Read`], [`StudyError::BayFile`] with the line, [`StudyError::Parameter`].
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, StudyError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| StudyError::Read {
            file: path.into(),
            source,
        })?;
        let read: BayFile = toml::from_str(&text).map_err(|source| StudyError::BayFile {
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
