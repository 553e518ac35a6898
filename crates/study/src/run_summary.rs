//! Summaries of runs, as their files have them.

use std::path::Path;

use powerhouse::summary::{BegunSummary, RunSummary};
use serde_json::Value;

use crate::StudyError;
use crate::json::read_json;

/// Name of the summary file in the folder of a run.
const FILE: &str = "summary.json";

/// Summary of a run that goes on, or has ended.
pub enum FoundSummary {
    /// That of a run with results.
    Whole(Box<RunSummary>),
    /// That of a run whose motion has not begun or has no results yet.
    Begun(BegunSummary),
}

impl FoundSummary {
    /// Reads the summary in a folder; none without a file.
    ///
    /// # Errors
    /// [`StudyError::Outcome`], which names the file and a key that is missing or of another form.
    pub fn read(folder: &Path) -> Result<Option<Self>, StudyError> {
        let file = folder.join(FILE);
        if !file.exists() {
            return Ok(None);
        }
        let found: Value = read_json(&file)?;
        // A summary without results has none of these keys.
        let is_whole = ["nodes", "steps", "peaks"]
            .iter()
            .any(|key| found.get(key).is_some());
        let read = if is_whole {
            serde_json::from_value(found).map(|whole| Self::Whole(Box::new(whole)))
        } else {
            serde_json::from_value(found).map(Self::Begun)
        };
        let read = read.map_err(|source| StudyError::Outcome { file, source });
        read.map(Some)
    }

    /// The summary of a folder with results.
    ///
    /// # Errors
    /// As [`read`](Self::read); [`StudyError::NoResults`] without results.
    pub fn of_results(folder: &Path) -> Result<RunSummary, StudyError> {
        match Self::read(folder)? {
            Some(Self::Whole(whole)) => Ok(*whole),
            _ => Err(StudyError::NoResults {
                folder: folder.into(),
            }),
        }
    }

    /// The summary of a run with results.
    pub fn whole(&self) -> Option<&RunSummary> {
        match self {
            Self::Whole(whole) => Some(whole),
            Self::Begun(_) => None,
        }
    }
    /// Title of the run.
    pub fn title(&self) -> &str {
        match self {
            Self::Whole(whole) => &whole.title,
            Self::Begun(begun) => &begun.title,
        }
    }
    /// How the run ended.
    pub fn ended(&self) -> &str {
        match self {
            Self::Whole(whole) => &whole.ended,
            Self::Begun(begun) => &begun.ended,
        }
    }
    /// Why the run failed or is incomplete.
    pub fn failure(&self) -> Option<&str> {
        match self {
            Self::Whole(whole) => whole.failure.as_deref(),
            Self::Begun(begun) => Some(&begun.failure),
        }
    }
    /// Paths of the files of the run, relative to its folder.
    pub fn files(&self) -> &[String] {
        match self {
            Self::Whole(whole) => &whole.files,
            Self::Begun(begun) => &begun.files,
        }
    }
}
