//! Entries of the list of cases of a sweep.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::mark::Fingerprint;
use crate::store;

/// Entry of the list of cases: name and fingerprint of the inputs.
#[derive(Serialize, Deserialize)]
pub struct CaseEntry {
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
    /// Name of the case.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// Whether the inputs have this fingerprint.
    pub(super) fn has(&self, fingerprint: &Fingerprint) -> bool {
        self.fingerprint == *fingerprint
    }
    /// Whether the case folder contains complete results with this fingerprint.
    pub fn is_finished(&self, sweep: &Path) -> bool {
        store::is_finished(&sweep.join(&self.name), &self.fingerprint)
    }
    /// Describes what is missing of the case; `None` if it is finished.
    pub fn gap(&self, sweep: &Path) -> Option<String> {
        if self.is_finished(sweep) {
            return None;
        }
        let missing = store::missing(&sweep.join(&self.name));
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
