//! Inputs of a run, by which its checkpoints are recognised.

use std::path::{Path, PathBuf};

use powerhouse_model::Checksum;
use serde::{Deserialize, Serialize};

use crate::{Scene, SceneText};

/// Inputs of a run: the scene and what it depends on, each with a checksum or value.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunInputs {
    /// Path of the scene file, absolute if it could be made so; none for a scene that was composed in Rust.
    pub scene: Option<PathBuf>,
    /// Name of the case that is run in place of the scene itself.
    pub case: Option<String>,
    /// Names of the inputs, and their checksums or values.
    items: Vec<(String, String)>,
}

impl RunInputs {
    /// The inputs of a scene: program version, version of registered parts, mesh, precision, duration, text of the scene
    /// without threads, results folder, checkpoints and cases but its own, and the files that it names. Of a scene that
    /// was composed in Rust all but text and files are known.
    pub fn of(scene: &Scene) -> Self {
        let mut mesh = Checksum::default();
        mesh.add_mesh(scene.mesh());
        let mut items = vec![
            ("program version".into(), env!("CARGO_PKG_VERSION").into()),
            ("mesh".into(), mesh.to_string()),
            ("precision".into(), format!("{:?}", scene.precision())),
            ("duration".into(), scene.duration().to_string()),
        ];
        #[cfg(feature = "scene-files")]
        if let Some(registry) = scene.registry() {
            let version = registry.version().to_owned();
            items.push(("version of registered parts".into(), version));
        }
        let source = scene.source();
        if let Some(source) = source {
            add_text(&mut items, source, scene.case());
        }
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.into());
        Self {
            scene: source.map(|source| absolute(&source.path)),
            case: scene.case().map(String::from),
            items,
        }
    }

    /// Name of the first input that differs from those of another run; none if all are the same.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.case != other.case {
            return Some("case".into());
        }
        let has = |items: &[(String, String)], item: &(String, String)| items.contains(item);
        let other_than = self.items.iter().find(|item| !has(&other.items, item));
        let added = other.items.iter().find(|item| !has(&self.items, item));
        other_than.or(added).map(|item| item.0.clone())
    }
}

/// Adds the text of a scene, of its cases only one, and the files that it names.
#[cfg(feature = "scene-files")]
fn add_text(items: &mut Vec<(String, String)>, source: &SceneText, case: Option<&str>) {
    let mut table: toml::Table = toml::from_str(&source.text).unwrap_or_default();
    if let Some(toml::Value::Table(output)) = table.get_mut("output") {
        output.remove("directory");
    }
    table.remove("threads");
    table.remove("checkpoint");
    if let Some(toml::Value::Array(cases)) = table.get_mut("case") {
        cases.retain(|own| case.is_some() && own.get("name").and_then(toml::Value::as_str) == case);
    }
    let text = table.to_string();
    items.push(("scene".into(), Checksum::of(text.as_bytes()).to_string()));
    let mut names = named_files(&source.path, &text);
    names.sort_unstable();
    names.dedup();
    let folder = source.path.parent().unwrap_or(Path::new(""));
    for name in names {
        if let Ok(bytes) = std::fs::read(folder.join(&name)) {
            items.push((format!("file '{name}'"), Checksum::of(&bytes).to_string()));
        }
    }
}

/// Adds the text of a scene.
#[cfg(not(feature = "scene-files"))]
fn add_text(items: &mut Vec<(String, String)>, source: &SceneText, _case: Option<&str>) {
    let text = Checksum::of(source.text.as_bytes());
    items.push(("scene".into(), text.to_string()));
}

/// Names of the files on which a scene depends, such as mesh and records, in the order of its text: all strings in it that
/// are the path of a file, as seen from the folder of the scene. None for a text that is not valid TOML.
#[cfg(feature = "scene-files")]
pub fn named_files(scene: &Path, text: &str) -> Vec<String> {
    let table: toml::Table = toml::from_str(text).unwrap_or_default();
    let mut texts = Vec::new();
    table.values().for_each(|value| texts_in(value, &mut texts));
    let folder = scene.parent().unwrap_or(Path::new(""));
    texts.retain(|text| folder.join(text).is_file());
    texts
}

/// Collects all strings in a value.
#[cfg(feature = "scene-files")]
fn texts_in(value: &toml::Value, texts: &mut Vec<String>) {
    match value {
        toml::Value::String(text) => texts.push(text.clone()),
        toml::Value::Array(items) => items.iter().for_each(|item| texts_in(item, texts)),
        toml::Value::Table(table) => table.values().for_each(|item| texts_in(item, texts)),
        _ => {}
    }
}
