//! Fingerprint of the inputs of a case, by which finished results are recognised.

use std::path::PathBuf;

use powerhouse::SceneSpec;
use powerhouse::model::Checksum;
use serde::{Deserialize, Serialize};

use crate::StudyError;

/// Version of the software, with a revision that is raised whenever the same inputs give other results within a
/// version.
pub(crate) const REVISION: &str = concat!("powerhouse ", env!("CARGO_PKG_VERSION"), " revision 7");

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
    /// The fingerprint of a scene, of the bytes of its [`inputs`], of a duration that replaces the scene's, and of the version
    /// of what is registered. The result folder and the number of threads have no influence.
    ///
    /// # Errors
    /// [`StudyError::Unwritable`].
    pub(crate) fn of(
        spec: &SceneSpec,
        files: &[Vec<u8>],
        duration: Option<f64>,
        registered: &str,
    ) -> Result<Self, StudyError> {
        let mut spec = spec.clone();
        (spec.output.directory, spec.threads) = (None, None);
        let mut sum = Checksum::default();
        sum.add_whole(text_of(&spec)?.as_bytes());
        files.iter().for_each(|bytes| sum.add_whole(bytes));
        Ok(Self {
            software: REVISION.into(),
            inputs: sum.to_string(),
            duration,
            registered: registered.into(),
        })
    }
}

/// The keys of a scene as text.
///
/// # Errors
/// [`StudyError::Unwritable`].
pub(crate) fn text_of(spec: &SceneSpec) -> Result<String, StudyError> {
    let text = spec.to_table().and_then(|table| toml::to_string(&table));
    text.map_err(|source| StudyError::Unwritable {
        file: spec.file().path().into(),
        source: Box::new(source),
    })
}

/// The bytes of all files that a scene names, such as mesh and records.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn inputs(spec: &SceneSpec) -> Result<Vec<Vec<u8>>, StudyError> {
    let folder = spec.file().text().folder();
    let names = spec.named_files().into_iter();
    let read =
        |file: PathBuf| std::fs::read(&file).map_err(|source| StudyError::Read { file, source });
    names.map(|name| read(folder.join(name))).collect()
}
