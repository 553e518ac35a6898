//! Recognition of finished cases by their fingerprints.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use powerhouse::io::write_summary;
use powerhouse::model::Checksum;
use serde::{Deserialize, Serialize};

use super::{MARK, OUTCOME};
use crate::StudyError;
use crate::mark::Fingerprint;

/// Name of the summary file, which every run into a folder replaces.
const SUMMARY: &str = "summary.json";

/// Entry of the list of cases: name and fingerprint of the inputs.
#[derive(Serialize, Deserialize)]
pub(crate) struct CaseEntry {
    name: String,
    #[serde(rename = "mark")]
    fingerprint: Fingerprint,
}

impl CaseEntry {
    pub(super) fn new(name: &str, fingerprint: &Fingerprint) -> Self {
        Self {
            name: name.into(),
            fingerprint: fingerprint.clone(),
        }
    }
    pub(crate) fn name(&self) -> &str {
        &self.name
    }
    /// Whether the inputs have this fingerprint.
    pub(super) fn has(&self, fingerprint: &Fingerprint) -> bool {
        self.fingerprint == *fingerprint
    }
    /// Whether the case folder contains complete results with this fingerprint.
    pub(crate) fn is_finished(&self, sweep: &Path) -> bool {
        is_finished(&sweep.join(&self.name), &self.fingerprint)
    }
    /// Describes what is missing of the case; `None` if it is finished.
    pub(crate) fn gap(&self, sweep: &Path) -> Option<String> {
        let folder = sweep.join(&self.name);
        if is_finished(&folder, &self.fingerprint) {
            return None;
        }
        let missing = read(&folder).map_or_else(Vec::new, |found| found.missing(&folder));
        Some(match &missing[..] {
            [] => format!("case '{}' is not finished", self.name),
            files => format!(
                "case '{}' was finished, but files of it are gone or changed: {}",
                self.name,
                files.join(", ")
            ),
        })
    }
}

/// Contents of the fingerprint file of a finished case.
#[derive(Serialize, Deserialize)]
struct Finished {
    #[serde(flatten)]
    fingerprint: Fingerprint,
    /// Checksum of the summary of the run, which another run into the same folder changes.
    summary: String,
    /// Result files relative to the folder, with their sizes (bytes).
    files: Vec<(String, u64)>,
}

impl Finished {
    /// Files that are missing or have another size.
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

/// Whether a folder contains complete results with a fingerprint.
pub(super) fn is_finished(folder: &Path, fingerprint: &Fingerprint) -> bool {
    read(folder).is_some_and(|found| {
        let summary = summary_of(folder).ok();
        let is_same = found.fingerprint == *fingerprint && Some(&found.summary) == summary.as_ref();
        is_same && found.missing(folder).is_empty()
    })
}

/// Marks a folder as finished with a fingerprint and the given result files.
///
/// # Errors
/// A file that cannot be read or written.
pub(super) fn finish(
    folder: &Path,
    fingerprint: &Fingerprint,
    files: &[PathBuf],
) -> Result<(), StudyError> {
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
        fingerprint: fingerprint.clone(),
        summary: summary_of(folder)?,
        files: sizes,
    };
    Ok(write_summary(&folder.join(MARK), &finished).map_err(powerhouse::Error::from)?)
}

/// Removes the finished mark of a folder.
///
/// # Errors
/// A file that cannot be removed.
pub(super) fn unmark(folder: &Path) -> Result<(), StudyError> {
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

/// The checksum of the summary file in a folder.
fn summary_of(folder: &Path) -> Result<String, StudyError> {
    let file = folder.join(SUMMARY);
    let bytes = fs::read(&file).map_err(|source| StudyError::Read { file, source })?;
    let mut sum = Checksum::default();
    sum.add_whole(&bytes);
    Ok(sum.to_string())
}
