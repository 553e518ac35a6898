//! Cases of a sweep.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Ground, MeshFile, SceneFile, Support, Wave};

/// A case of a sweep: the scene with another mesh, other waves, another ground, other absorbing faces,
/// other supports, or without some of its joints. What a case does not name is as in the scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// The name, also that of the folder of its results.
    pub name: At<String>,
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
}

impl SceneFile {
    /// The scene as a case has it.
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
