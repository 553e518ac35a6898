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
    /// The state of another run from which this one started, and what changed, in words; none for a run from its
    /// beginning.
    pub origin: Option<String>,
    /// Names of the inputs, and their checksums or values.
    items: Vec<(String, String)>,
}

impl RunInputs {
    /// The inputs of a scene: program version, the keys of the scene file but for threads, results folder, checkpoints and
    /// other cases, the files that it names, and the mesh. Of a scene that was composed in Rust mesh and program version
    /// alone are known.
    pub fn of(scene: &Scene) -> Self {
        let mut mesh = Checksum::default();
        mesh.add_mesh(scene.mesh());
        let mut items = vec![
            ("program version".into(), env!("CARGO_PKG_VERSION").into()),
            ("the mesh".into(), mesh.to_string()),
        ];
        let source = scene.source();
        if let Some(source) = source {
            add_text(&mut items, &source.path, &source.text, scene.case());
        }
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.into());
        Self {
            scene: source.map(|source| absolute(&source.path)),
            case: scene.case().map(String::from),
            origin: None,
            items,
        }
    }

    /// Names of the inputs that differ from those of another run, those that exist in one of the two included.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let mut names = Vec::new();
        if self.case != other.case {
            names.push("the case".into());
        }
        let both = [(&self.items, &other.items), (&other.items, &self.items)];
        for (these, those) in both {
            let changed = these.iter().filter(|item| !those.contains(item));
            for (name, _) in changed {
                if !names.contains(name) {
                    names.push(name.clone());
                }
            }
        }
        names
    }
}

/// Whether an input may change between a run and a variant that starts from one of its states: what has no influence on
/// the motion until then.
pub(super) fn may_vary(name: &str) -> bool {
    let free = [
        "title",
        "allow",
        "wave",
        "record",
        "time.duration",
        "self_check",
    ];
    match name
        .strip_prefix("key '")
        .and_then(|key| key.strip_suffix('\''))
    {
        Some(key) => free.contains(&key) || key.starts_with("output."),
        None => is_file(name),
    }
}

/// Whether an input changes the incident waves.
pub(super) fn is_motion(name: &str) -> bool {
    is_file(name) || ["key 'wave'", "key 'record'"].contains(&name)
}

fn is_file(name: &str) -> bool {
    name.starts_with("file '")
}

/// Adds the keys of a scene, or of a case of it, and the files that it names.
#[cfg(feature = "scene-files")]
fn add_text(items: &mut Vec<(String, String)>, path: &Path, text: &str, case: Option<&str>) {
    let mut table: toml::Table = toml::from_str(text).unwrap_or_default();
    if let Some(toml::Value::Table(output)) = table.get_mut("output") {
        output.remove("directory");
    }
    for key in ["threads", "checkpoint"] {
        table.remove(key);
    }
    // Other cases than the one that is run do not change it.
    let own = |found: &&toml::Value| {
        let name = found.get("name").and_then(toml::Value::as_str);
        name.is_some() && name == case
    };
    let cases = table.remove("case");
    let cases = cases.as_ref().and_then(toml::Value::as_array);
    if let Some(own) = cases.and_then(|cases| cases.iter().find(own)) {
        table.insert("case".into(), own.clone());
    }
    let sum = |value: &toml::Value| Checksum::of(value.to_string().as_bytes()).to_string();
    for (key, value) in &table {
        match value {
            toml::Value::Table(keys) if key != "case" => {
                let keys = keys.iter();
                items.extend(keys.map(|(own, value)| (format!("key '{key}.{own}'"), sum(value))));
            }
            _ => items.push((format!("key '{key}'"), sum(value))),
        }
    }
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
fn add_text(items: &mut Vec<(String, String)>, _path: &Path, text: &str, _case: Option<&str>) {
    items.push((
        "the scene".into(),
        Checksum::of(text.as_bytes()).to_string(),
    ));
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
