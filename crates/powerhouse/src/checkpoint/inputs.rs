//! Inputs of a run, by which its checkpoints are recognised.

use std::path::{Path, PathBuf};

use powerhouse_model::Checksum;
use serde::{Deserialize, Serialize};

use crate::Scene;

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
    /// The inputs of a scene: program version, text of the scene without threads, results folder and checkpoints, the
    /// files that it names, mesh and precision. Of a scene that was composed in Rust mesh and program version alone are
    /// known.
    pub fn of(scene: &Scene) -> Self {
        let mut mesh = Checksum::default();
        mesh.add_mesh(scene.mesh());
        let mut items = vec![
            ("program version".into(), env!("CARGO_PKG_VERSION").into()),
            ("mesh".into(), mesh.to_string()),
        ];
        let source = scene.source();
        if let Some(source) = source {
            add_text(&mut items, &source.path, &source.text);
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

/// Adds the text of a scene and the files that it names.
#[cfg(feature = "scene-files")]
fn add_text(items: &mut Vec<(String, String)>, path: &Path, text: &str) {
    let mut table: toml::Table = toml::from_str(text).unwrap_or_default();
    if let Some(toml::Value::Table(output)) = table.get_mut("output") {
        output.remove("directory");
    }
    table.remove("threads");
    table.remove("checkpoint");
    let content = Checksum::of(table.to_string().as_bytes());
    items.push(("scene".into(), content.to_string()));
    let mut texts = Vec::new();
    table.values().for_each(|value| texts_in(value, &mut texts));
    texts.sort_unstable();
    texts.dedup();
    let folder = path.parent().unwrap_or(Path::new(""));
    for name in texts {
        let file = folder.join(&name);
        if file.is_file()
            && let Ok(bytes) = std::fs::read(&file)
        {
            items.push((format!("file '{name}'"), Checksum::of(&bytes).to_string()));
        }
    }
}

/// Adds the text of a scene.
#[cfg(not(feature = "scene-files"))]
fn add_text(items: &mut Vec<(String, String)>, _path: &Path, text: &str) {
    items.push(("scene".into(), Checksum::of(text.as_bytes()).to_string()));
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
