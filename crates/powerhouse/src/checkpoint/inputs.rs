//! Inputs of a run, by which its checkpoints are recognised.

use std::path::{Path, PathBuf};

use powerhouse_model::Checksum;
use serde::{Deserialize, Serialize};

use crate::Scene;
#[cfg(feature = "scene-files")]
use crate::SceneSpec;

/// Name of the input that is the duration of a run.
const DURATION: &str = "duration";

/// Inputs of a run: the scene and what it depends on, each with a checksum or value.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunInputs {
    /// Path of the scene file, absolute if it could be made so; none for a scene that was composed in Rust.
    pub scene: Option<PathBuf>,
    /// Name of the case that is run in place of the scene itself.
    pub case: Option<String>,
    /// Changes of keys of the scene file with which it was read, each as `KEY=VALUE`.
    pub changes: Vec<String>,
    /// The state of another run from which this one started, and what changed, in words; none for a run from its
    /// beginning.
    pub origin: Option<String>,
    /// Names of the inputs, and their checksums or values.
    items: Vec<(String, String)>,
}

impl RunInputs {
    /// The inputs of a scene: program version, version of registered parts, mesh, precision, duration, the keys of the scene,
    /// or of the case that it is, but for threads, results folder and checkpoints, and the files that it names. Of a scene
    /// that was composed in Rust all but keys and files are known.
    pub fn of(scene: &Scene) -> Self {
        let mut mesh = Checksum::default();
        mesh.add_mesh(scene.mesh());
        #[cfg_attr(
            not(feature = "scene-files"),
            expect(unused_mut, reason = "keys and files are those of scene files")
        )]
        let mut items = vec![
            ("program version".into(), env!("CARGO_PKG_VERSION").into()),
            ("mesh".into(), mesh.to_string()),
            ("precision".into(), format!("{:?}", scene.precision())),
            (DURATION.into(), scene.duration().to_string()),
        ];
        #[cfg(feature = "scene-files")]
        if let Some(registry) = scene.registry() {
            let version = registry.version().to_owned();
            items.push(("version of registered parts".into(), version));
        }
        let source = scene.source();
        #[cfg(feature = "scene-files")]
        if let Some(spec) = scene.spec() {
            add_keys(&mut items, spec);
        }
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.into());
        Self {
            scene: source.map(|source| absolute(&source.path)),
            case: scene.case().map(String::from),
            changes: scene.changes().to_vec(),
            origin: None,
            items,
        }
    }

    /// A checksum of all inputs, by which processes that run one scene together find that theirs differ; where the scene
    /// is has no influence.
    pub fn checksum(&self) -> u64 {
        let mut sum = Checksum::default();
        sum.add_whole(format!("{:?} {:?}", self.case, self.items).as_bytes());
        sum.value()
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
    let free = ["title", "allow", "wave", "motion", "record", "self_check"];
    match key_of(name) {
        Some(key) => free.contains(&key) || key.starts_with("output."),
        None => name == DURATION || is_file(name),
    }
}

/// Whether an input changes the incident waves.
pub(super) fn is_motion(name: &str) -> bool {
    is_file(name) || key_of(name).is_some_and(|key| ["wave", "motion", "record"].contains(&key))
}

fn key_of(name: &str) -> Option<&str> {
    name.strip_prefix("key '")?.strip_suffix('\'')
}

fn is_file(name: &str) -> bool {
    name.starts_with("file '")
}

/// Adds the keys of a scene, and the files that it names.
#[cfg(feature = "scene-files")]
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
