//! What a scene says of the water beside and in its joints.

use core::fmt;
use std::collections::HashSet;

use super::{SceneJoint, WaterInJoints};
use crate::joints::sliding_friction;
use crate::remark::{Kind, described};
use crate::stage::WaterAtRest;
use crate::{Error, Scene, Topic};

/// Pressure of the water in a joint at the start of the run, or, a warning, in the pores of the ground beside a joint without water.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum WetJoint {
    /// Fact: water in a joint.
    Within {
        /// Name of the joint.
        joint: String,
        /// Least and greatest pressure at its pairs (Pa).
        pressures: [f64; 2],
    },
    /// Warning: a joint without water in ground with water in its pores.
    Beside {
        /// Name of the joint.
        joint: String,
        /// Greatest pressure in an element at the joint (Pa).
        pressure: f64,
        /// Increase of its sliding strength with its pressure (1).
        friction: f64,
    },
}

described!(WetJoint, |joint| {
    let beside = matches!(joint, WetJoint::Beside { .. });
    Kind::warning_if(beside, Topic::Joints)
});

impl fmt::Display for WetJoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Within {
                joint,
                pressures: [least, greatest],
            } => write!(
                f,
                "water in joint '{joint}': {least:.3e} to {greatest:.3e} Pa, in all of the run; tractions of the joint are effective ones, total traction plus this pressure"
            ),
            Self::Beside {
                joint,
                pressure,
                friction,
            } => write!(
                f,
                "joint '{joint}' has no `water`, and the ground beside it has up to {pressure:.3e} Pa in its pores: the joint bears total stress, so that it slides at up to {:.3e} Pa (friction {friction:.2} times the pressure) more than it should, and opens later; give the joint `water`, with the level of the ground",
                friction * pressure
            ),
        }
    }
}

impl Scene {
    /// Remarks about the water in joints, and about that beside dry joints that may slide or open.
    pub(crate) fn wet_joints(
        &self,
        in_joints: &WaterInJoints,
        in_pores: Option<&WaterAtRest>,
    ) -> Result<Vec<WetJoint>, Error> {
        let mut found = Vec::new();
        for (index, joint) in self.joints.iter().enumerate() {
            let pressures = in_joints.of_joint(index);
            if joint.water.is_some() {
                let least = pressures.iter().copied().fold(f64::INFINITY, f64::min);
                let greatest = pressures.iter().copied().fold(0.0, f64::max);
                found.push(WetJoint::Within {
                    joint: joint.name.clone(),
                    pressures: [least, greatest],
                });
                continue;
            }
            let friction = sliding_friction(joint.law.as_ref());
            // A law that never slides is a tie.
            if friction.is_nan() || joint.law.bears_tension() {
                continue;
            }
            let pressure = self.pressure_beside(joint, in_pores);
            if pressure > 0.0 {
                found.push(WetJoint::Beside {
                    joint: joint.name.clone(),
                    pressure,
                    friction,
                });
            }
        }
        Ok(found)
    }

    /// Greatest pressure at rest (Pa) of the water in the pores of the elements at a joint.
    fn pressure_beside(&self, joint: &SceneJoint, water: Option<&WaterAtRest>) -> f64 {
        let nodes: HashSet<u32> = (joint.surface.pairs.iter())
            .flat_map(|pair| pair.nodes)
            .collect();
        let mut greatest = 0.0_f64;
        for part in &self.parts {
            if part.material.pore_water().is_none() {
                continue;
            }
            let material = match water {
                Some(water) => water.of(part.material.clone()),
                None => part.material.clone(),
            };
            for &element in self.mesh.element_set(&part.set).unwrap_or_default() {
                if self
                    .mesh
                    .nodes_of(element)
                    .iter()
                    .any(|n| nodes.contains(n))
                {
                    let height = self.mesh.centroid(element).z;
                    let pressure = material.law().pore_pressure(element, height);
                    greatest = greatest.max(pressure);
                }
            }
        }
        greatest
    }
}
