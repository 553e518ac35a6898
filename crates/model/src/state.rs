//! The state of a body, in the user's numbering.

use crate::{JointHistory, Stress, Vec3};

/// One named history variable of one element set.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryField {
    /// The name of the variable.
    pub name: String,
    /// Mesh indices of the elements.
    pub elements: Vec<u32>,
    /// Integration points per element.
    pub points: usize,
    /// Values, the points of an element side by side.
    pub values: Vec<f64>,
}

/// Everything that a stage, a checkpoint or another engine needs to go on, keyed by mesh indices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Time (s).
    pub time: f64,
    /// Steps taken.
    pub step: u64,
    /// Displacement at `time` (m), one per mesh node.
    pub displacement: Vec<Vec3>,
    /// Velocity half a step before `time` (m/s), one per mesh node.
    pub velocity: Vec<Vec3>,
    /// Displacement (m) from which the springs of boundaries are measured, one per mesh node; empty
    /// where it is zero.
    pub spring_origin: Vec<Vec3>,
    /// Mean initial stress per element (Pa); empty where there is none.
    pub initial_stress: Vec<Stress>,
    /// History variables of the laws.
    pub history: Vec<HistoryField>,
    /// What has become of joints.
    pub joints: Vec<JointHistory>,
}

impl State {
    /// A body at rest at time zero.
    pub fn at_rest(nodes: usize) -> Self {
        Self {
            displacement: vec![Vec3::zeros(); nodes],
            velocity: vec![Vec3::zeros(); nodes],
            ..Self::default()
        }
    }
}
