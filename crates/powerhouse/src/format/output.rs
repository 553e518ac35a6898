//! What a run writes.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Finite, Positive};

/// What is written, and where.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// The folder, relative to the working directory; `results/` and the scene file's name by
    /// default.
    pub directory: Option<PathBuf>,
    /// Time between samples of histories, relative displacements and section forces (s); 0.005 by
    /// default.
    pub every: Option<Positive>,
    /// Histories at points.
    #[serde(rename = "history", default)]
    pub histories: Vec<History>,
    /// Histories of the displacement of one point relative to another.
    #[serde(rename = "relative", default)]
    pub relative: Vec<RelativeDisplacement>,
    /// Section forces of linings and pillars.
    #[serde(rename = "section", default)]
    pub sections: Vec<Section>,
    /// Time between looks at the energies (s); a hundredth of the duration by default.
    pub energies: Option<Positive>,
    /// Greatest values over the run, everywhere.
    pub envelope: Option<Envelope>,
    /// Pictures of the whole body for ParaView.
    pub snapshots: Option<Snapshots>,
}

/// What is recorded.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Displacement (m).
    Displacement,
    /// Velocity (m/s).
    Velocity,
    /// Acceleration (m/s2).
    Acceleration,
    /// Change of stress (Pa), mean over an element; in envelopes the greatest and least principal
    /// stress.
    Stress,
}

/// Histories at a place: exactly one of `at`, `node` and `set`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct History {
    /// The name in results.
    pub name: At<String>,
    /// A point (m); motion is interpolated in the element around it, stress is that of the
    /// element.
    pub at: Option<At<[Finite; 3]>>,
    /// A node by its number in the mesh file; it has no stress.
    pub node: Option<At<u64>>,
    /// A node or facet set: the mean over its nodes; it has no stress.
    pub set: Option<At<String>>,
    /// What is recorded; displacement, velocity and acceleration by default.
    #[serde(default = "motion")]
    pub quantities: Vec<Quantity>,
}

fn motion() -> Vec<Quantity> {
    vec![
        Quantity::Displacement,
        Quantity::Velocity,
        Quantity::Acceleration,
    ]
}

/// The displacement of a point relative to another one, in x, y, z and along the line between
/// them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelativeDisplacement {
    /// The name in results.
    pub name: At<String>,
    /// The point (m).
    pub at: At<[Finite; 3]>,
    /// The point to which its displacement is relative (m).
    pub from: At<[Finite; 3]>,
}

/// Forces in a plane cut through a lining or pillar.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// The name in results.
    pub name: At<String>,
    /// The element set that is cut.
    pub set: At<String>,
    /// A point of the plane (m).
    pub at: At<[Finite; 3]>,
    /// Normal of the plane, of any length: the direction of the normal force.
    pub normal: At<[Finite; 3]>,
    /// A direction in the plane, such as the axis of a tunnel.
    pub along: At<[Finite; 3]>,
    /// Only elements within this distance of `at` belong to the cut (m); all by default. A plane
    /// cuts a ring twice: this picks one side.
    pub reach: Option<Positive>,
}

/// Greatest values over the run, with their times.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Envelope {
    /// What is tracked; displacement, velocity and acceleration by default.
    #[serde(default = "motion")]
    pub quantities: Vec<Quantity>,
    /// Element sets on which it is tracked; all parts by default.
    pub sets: Option<Vec<At<String>>>,
    /// Time between looks (s); 0.005 by default.
    pub every: Option<Positive>,
}

/// Pictures of the whole body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Snapshots {
    /// Time between them (s).
    pub every: Positive,
    /// What they hold; displacement and velocity by default.
    #[serde(default = "picture")]
    pub quantities: Vec<Quantity>,
}

fn picture() -> Vec<Quantity> {
    vec![Quantity::Displacement, Quantity::Velocity]
}
