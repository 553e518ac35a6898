//! Constraints of the joints of a scene.

use powerhouse_contact::Joint;
use powerhouse_model::PeriodicPairs;

use super::Scene;
use crate::Error;
use crate::joint::{Closing, NamedJoint, NamedSurface};

/// Group of joints with common nodes, and their nodes.
type Group = (Vec<u32>, Vec<NamedJoint>);

impl Scene {
    /// Constraints of the joints, one for each group of joints with common nodes, directly or through others, and
    /// the joint surfaces by name.
    pub(crate) fn constraints_of_joints(
        &self,
        closing: impl Fn(&str) -> Closing,
    ) -> Result<(Vec<NamedJoint>, Vec<NamedSurface>), Error> {
        let mut groups: Vec<Group> = Vec::new();
        let mut surfaces = Vec::with_capacity(self.joints.len());
        let leads = PeriodicPairs::leads(&self.periodic);
        for joint in &self.joints {
            let (joint, surface) = joint.build(&self.mesh, &leads, closing(&joint.name))?;
            let mut nodes: Vec<u32> = surface.1.pairs.iter().flat_map(|pair| pair.nodes).collect();
            let mut members = vec![joint];
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
            surfaces.push(surface);
        }
        let joined = groups.into_iter().map(|(_, members)| Joint::join(members));
        let joined = joined.collect::<Result<_, _>>()?;
        Ok((joined, surfaces))
    }
}
