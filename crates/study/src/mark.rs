//! Fingerprint of the inputs of a case, by which finished results are recognised.

use std::collections::BTreeMap;
use std::path::Path;

use powerhouse::model::Checksum;
use powerhouse::named_files;
use serde::{Deserialize, Serialize};

use crate::StudyError;

/// Version of the software, with a revision that is raised whenever the same inputs give other results within a
/// version.
pub(crate) const REVISION: &str = concat!("powerhouse ", env!("CARGO_PKG_VERSION"), " revision 5");

/// Fingerprint of the inputs of a case: software revision, checksum of scene and files, duration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Fingerprint {
    /// The [`REVISION`] of the software that computed the case.
    software: String,
    /// Checksum of the bytes of the scene and of the files that it names.
    inputs: String,
    /// Duration (s), if it is not that of the scene.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    duration: Option<f64>,
    /// The version of a program's own laws, boundaries and kernels, if it says one.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    registered: String,
}

impl Fingerprint {
    /// The fingerprint of a scene's text, of the bytes of its files, of a duration that replaces the scene's, and of the version of what is
    /// registered.
    pub(crate) fn of(
        scene: &str,
        files: &[Vec<u8>],
        duration: Option<f64>,
        registered: &str,
    ) -> Self {
        let mut sum = Checksum::default();
        sum.add_whole(scene.as_bytes());
        files.iter().for_each(|bytes| sum.add_whole(bytes));
        Self {
            software: REVISION.into(),
            inputs: sum.to_string(),
            duration,
            registered: registered.into(),
        }
    }

    /// The fingerprints of the cases of a scene, from the keys of the scene and of the case and the named files. Other
    /// cases, the result folder and the number of threads have no influence.
    ///
    /// # Errors
    /// A scene that is not valid TOML, a file that cannot be read.
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
            let text = table.to_string();
            let files = inputs(path, &text)?;
            let mark = Self::of(&text, &files, duration, registered);
            Ok((case.clone(), mark))
        };
        cases.iter().map(of_case).collect()
    }

    /// Whether a file contains this fingerprint.
    pub(crate) fn is_in(&self, file: &Path) -> bool {
        let text = std::fs::read(file).unwrap_or_default();
        let found: Option<Self> = serde_json::from_slice(&text).ok();
        found.as_ref() == Some(self)
    }
}

/// Whether a table of a scene is the case with a name.
pub(crate) fn is_case(own: &toml::Value, name: &str) -> bool {
    own.get("name").and_then(toml::Value::as_str) == Some(name)
}

fn table(path: &Path, text: &str) -> Result<toml::Table, StudyError> {
    toml::from_str(text).map_err(|source| StudyError::SceneFile {
        file: path.into(),
        source: Box::new(source),
    })
}

/// The bytes of all files that a scene names, such as mesh and records.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn inputs(path: &Path, text: &str) -> Result<Vec<Vec<u8>>, StudyError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let names = named_files(path, text).into_iter();
    names.map(|name| read(&folder.join(name))).collect()
}

fn read(file: &Path) -> Result<Vec<u8>, StudyError> {
    std::fs::read(file).map_err(|source| StudyError::Read {
        file: file.into(),
        source,
    })
}
