//! Which cases are finished, and of what.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use powerhouse::io::write_summary;
use serde::{Deserialize, Serialize};

use super::{MARK, OUTCOME};
use crate::StudyError;
use crate::mark::{Checksum, Mark};

/// The summary of a run, which every run that writes into a folder replaces.
const SUMMARY: &str = "summary.json";

/// A case of a sweep, and what its results must be of to count.
#[derive(Serialize, Deserialize)]
pub(crate) struct Listed {
    name: String,
    mark: Mark,
}

impl Listed {
    pub(super) fn new(name: &str, mark: &Mark) -> Self {
        Self {
            name: name.into(),
            mark: mark.clone(),
        }
    }
    pub(crate) fn name(&self) -> &str {
        &self.name
    }
    /// Whether its folder, in that of the sweep, holds these results and all of them.
    pub(crate) fn is_finished(&self, sweep: &Path) -> bool {
        is_finished(&sweep.join(&self.name), &self.mark)
    }
    /// What keeps it from being finished, in words; nothing if it is.
    pub(crate) fn lacks(&self, sweep: &Path) -> Option<String> {
        let folder = sweep.join(&self.name);
        if is_finished(&folder, &self.mark) {
            return None;
        }
        let gone = read(&folder).map_or_else(Vec::new, |found| found.missing(&folder));
        Some(match &gone[..] {
            [] => format!("case '{}' is not finished", self.name),
            files => format!(
                "case '{}' was finished, but files of it are gone or changed: {}",
                self.name,
                files.join(", ")
            ),
        })
    }
}

/// What the folder of a finished case holds beside its results.
#[derive(Serialize, Deserialize)]
struct Finished {
    #[serde(flatten)]
    mark: Mark,
    /// Checksum of the summary of the run: another run into the same folder has another one.
    summary: String,
    /// Its files below the folder, with their sizes (bytes).
    files: Vec<(String, u64)>,
}

impl Finished {
    /// Files that are not there, or of another size.
    fn missing(&self, folder: &Path) -> Vec<String> {
        let differs = |(name, size): &&(String, u64)| {
            let found = fs::metadata(folder.join(name));
            found.map_or(true, |found| found.len() != *size)
        };
        let missing = self.files.iter().filter(differs);
        missing.map(|(name, _)| name.clone()).collect()
    }
}

fn read(folder: &Path) -> Option<Finished> {
    let text = fs::read(folder.join(MARK)).unwrap_or_default();
    serde_json::from_slice(&text).ok()
}

/// Whether a folder holds the results of a mark and all of them.
pub(super) fn is_finished(folder: &Path, mark: &Mark) -> bool {
    read(folder).is_some_and(|found| {
        let summary = summary_of(folder).ok();
        let is_same = found.mark == *mark && Some(&found.summary) == summary.as_ref();
        is_same && found.missing(folder).is_empty()
    })
}

/// Says that a folder holds the results of a mark and all of them: these files, and the outcome.
///
/// # Errors
/// A file that cannot be read or written.
pub(super) fn finish(folder: &Path, mark: &Mark, files: &[PathBuf]) -> Result<(), StudyError> {
    let outcome = folder.join(OUTCOME);
    let mut sizes = Vec::with_capacity(files.len() + 1);
    for file in files.iter().chain([&outcome]) {
        let found = fs::metadata(file).map_err(|source| {
            let file = file.clone();
            StudyError::Read { file, source }
        })?;
        let name = file.strip_prefix(folder).unwrap_or(file);
        sizes.push((name.to_string_lossy().into_owned(), found.len()));
    }
    let finished = Finished {
        mark: mark.clone(),
        summary: summary_of(folder)?,
        files: sizes,
    };
    Ok(write_summary(&folder.join(MARK), &finished).map_err(powerhouse::Error::from)?)
}

/// Takes back that a folder holds finished results.
///
/// # Errors
/// A file that cannot be removed.
pub(super) fn take_back(folder: &Path) -> Result<(), StudyError> {
    for name in [MARK, OUTCOME] {
        let file = folder.join(name);
        match fs::remove_file(&file) {
            Err(source) if source.kind() != ErrorKind::NotFound => {
                return Err(StudyError::Read { file, source });
            }
            _ => {}
        }
    }
    Ok(())
}

/// Checksum of the summary of the run in a folder.
fn summary_of(folder: &Path) -> Result<String, StudyError> {
    let file = folder.join(SUMMARY);
    let bytes = fs::read(&file).map_err(|source| StudyError::Read { file, source })?;
    let mut sum = Checksum::default();
    sum.add(&bytes);
    Ok(sum.text())
}
