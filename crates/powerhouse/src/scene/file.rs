//! Scenes from files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Scene;
use crate::fault::{Fault, Problem, SceneFault, SceneText};
use crate::format::Case;
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
        Self::from_toml(read(path)?, path, registry)
    }
    /// Reads a case of a scene file: the scene with what the case changes.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file), and [`Error::NoSuchCase`].
    pub fn case_from_file_with(
        path: impl AsRef<Path>,
        case: &str,
        registry: &Registry,
    ) -> Result<Self, Error> {
        let path = path.as_ref();
        Self::compose(read(path)?, path.into(), Some(case), registry)
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
        Self::compose(text.into(), path.into(), None, registry)
    }

    fn compose(
        text: String,
        path: PathBuf,
        case: Option<&str>,
        registry: &Registry,
    ) -> Result<Self, Error> {
        let text = Arc::new(SceneText { path, text });
        let refused = |fault| SceneFault::new(text.clone(), fault);
        let mut file = format::decode(&text.text).map_err(refused)?;
        let cases = case_names(&file.cases).map_err(refused)?;
        if let Some(name) = case {
            if !cases.iter().any(|case| case == name) {
                let (name, available) = (name.into(), cases);
                return Err(Error::NoSuchCase { name, available });
            }
            file = format::decode_case(&text.text, name).map_err(refused)?;
        } else {
            // A sweep of hours is to say at its start what is wrong with its last case.
            for name in &cases {
                check_case(&text.text, name, registry).map_err(refused)?;
            }
        }
        let mut scene = resolve::compose(&text, &file, registry).map_err(refused)?;
        scene.directory = file.output.directory;
        scene.cases = cases;
        let on_request = file.cases.iter().filter(|case| case.on_request);
        scene.cases_on_request = on_request.map(|case| case.name.to_string()).collect();
        scene.case = case.map(str::to_owned);
        scene.source = Some(text);
        Ok(scene)
    }
}

fn read(path: &Path) -> Result<String, Error> {
    std::fs::read_to_string(path).map_err(|source| Error::Read {
        path: path.into(),
        source,
    })
}

/// Reads a case as far as neither mesh nor records are needed.
fn check_case(text: &str, name: &str, registry: &Registry) -> Result<(), Fault> {
    let file = format::decode_case(text, name)?;
    for material in &file.materials {
        registry.material(material)?;
    }
    for joint in &file.joints {
        registry.joint_law(joint)?;
    }
    if let Some(boundary) = &file.boundary {
        registry.boundary(boundary)?;
    }
    Ok(())
}

/// The names of cases, each of them once.
fn case_names(cases: &[Case]) -> Result<Vec<String>, Fault> {
    let mut names: Vec<String> = Vec::with_capacity(cases.len());
    for case in cases {
        let name = case.name.to_string();
        if names.contains(&name) {
            let what = "case";
            let problem = Problem::Duplicate { what, name };
            return Err(Fault::new(case.name.span(), problem));
        }
        names.push(name);
    }
    Ok(names)
}
