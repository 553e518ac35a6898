//! Joints of a scene.

use powerhouse_contact::{Joint, JointSurface};
use powerhouse_model::{ContactLaw, ModelError};

/// A joint of a scene, before it becomes part of a constraint.
pub(crate) struct SceneJoint {
    pub(crate) name: String,
    pub(crate) surface: JointSurface,
    pub(crate) law: Box<dyn ContactLaw>,
}

/// A joint whose law was chosen by name.
type NamedJoint = Joint<Box<dyn ContactLaw>>;

/// Joints that share nodes, and those nodes.
type Group = (Vec<u32>, Vec<NamedJoint>);

/// The sides of a joint, by its name.
pub(crate) type NamedSurface = (String, JointSurface);

/// Constraints of the joints: those that share nodes, directly or by way of others, in one; and the
/// surfaces by the joints' names.
pub(super) fn constraints(
    joints: Vec<SceneJoint>,
) -> Result<(Vec<NamedJoint>, Vec<NamedSurface>), ModelError> {
    let mut groups: Vec<Group> = Vec::new();
    let mut surfaces = Vec::with_capacity(joints.len());
    for SceneJoint { name, surface, law } in joints {
        let mut nodes: Vec<u32> = surface.pairs.iter().flat_map(|pair| pair.nodes).collect();
        let mut members = vec![Joint::new(name.clone(), surface.pairs.clone(), law)?];
        let (touching, apart) = (groups.into_iter()).partition::<Vec<_>, _>(|(others, _)| {
            nodes.iter().any(|node| others.binary_search(node).is_ok())
        });
        groups = apart;
        for (others, joints) in touching.into_iter().rev() {
            nodes.extend(others);
            members.splice(0..0, joints);
        }
        nodes.sort_unstable();
        nodes.dedup();
        groups.push((nodes, members));
        surfaces.push((name, surface));
    }
    let joined = groups.into_iter().map(|(_, members)| Joint::join(members));
    Ok((joined.collect::<Result<_, _>>()?, surfaces))
}
