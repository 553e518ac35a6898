//! What a case was computed from, so that finished work is known again.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::StudyError;

/// The software as far as results depend on it: its version, and a number that rises whenever the same inputs
/// come to other results within a version.
pub(crate) const REVISION: &str = concat!("powerhouse ", env!("CARGO_PKG_VERSION"), " revision 5");

/// What a case was computed from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Mark {
    /// The [`REVISION`] of the software.
    software: String,
    /// The scene and the files beside it that it names, as a checksum of their bytes.
    inputs: String,
    /// The duration, if it is not the scene's (s).
    #[serde(skip_serializing_if = "Option::is_none", default)]
    duration: Option<f64>,
    /// The version of a program's own laws, boundaries and kernels, if it says one.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    registered: String,
}

impl Mark {
    /// The mark of a scene, of files by their bytes, of a duration of its own, and of the version of what is
    /// registered.
    pub(crate) fn of(
        scene: &str,
        files: &[Vec<u8>],
        duration: Option<f64>,
        registered: &str,
    ) -> Self {
        let mut sum = Checksum::default();
        sum.add(scene.as_bytes());
        files.iter().for_each(|bytes| sum.add(bytes));
        Self {
            software: REVISION.into(),
            inputs: sum.text(),
            duration,
            registered: registered.into(),
        }
    }

    /// The marks of the cases of a scene: of what the scene and the case say, whatever other cases there
    /// are, where results go and how many threads compute them; and of the files that are named there.
    ///
    /// # Errors
    /// A scene that is no TOML, a file that cannot be read.
    pub(crate) fn of_cases(
        (path, scene): (&Path, &str),
        cases: &[String],
        duration: Option<f64>,
        registered: &str,
    ) -> Result<BTreeMap<String, Self>, StudyError> {
        let mut all = table(path, scene)?;
        if let Some(toml::Value::Table(output)) = all.get_mut("output") {
            output.remove("directory");
        }
        all.remove("threads");
        let of_case = |case: &String| {
            let mut table = all.clone();
            if let Some(toml::Value::Array(cases)) = table.get_mut("case") {
                cases.retain(|own| is_case(own, case));
            }
            let files = files_of(path, &table)?;
            let mark = Self::of(&table.to_string(), &files, duration, registered);
            Ok((case.clone(), mark))
        };
        cases.iter().map(of_case).collect()
    }

    /// Whether a file holds this mark.
    pub(crate) fn is_in(&self, file: &Path) -> bool {
        let text = std::fs::read(file).unwrap_or_default();
        let found: Option<Self> = serde_json::from_slice(&text).ok();
        found.as_ref() == Some(self)
    }
}

/// The bytes of the files that a scene names, mesh, records and others: of every text in it that is
/// the path of a file.
pub(crate) fn inputs(path: &Path, text: &str) -> Result<Vec<Vec<u8>>, StudyError> {
    files_of(path, &table(path, text)?)
}

/// Whether a table of a scene is the case of a name.
pub(crate) fn is_case(own: &toml::Value, name: &str) -> bool {
    own.get("name").and_then(toml::Value::as_str) == Some(name)
}

fn table(path: &Path, text: &str) -> Result<toml::Table, StudyError> {
    toml::from_str(text).map_err(|source| StudyError::BayFile {
        file: path.into(),
        source: Box::new(source),
    })
}

/// The bytes of the files that a table names.
fn files_of(path: &Path, table: &toml::Table) -> Result<Vec<Vec<u8>>, StudyError> {
    let mut texts = Vec::new();
    table.values().for_each(|value| texts_in(value, &mut texts));
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = texts.into_iter().map(|text| folder.join(text));
    files
        .filter(|file| file.is_file())
        .map(|file| read(&file))
        .collect()
}

fn read(file: &Path) -> Result<Vec<u8>, StudyError> {
    std::fs::read(file).map_err(|source| StudyError::Read {
        file: file.into(),
        source,
    })
}

/// All texts in a value.
fn texts_in(value: &toml::Value, texts: &mut Vec<String>) {
    match value {
        toml::Value::String(text) => texts.push(text.clone()),
        toml::Value::Array(items) => items.iter().for_each(|item| texts_in(item, texts)),
        toml::Value::Table(table) => table.values().for_each(|item| texts_in(item, texts)),
        _ => {}
    }
}

/// FNV-1a over 64 bits (Fowler, Noll & Vo): tells an edited file from the old one, not a forged one.
pub(crate) struct Checksum(u64);

impl Default for Checksum {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    /// Goes on over these bytes.
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        // The length too, so that bytes cannot wander from one file into the next.
        let length = (bytes.len() as u64).to_le_bytes();
        for &byte in length.iter().chain(bytes) {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The sum as text.
    pub(crate) fn text(&self) -> String {
        format!("{:016x}", self.0)
    }
}
