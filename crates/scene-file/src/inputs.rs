//! Inputs of a run that a scene file names, by which its checkpoints are recognised.

use powerhouse_model::Checksum;

use crate::{FileScene, SceneSpec};

impl FileScene {
    /// Names, and checksums or values, of what a run of the scene depends on beside the scene itself: version of registered
    /// parts, the keys of the file, or of the case that the scene is, but for threads, results folder and checkpoints, and the
    /// files that it names. None of a scene that was composed in Rust.
    pub fn inputs(&self) -> Vec<(String, String)> {
        let mut items = Vec::new();
        if let Some(registry) = self.registry() {
            let version = registry.version().to_owned();
            items.push(("version of registered parts".into(), version));
        }
        if let Some(spec) = self.spec() {
            add_keys(&mut items, spec);
        }
        items
    }
}

/// Adds the keys of a scene, and the files that it names.
fn add_keys(items: &mut Vec<(String, String)>, spec: &SceneSpec) {
    // A number that TOML does not have is refused where it is read.
    let mut table = spec.to_table().unwrap_or_default();
    // Inputs of their own, or without influence.
    for (of, key) in [("output", "directory"), ("time", "duration")] {
        if let Some(toml::Value::Table(keys)) = table.get_mut(of) {
            keys.remove(key);
        }
    }
    for key in ["threads", "checkpoint", "precision"] {
        table.remove(key);
    }
    let sum = |value: &toml::Value| Checksum::of(value.to_string().as_bytes()).to_string();
    for (key, value) in &table {
        match value {
            toml::Value::Table(keys) => {
                let keys = keys.iter();
                items.extend(keys.map(|(own, value)| (format!("key '{key}.{own}'"), sum(value))));
            }
            toml::Value::Array(values) if values.is_empty() => {}
            _ => items.push((format!("key '{key}'"), sum(value))),
        }
    }
    let mut names = spec.named_files();
    names.sort_unstable();
    names.dedup();
    let folder = spec.file().text().folder();
    for name in names {
        if let Ok(sum) = powerhouse_io::file_checksum(&folder.join(&name)) {
            items.push((format!("file '{name}'"), sum.to_string()));
        }
    }
}
