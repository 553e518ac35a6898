//! Scenes from files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Scene;
use crate::fault::{SceneFault, SceneText};
use crate::{Error, Registry, format, resolve};

impl Scene {
    /// Reads a scene file, its mesh and its records; laws, kernels and boundaries are those that
    /// come with the software.
    ///
    /// # Errors
    /// [`Error::Scene`] with file, line and column for everything that is wrong with the scene,
    /// [`Error::Read`] if the file itself cannot be read.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::from_file_with(path, &Registry::default())
    }
    /// The same with the names of a registry.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file).
    pub fn from_file_with(path: impl AsRef<Path>, registry: &Registry) -> Result<Self, Error> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| Error::Read {
            path: path.into(),
            source,
        })?;
        Self::from_toml(text, path, registry)
    }
    /// Reads a scene from text. `path` is the name in messages, and its folder the one that paths
    /// in the scene are relative to.
    ///
    /// # Errors
    /// [`Error::Scene`], as [`from_file`](Self::from_file).
    pub fn from_toml(
        text: impl Into<String>,
        path: impl Into<PathBuf>,
        registry: &Registry,
    ) -> Result<Self, Error> {
        let text = Arc::new(SceneText {
            path: path.into(),
            text: text.into(),
        });
        let composed = format::decode(&text.text).and_then(|file| {
            let mut scene = resolve::compose(&text, &file, registry)?;
            scene.directory = file.output.directory;
            Ok(scene)
        });
        let mut scene = composed.map_err(|fault| SceneFault::new(text.clone(), fault))?;
        scene.source = Some(text);
        Ok(scene)
    }
}
