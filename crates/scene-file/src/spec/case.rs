//! Cases of a sweep.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{
    At, Ground, InSituStress, Layer, MeshFile, Motion, Precision, SceneSpec, Support, Wave,
};

/// A case of a sweep: a variant of the scene with another mesh, other waves, ground, absorbing faces or supports,
/// without some of its joints, or with changed keys in some of its tables. Everything else is as in the scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Name of the case, and of its results folder; 1 to 100 characters.
    pub name: At<String>,
    /// Short description of the one parameter that the case varies, such as `dynamic friction`: reports compare
    /// it with the first case of the same waves without this key.
    pub varies: Option<String>,
    /// Whether the case is computed only when requested by name, as for a case of a finer mesh that takes much
    /// longer than the others; false by default.
    #[serde(default)]
    pub on_request: bool,
    /// Floating-point precision of the case; that of the scene by default.
    pub precision: Option<Precision>,
    /// Mesh of the case; that of the scene by default.
    pub mesh: Option<MeshFile>,
    /// Waves of the case, in place of all waves of the scene; those of the scene by default.
    #[serde(rename = "wave", default)]
    pub waves: Vec<Wave>,
    /// Recorded motions of the case, in place of all of the scene; those of the scene by default.
    #[serde(rename = "motion", default)]
    pub motions: Vec<Motion>,
    /// Free-field site of the case; that of the scene by default.
    pub ground: Option<Ground>,
    /// Layers of the ground of the case, in place of all layers of the scene; those of the scene by default.
    #[serde(rename = "layer", default)]
    pub layers: Vec<Layer>,
    /// In-situ stress of the case; that of the scene by default.
    pub in_situ_stress: Option<At<InSituStress>>,
    /// Absorbing faces of the case; those of the scene by default.
    pub faces: Option<Vec<At<String>>>,
    /// Supports of the case, in place of all supports of the scene (an empty list: none); those of the scene by
    /// default. Supports of stages are kept.
    #[serde(rename = "support")]
    pub supports: Option<Vec<At<Support>>>,
    /// Names of joints that are left out: the mesh stays continuous across them.
    #[serde(default)]
    pub continuous: Vec<At<String>>,
    /// Changed keys of materials: the name of a material of the scene and the keys that differ, each with its
    /// whole value. The tables below work alike.
    #[serde(rename = "material", default)]
    pub materials: Vec<ByName>,
    /// Changed keys of parts, such as another damping, by element set.
    #[serde(rename = "part", default)]
    pub parts: Vec<BySet>,
    /// Changed keys of joints, such as another friction, by name.
    #[serde(rename = "joint", default)]
    pub joints: Vec<ByName>,
    /// Changed keys of records, such as another baseline correction or convention, by name.
    #[serde(rename = "record", default)]
    pub records: Vec<ByName>,
    /// Changed keys of bolts, by name.
    #[serde(rename = "bolt", default)]
    pub bolts: Vec<ByName>,
    /// Changed keys of construction stages, by name.
    #[serde(rename = "stage", default)]
    pub stages: Vec<ByName>,
    /// Changed keys of the absorbing boundary, such as its input motion; faces are changed by `faces`.
    pub boundary: Option<Changed>,
    /// Changed keys of the table `time`.
    pub time: Option<Changed>,
}

/// Changed keys of one table of the scene, selected by name.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[schemars(extend("additionalProperties" = true))]
pub struct ByName {
    /// Name of the table of the scene that is changed.
    pub name: At<String>,
}

/// Changed keys of one part of the scene, selected by element set.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[schemars(extend("additionalProperties" = true))]
pub struct BySet {
    /// Element set of the part that is changed.
    pub set: At<String>,
    /// Material of the case, if it is another one.
    pub material: Option<String>,
}

/// Changed keys of a table that a scene has once.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[schemars(extend("additionalProperties" = true))]
pub struct Changed {}

/// Case of a sweep that a scene is.
#[derive(Clone, Debug)]
pub(crate) struct OfCase {
    pub(crate) name: String,
    /// Description of the one parameter that the case varies.
    pub(crate) varies: Option<String>,
    /// Whether the case leaves out joints.
    pub(crate) continuous: bool,
}

impl SceneSpec {
    /// Scene of a case, after the case's changed keys were applied to the tables.
    pub(crate) fn with_case(&self, case: &Case) -> Self {
        let mut file = self.clone();
        file.of_case = Some(OfCase {
            name: case.name.to_string(),
            varies: case.varies.clone(),
            continuous: !case.continuous.is_empty(),
        });
        if let Some(precision) = case.precision {
            file.precision = precision;
        }
        if let Some(mesh) = &case.mesh {
            file.mesh = mesh.clone();
        }
        if let Some(supports) = &case.supports {
            file.supports.clone_from(supports);
        }
        if !case.waves.is_empty() {
            file.waves.clone_from(&case.waves);
        }
        if !case.motions.is_empty() {
            file.motions.clone_from(&case.motions);
        }
        if let Some(ground) = &case.ground {
            file.ground = ground.clone();
        }
        if !case.layers.is_empty() {
            file.layers.clone_from(&case.layers);
        }
        if let Some(stress) = &case.in_situ_stress {
            file.in_situ_stress = Some(stress.clone());
        }
        if let (Some(faces), Some(boundary)) = (&case.faces, &mut file.boundary) {
            boundary.faces.clone_from(faces);
        }
        let kept = |name: &At<String>| !case.continuous.iter().any(|other| **other == **name);
        file.joints.retain(|joint| kept(&joint.name));
        file.output.joints.retain(|history| kept(&history.joint));
        for stage in &mut file.stages {
            stage.tied.retain(kept);
            stage.grouted.retain(kept);
        }
        file
    }
}
