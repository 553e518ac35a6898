//! Overview of joints and warnings about them before a run.

use std::collections::HashSet;

use powerhouse::contact::Tied;
use powerhouse::model::{ContactLaw, JointPair};
use powerhouse::{Error, Scene};

use crate::StudyError;
use crate::check::Warning;

/// Geometry and law of a joint in the mesh, before the run.
#[derive(Clone, Debug, PartialEq)]
pub struct JointOverview {
    /// Name of the joint.
    pub name: String,
    /// Name of its contact law.
    pub law: String,
    /// Number of node pairs.
    pub pairs: usize,
    /// Area of the joint (m2), the sum of the areas of its pairs.
    pub area: f64,
    /// Largest distance between the nodes of a pair (m).
    pub worst_gap: f64,
    /// Numbers of the nodes of that pair in the mesh file.
    pub worst_nodes: [u64; 2],
    /// Shortest edge of the facets of the joint (m).
    pub shortest_edge: f64,
}

/// Distance of paired nodes over the shortest edge above which a warning is due.
const LARGEST_MISMATCH: f64 = 0.05;

impl JointOverview {
    /// The overviews of all joints of a scene.
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

/// Warnings about the joints of a scene: node pairs with large distances, and node pairs on absorbing faces, behind
/// which the free field has no joint.
pub(crate) fn warnings(scene: &Scene) -> Result<Vec<Warning>, StudyError> {
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
        // A tie does not disturb a wave.
        if pairs > 0 && law.name() != Tied.name() {
            warnings.push(Warning::JointAtBoundary {
                joint: name.into(),
                pairs,
            });
        }
    }
    Ok(warnings)
}
