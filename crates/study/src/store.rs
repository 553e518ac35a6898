//! Store of runs: folders whose finished results are recognised by the fingerprint of their inputs.
//!
//! A finished run has a file with the fingerprint, the sizes of its result files and the checksum of its summary, which
//! another run into the same folder changes. It is written last.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use powerhouse::io::write_summary;
use powerhouse::model::Checksum;
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::mark::Fingerprint;

/// Name of the fingerprint file in the folder of a run.
pub const MARK: &str = "finished.json";
/// Name of the summary file, which every run of a scene into a folder replaces.
const SUMMARY: &str = "summary.json";

/// Contents of the fingerprint file of a finished run.
#[derive(Serialize, Deserialize)]
struct Finished {
    #[serde(flatten)]
    fingerprint: Fingerprint,
    /// Checksum of the summary of the run; empty for a run without one.
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
pub(crate) fn is_finished(folder: &Path, fingerprint: &Fingerprint) -> bool {
    read(folder).is_some_and(|found| {
        let summary = summary_of(folder).ok();
        let is_same = found.fingerprint == *fingerprint && Some(&found.summary) == summary.as_ref();
        is_same && found.missing(folder).is_empty()
    })
}

/// Whether a folder has the mark of finished results with another fingerprint.
pub(crate) fn has_other(folder: &Path, fingerprint: &Fingerprint) -> bool {
    read(folder).is_some_and(|found| found.fingerprint != *fingerprint)
}

/// Result files of a folder that was finished that are missing or have another size; none if it was not finished.
pub(crate) fn missing(folder: &Path) -> Vec<String> {
    read(folder).map_or_else(Vec::new, |found| found.missing(folder))
}

/// Marks a folder as finished with a fingerprint and the given result files.
///
/// # Errors
/// A file that cannot be read or written.
pub(crate) fn finish(
    folder: &Path,
    fingerprint: &Fingerprint,
    files: &[PathBuf],
) -> Result<(), StudyError> {
    let mut sizes = Vec::with_capacity(files.len());
    for file in files {
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

/// Removes the finished mark of a folder, and some of its files.
///
/// # Errors
/// A file that cannot be removed.
pub(crate) fn unmark(folder: &Path, files: &[&str]) -> Result<(), StudyError> {
    for name in [MARK].iter().chain(files) {
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

/// The checksum of the summary file in a folder; empty without one.
fn summary_of(folder: &Path) -> Result<String, StudyError> {
    let file = folder.join(SUMMARY);
    match fs::read(&file) {
        Ok(bytes) => {
            let mut sum = Checksum::default();
            sum.add_whole(&bytes);
            Ok(sum.to_string())
        }
        Err(source) if source.kind() == ErrorKind::NotFound => Ok(String::new()),
        Err(source) => Err(StudyError::Read { file, source }),
    }
}
