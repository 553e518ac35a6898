//! Water in the joints of a scene: its pressure from stage to stage, and its load on both sides.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use powerhouse_elements::WaterPressure;
use powerhouse_model::{JointPair, Mesh, NodalLoad, Vec3};

use super::{InitialGap, SceneJoint};
use crate::stage::elements_of_level;
use crate::{Scene, SceneStage, StagingError};

/// Water in a joint: its pressure acts on both sides, whether they touch or not, and the contact law sees effective tractions, total
/// traction plus pressure along the normal.
///
/// The pressure is that of the start, or of the last stage that set one, and does not change in the run.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct JointWater {
    /// Pressure by height at the start; none: no pressure until a stage sets a level.
    pub at_rest: Option<WaterPressure>,
}

impl JointWater {
    /// Water with a pressure by height at the start.
    pub fn new(at_rest: WaterPressure) -> Self {
        Self {
            at_rest: Some(at_rest),
        }
    }
}

impl SceneJoint {
    /// Pressures (Pa) of the water of the start at its pairs; empty in a dry joint.
    pub(super) fn pressures_at_start(&self, mesh: &Mesh) -> Result<Vec<f64>, StagingError> {
        let at_rest = self.water.as_ref().map(|water| water.at_rest.as_ref());
        let of = |pair: &JointPair| match at_rest.flatten() {
            Some(pressure) => self.pressure_at(pressure, height(mesh, pair)),
            None => Ok(0.0),
        };
        match at_rest {
            Some(_) => self.surface.pairs.iter().map(of).collect(),
            None => Ok(Vec::new()),
        }
    }

    fn pressure_at(&self, pressure: &WaterPressure, height: f64) -> Result<f64, StagingError> {
        let [low, high] = pressure.range();
        if (low..=high).contains(&height) {
            return Ok(pressure.pressure(height));
        }
        Err(StagingError::JointBeyondTable {
            joint: self.name.clone(),
            height,
            range: [low, high],
        })
    }
}

/// Height z of a pair (m).
fn height(mesh: &Mesh, pair: &JointPair) -> f64 {
    mesh.positions()[pair.nodes[0] as usize].z
}

/// Pressures (Pa) of the water at the pairs of each joint of a scene; an empty list for a dry one.
#[derive(Clone, Debug, Default)]
pub(crate) struct WaterInJoints(Vec<Arc<[f64]>>);

impl WaterInJoints {
    /// The water at the start.
    pub(crate) fn of(scene: &Scene) -> Result<Self, StagingError> {
        let joints = scene.joints.iter();
        let of = |joint: &SceneJoint| Ok(joint.pressures_at_start(&scene.mesh)?.into());
        joints.map(of).collect::<Result<_, _>>().map(Self)
    }

    /// Pressures at the pairs of a joint, by its index in the scene; empty in a dry one.
    pub(crate) fn of_joint(&self, joint: usize) -> &[f64] {
        self.0.get(joint).map_or(&[], |pressures| pressures)
    }

    /// Whether there is no water in any joint.
    pub(crate) fn is_dry(&self) -> bool {
        self.0.iter().all(|pressures| pressures.is_empty())
    }

    /// Takes the levels of a stage: that of a set for the pairs with a node of its elements, that of no set for all others. Returns
    /// which levels are those of a pair, in the order of the stage.
    pub(crate) fn advance(
        &mut self,
        scene: &Scene,
        stage: &SceneStage,
    ) -> Result<Vec<bool>, StagingError> {
        let mesh = &*scene.mesh;
        let mut found = vec![false; stage.water.len()];
        for (joint, pressures) in scene.joints.iter().zip(&mut self.0) {
            if pressures.is_empty() || stage.water.is_empty() {
                continue;
            }
            let pairs = &joint.surface.pairs;
            let mut new: Vec<Option<f64>> = vec![None; pairs.len()];
            for (level, found) in stage.water.iter().zip(&mut found) {
                let Some(set) = &level.set else {
                    continue;
                };
                let elements = elements_of_level(mesh, set)?;
                let nodes: HashSet<u32> = mesh.nodes_of_elements(elements).into_iter().collect();
                for (pair, new) in pairs.iter().zip(&mut new) {
                    if !pair.nodes.iter().any(|node| nodes.contains(node)) {
                        continue;
                    }
                    *found = true;
                    let pressure = joint.pressure_at(&level.pressure, height(mesh, pair))?;
                    if new.replace(pressure).is_some_and(|other| other != pressure) {
                        let (joint, set) = (joint.name.clone(), set.clone());
                        return Err(StagingError::TwoLevelsOfJoint { joint, set });
                    }
                }
            }
            let everywhere = stage.water.iter().zip(&mut found);
            for (level, found) in everywhere.filter(|(level, _)| level.set.is_none()) {
                *found = true;
                for (pair, new) in pairs.iter().zip(&mut new).filter(|(_, new)| new.is_none()) {
                    *new = Some(joint.pressure_at(&level.pressure, height(mesh, pair))?);
                }
            }
            let renewed = pressures.iter().zip(new);
            *pressures = renewed.map(|(old, new)| new.unwrap_or(*old)).collect();
        }
        Ok(found)
    }

    /// Loads of the water on the sides of the joints whose pairs have elements on both.
    pub(crate) fn loads(&self, scene: &Scene, present: &[bool]) -> Vec<JointWaterLoad> {
        if self.is_dry() {
            return Vec::new();
        }
        let mesh = &*scene.mesh;
        let mut is_there = vec![false; mesh.node_count()];
        for (element, _) in (0..).zip(present).filter(|(_, present)| **present) {
            for &node in mesh.nodes_of(element) {
                is_there[node as usize] = true;
            }
        }
        let mut loads = Vec::new();
        for (joint, pressures) in scene.joints.iter().zip(&self.0) {
            let mut forces = BTreeMap::<u32, Vec3>::new();
            for (pair, pressure) in joint.surface.pairs.iter().zip(pressures.iter()) {
                let both = pair.nodes.iter().all(|&node| is_there[node as usize]);
                if *pressure == 0.0 || !both {
                    continue;
                }
                let force = pair.normal * (pressure * pair.projected_area);
                let [first, second] = pair.nodes;
                *forces.entry(first).or_default() -= force;
                *forces.entry(second).or_default() += force;
            }
            if !forces.is_empty() {
                loads.push(JointWaterLoad {
                    name: format!("water in joint {}", joint.name),
                    nodes: forces.keys().copied().collect(),
                    forces: forces.into_values().collect(),
                });
            }
        }
        loads
    }

    /// The first joint that would be open from the start: with a pressure at closed pairs and without a preload.
    pub(crate) fn unloaded<'s>(&self, scene: &'s Scene) -> Option<&'s SceneJoint> {
        let mut joints = scene.joints.iter().zip(&self.0);
        let found = joints.find(|(joint, pressures)| {
            let is_closed = joint.gap == InitialGap::Closed && joint.preload.is_none();
            is_closed && pressures.iter().any(|pressure| *pressure > 0.0)
        });
        found.map(|(joint, _)| joint)
    }
}

/// Constant load of the water in a joint: its pressure pushes the two sides apart.
#[derive(Clone, Debug)]
pub(crate) struct JointWaterLoad {
    name: String,
    nodes: Vec<u32>,
    forces: Vec<Vec3>,
}

impl NodalLoad for JointWaterLoad {
    fn name(&self) -> &str {
        &self.name
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, _time: f64, forces: &mut [Vec3]) {
        for (total, own) in forces.iter_mut().zip(&self.forces) {
            *total += own;
        }
    }
    fn is_constant(&self) -> bool {
        true
    }
}
