//! Constraints of the joints of a scene.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use powerhouse_contact::Joint;
use powerhouse_model::{ContactLaw, ElasticMedium, PeriodicPairs};

use super::Scene;
use crate::joint::{Closing, NamedJoint, NamedSurface};
use crate::{Error, Remark, SceneJoint};

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
            let law = self.law_of_joint(joint)?;
            let own = (closing(&joint.name), law);
            let (joint, surface) = joint.build(&self.mesh, &leads, own)?;
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

    /// The law of a joint between the media of its sides: where a side has several, the softest.
    fn law_of_joint(&self, joint: &SceneJoint) -> Result<Arc<dyn ContactLaw>, Error> {
        let some = ElasticMedium::new(1.0, 0.0, 1.0)?;
        if joint.law.between([&some, &some]).is_none() {
            return Ok(joint.law.clone());
        }
        let mut side_of = HashMap::new();
        for pair in &joint.surface.pairs {
            let sides = pair.nodes.into_iter().zip(0..);
            side_of.extend(sides);
        }
        let mut media: [Option<ElasticMedium>; 2] = [None; 2];
        for (element, part) in (0..).zip(self.part_of_elements()?) {
            let Some(part) = part else { continue };
            let nodes = self.mesh.nodes_of(element).iter();
            let sides: HashSet<usize> = nodes
                .filter_map(|node| side_of.get(node).copied())
                .collect();
            let medium = self.parts[part].material.medium();
            for side in sides {
                let softest = media[side].get_or_insert(medium);
                if medium.young < softest.young {
                    *softest = medium;
                }
            }
        }
        Ok(match media {
            [Some(first), Some(second)] => joint.law.between([&first, &second]),
            _ => None,
        }
        .unwrap_or_else(|| joint.law.clone()))
    }

    /// Joints whose strength is reduced where the mesh does not resolve the failure of their bonds.
    pub(crate) fn reduced_joints(&self) -> Result<Vec<Remark>, Error> {
        let mut remarks = Vec::new();
        for joint in &self.joints {
            let law = self.law_of_joint(joint)?;
            let (mut factor, mut area) = (1.0_f64, 0.0);
            for pair in &joint.surface.pairs {
                let own = law.strength_factor(pair.spacing);
                factor = factor.min(own);
                area += if own < 1.0 { pair.area } else { 0.0 };
            }
            if area > 0.0 {
                remarks.push(Remark::ReducedStrength {
                    joint: joint.name.clone(),
                    factor,
                    area,
                    of: joint.surface.area(),
                });
            }
        }
        Ok(remarks)
    }
}
