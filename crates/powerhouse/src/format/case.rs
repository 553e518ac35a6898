//! Cases of a sweep.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Ground, MeshFile, SceneFile, Support, Wave};

/// A case of a sweep: the scene with another mesh, other waves, another ground, other absorbing faces,
/// other supports, without some of its joints, or with other keys in some of its tables. What a case does
/// not name is as in the scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// The name, also that of the folder of its results.
    pub name: At<String>,
    /// The one choice by which it differs, in a few words, such as `dynamic friction`: reports compare
    /// it with the first case of the same waves that varies nothing.
    pub varies: Option<String>,
    /// A sweep leaves it out unless it is asked for by name: for a case that takes far longer than the
    /// others, such as one of a finer mesh.
    #[serde(default)]
    pub on_request: bool,
    /// Its mesh, in place of the scene's.
    pub mesh: Option<MeshFile>,
    /// Its waves, in place of all of the scene's.
    #[serde(rename = "wave", default)]
    pub waves: Vec<Wave>,
    /// Its ground, in place of the scene's.
    pub ground: Option<Ground>,
    /// Its absorbing faces, in place of the scene's.
    pub faces: Option<Vec<At<String>>>,
    /// Its supports, in place of all of the scene's; none if the list is empty. Those of stages stay.
    #[serde(rename = "support")]
    pub supports: Option<Vec<At<Support>>>,
    /// Joints that it does not have, by name: there the mesh is not cut, the sides are one body.
    #[serde(default)]
    pub continuous: Vec<At<String>>,
    /// Materials with other keys: the name of one of the scene's, and the keys that differ, each with its
    /// whole value. The same holds for the tables below.
    #[serde(rename = "material", default)]
    pub materials: Vec<ByName>,
    /// Parts with other keys, such as another damping, by their set.
    #[serde(rename = "part", default)]
    pub parts: Vec<BySet>,
    /// Joints with other keys, such as another friction, by name.
    #[serde(rename = "joint", default)]
    pub joints: Vec<ByName>,
    /// Records with other keys, such as another baseline or convention, by name.
    #[serde(rename = "record", default)]
    pub records: Vec<ByName>,
    /// Bolts with other keys, by name.
    #[serde(rename = "bolt", default)]
    pub bolts: Vec<ByName>,
    /// Stages with other keys, by name.
    #[serde(rename = "stage", default)]
    pub stages: Vec<ByName>,
    /// Keys of the boundary that differ, such as which motion comes in through it; its faces by `faces`.
    pub boundary: Option<Changed>,
    /// Keys of duration and time step that differ.
    pub time: Option<Changed>,
}

/// A table of the scene, by name, with the keys that differ.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(extend("additionalProperties" = true))]
pub struct ByName {
    /// The name of the scene's table.
    pub name: At<String>,
}

/// A part of the scene, by its set, with the keys that differ.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(extend("additionalProperties" = true))]
pub struct BySet {
    /// The element set of the scene's part.
    pub set: At<String>,
}

/// The keys that differ of a table of which there is one.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(extend("additionalProperties" = true))]
pub struct Changed {}

impl SceneFile {
    /// The scene as a case has it, once the keys that it changes in tables are in their places.
    pub(crate) fn with_case(&self, case: &Case) -> Self {
        let mut file = self.clone();
        if let Some(mesh) = &case.mesh {
            file.mesh = mesh.clone();
        }
        if let Some(supports) = &case.supports {
            file.supports.clone_from(supports);
        }
        if !case.waves.is_empty() {
            file.waves.clone_from(&case.waves);
        }
        if let Some(ground) = &case.ground {
            file.ground = ground.clone();
        }
        if let (Some(faces), Some(boundary)) = (&case.faces, &mut file.boundary) {
            boundary.faces.clone_from(faces);
        }
        let left = |name: &At<String>| !case.continuous.iter().any(|other| **other == **name);
        file.joints.retain(|joint| left(&joint.name));
        file.output.joints.retain(|history| left(&history.joint));
        for stage in &mut file.stages {
            stage.tied.retain(left);
            stage.bonded.retain(left);
        }
        file
    }
}
