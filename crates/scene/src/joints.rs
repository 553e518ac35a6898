//! Constraints of the joints of a scene.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use powerhouse_contact::Joint;
use powerhouse_elements::{BoltSegment, BoltSet};
use powerhouse_model::{ContactLaw, ElasticMedium, JointInput, PeriodicPairs, Vec3};

use crate::joint::{Closing, NamedJoint, NamedSurface, WaterInJoints};
use crate::{Error, Part, Remark, Scene, SceneBolts, SceneJoint, remark};
use powerhouse_laws::Damping;

/// Group of joints with common nodes, and their nodes.
type Group = (Vec<u32>, Vec<NamedJoint>);

impl Scene {
    /// Constraints of the joints, one for each group of joints with common nodes, directly or through others, and
    /// the joint surfaces by name, with the water in them.
    pub(crate) fn constraints_of_joints(
        &self,
        closing: impl Fn(&str) -> Closing,
        water: &WaterInJoints,
    ) -> Result<(Vec<NamedJoint>, Vec<NamedSurface>), Error> {
        let mut groups: Vec<Group> = Vec::new();
        let mut surfaces = Vec::with_capacity(self.joints.len());
        let leads = PeriodicPairs::leads(self.periodic.iter().chain(&self.delayed));
        for (index, joint) in self.joints.iter().enumerate() {
            let law = self.law_of_joint(joint)?;
            let own = (closing(&joint.name), law);
            let pressures = water.of_joint(index);
            let (joint, surface) = joint.build(&self.mesh, &leads, own, pressures)?;
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
        let mut media: [Option<ElasticMedium>; 2] = [None; 2];
        for (side, part) in self.parts_beside(joint)? {
            let medium = self.parts[part].material.medium();
            let softest = media[side].get_or_insert(medium);
            if medium.young < softest.young {
                *softest = medium;
            }
        }
        Ok(match media {
            [Some(first), Some(second)] => joint.law.between([&first, &second]),
            _ => None,
        }
        .unwrap_or_else(|| joint.law.clone()))
    }

    /// Sides of a joint (0 or 1) and the parts with elements at their nodes.
    fn parts_beside(&self, joint: &SceneJoint) -> Result<BTreeSet<(usize, usize)>, Error> {
        let mut side_of = HashMap::new();
        for pair in &joint.surface.pairs {
            side_of.extend(pair.nodes.into_iter().zip(0..));
        }
        let mut beside = BTreeSet::new();
        for (element, part) in (0..).zip(self.part_of_elements()?) {
            let Some(part) = part else { continue };
            let nodes = self.mesh.nodes_of(element).iter();
            let sides = nodes.filter_map(|node| side_of.get(node).copied());
            beside.extend(sides.map(|side| (side, part)));
        }
        Ok(beside)
    }

    /// Joints that slide with friction beside parts whose high frequencies are not damped.
    pub(crate) fn undamped_friction(&self) -> Result<Vec<Remark>, Error> {
        let is_undamped = |damping: &Damping| match damping {
            Damping::Flat { .. } => false,
            _ => damping.rayleigh().stiffness == 0.0,
        };
        let is_undamped = |part: &&Part| part.high == 0.0 && is_undamped(&part.damping);
        let mut remarks = Vec::new();
        for joint in &self.joints {
            let friction = sliding_friction(&*self.law_of_joint(joint)?);
            // Flutter is too slow to matter below.
            if friction.is_nan() || friction < 0.3 {
                continue;
            }
            let beside = self.parts_beside(joint)?.into_iter().map(|(_, part)| part);
            let beside: BTreeSet<usize> = beside.collect();
            let undamped = beside.into_iter().map(|part| &self.parts[part]);
            let undamped = undamped.filter(is_undamped);
            let sets: Vec<String> = undamped.map(|part| part.set.clone()).collect();
            if !sets.is_empty() {
                remarks.push(Remark::from(remark::UndampedFriction {
                    joint: joint.name.clone(),
                    friction,
                    sets,
                }));
            }
        }
        Ok(remarks)
    }

    /// Joints that bolts without grout cross: nodes of two elements one after the other along a bolt are a pair of the joint.
    pub(crate) fn cut_bolts(&self, bolts: &BoltSet) -> Vec<Remark> {
        let is_own = |own: &&SceneBolts| own.name == bolts.name();
        let grouted = |own: &SceneBolts| own.parameters.grout.is_some();
        if self.bolts.iter().find(is_own).is_some_and(grouted) {
            return Vec::new();
        }
        let may_move = self.joints.iter().filter(|j| !j.law.bears_tension());
        let remarks = may_move.filter_map(|joint| {
            let pairs = joint.surface.pairs.iter().map(|pair| pair.nodes);
            let pairs: BTreeSet<[u32; 2]> = pairs.flat_map(|[a, b]| [[a, b], [b, a]]).collect();
            let nodes = |segment: BoltSegment| self.mesh.nodes_of(segment.element);
            let crosses = |bolt: &usize| {
                let (these, next) = (bolts.segments(*bolt), bolts.segments(*bolt).skip(1));
                these.zip(next).any(|(this, next)| {
                    let of = |a: u32| nodes(next).iter().any(|&b| pairs.contains(&[a, b]));
                    nodes(this).iter().any(|&a| of(a))
                })
            };
            let crossing = (0..bolts.len()).filter(crosses).count();
            (crossing > 0).then(|| {
                Remark::from(remark::CutBolts {
                    bolts: bolts.name().into(),
                    joint: joint.name.clone(),
                    crossing,
                })
            })
        });
        remarks.collect()
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
                remarks.push(Remark::from(remark::ReducedStrength {
                    joint: joint.name.clone(),
                    factor,
                    area,
                    of: joint.surface.area(),
                }));
            }
        }
        Ok(remarks)
    }
}

/// Increase of the strength of a sliding pair with its pressure (1), at rest without a bond; not a number for a law that never
/// slides.
pub(crate) fn sliding_friction(law: &dyn ContactLaw) -> f64 {
    let mut history = vec![0.0; law.history().len()];
    law.initial_history(&mut history);
    let state = law.initial();
    let strength = |pressure: f64| {
        let input = JointInput::new(Vec3::new(-pressure, 0.0, 0.0), &state);
        law.sliding_strength(-pressure, &input.with_history(&history))
    };
    (strength(2.0e6) - strength(1.0e6)) / 1.0e6
}
