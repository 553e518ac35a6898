//! Inputs of a run, by which its checkpoints are recognised.

use std::path::PathBuf;

use powerhouse_model::Checksum;
use serde::{Deserialize, Serialize};

use powerhouse_scene::Scene;

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
    /// The inputs of a scene that all have: program version, mesh, precision, duration.
    pub fn of_composed(scene: &Scene) -> Self {
        let mut mesh = Checksum::default();
        mesh.add_mesh(scene.mesh());
        Self {
            scene: None,
            case: None,
            changes: Vec::new(),
            origin: None,
            items: vec![
                ("program version".into(), env!("CARGO_PKG_VERSION").into()),
                ("mesh".into(), mesh.to_string()),
                ("precision".into(), format!("{:?}", scene.precision())),
                (DURATION.into(), scene.duration().to_string()),
            ],
        }
    }
    /// The same with further inputs: names, and checksums or values.
    #[must_use]
    pub fn with(mut self, items: impl IntoIterator<Item = (String, String)>) -> Self {
        self.items.extend(items);
        self
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
