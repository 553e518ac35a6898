//! What can be said of joints before a run.

use powerhouse::Scene;

/// A joint as it stands in the mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct JointOverview {
    /// Its name.
    pub name: String,
    /// The name of its law.
    pub law: String,
    /// How many pairs it has.
    pub pairs: usize,
    /// Their area (m2).
    pub area: f64,
    /// The largest distance between the nodes of a pair (m).
    pub worst_gap: f64,
    /// The numbers of those nodes.
    pub worst_nodes: [u64; 2],
}

impl JointOverview {
    /// All joints of a scene.
    pub(crate) fn all(scene: &Scene) -> Vec<Self> {
        let joints = scene.joints();
        joints
            .map(|(name, surface, law)| Self {
                name: name.into(),
                law: law.name().into(),
                pairs: surface.pairs.len(),
                area: surface.area(),
                worst_gap: surface.worst_gap,
                worst_nodes: surface.worst_nodes,
            })
            .collect()
    }
}
