//! What can be said of joints before a run.

use std::collections::HashSet;

use powerhouse::contact::Tied;
use powerhouse::model::{ContactLaw, JointPair};
use powerhouse::{Error, Scene};

use crate::StudyError;
use crate::check::Warning;

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
    /// The shortest edge of its facets (m).
    pub shortest_edge: f64,
}

/// Above this share of the shortest edge a distance of nodes that face each other is doubtful.
const LARGEST_MISMATCH: f64 = 0.05;

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
                shortest_edge: surface.shortest_edge(scene.mesh()),
            })
            .collect()
    }
}

/// Doubts about the joints of a scene: nodes far apart that face each other, and joints that run into
/// absorbing faces, behind which the field knows nothing of them.
pub(crate) fn doubts(scene: &Scene) -> Result<Vec<Warning>, StudyError> {
    let mut warnings = Vec::new();
    let mesh = scene.mesh();
    let mut absorbing = HashSet::new();
    for (_, facets) in scene.absorbing_facets().map_err(Error::from)? {
        absorbing.extend(mesh.nodes_of_facets(facets));
    }
    for (name, surface, law) in scene.joints() {
        let edge = surface.shortest_edge(mesh);
        if surface.worst_gap > LARGEST_MISMATCH * edge {
            warnings.push(Warning::Mismatch {
                joint: name.into(),
                distance: surface.worst_gap,
                nodes: surface.worst_nodes,
                edge,
            });
        }
        let reaches = |pair: &&JointPair| pair.nodes.iter().any(|node| absorbing.contains(node));
        let pairs = surface.pairs.iter().filter(reaches).count();
        // A tie is no joint to a wave.
        if pairs > 0 && law.name() != Tied.name() {
            warnings.push(Warning::JointAtBoundary {
                joint: name.into(),
                pairs,
            });
        }
    }
    Ok(warnings)
}
