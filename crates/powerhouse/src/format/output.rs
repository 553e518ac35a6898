//! What a run writes.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Finite, Positive, Zone};

/// What is written, and where.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// The folder, relative to the working directory; `results/` and the scene file's name by
    /// default.
    pub directory: Option<PathBuf>,
    /// Time between samples of histories, relative displacements and section forces (s); 0.005 by
    /// default.
    pub every: Option<At<Positive>>,
    /// Histories at points.
    #[serde(rename = "history", default)]
    pub histories: Vec<History>,
    /// Histories of the displacement of one point relative to another.
    #[serde(rename = "relative", default)]
    pub relative: Vec<RelativeDisplacement>,
    /// Section forces of linings and pillars.
    #[serde(rename = "section", default)]
    pub sections: Vec<Section>,
    /// Histories of joints or parts of them; state, slip, peak opening and energies of every joint as
    /// a whole are recorded anyway.
    #[serde(rename = "joint", default)]
    pub joints: Vec<JointHistory>,
    /// Time between looks at the energies (s); a hundredth of the duration by default.
    pub energies: Option<At<Positive>>,
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
    /// Stress (Pa), mean over an element: that of the motion, and of what stages left before it; in
    /// envelopes the greatest and least principal stress. The stress of stiffness-proportional damping is
    /// not in it, nor in section forces.
    Stress,
    /// The history variables of the material's law, such as plastic strains, damage, damage type and yield
    /// state; of elements and, as the greatest values, in envelopes.
    State,
}

/// Histories at a place: exactly one of `at`, `node`, `set` and `element`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct History {
    /// The name in results.
    pub name: At<String>,
    /// A point (m); motion is interpolated in the element around it, stress is that of the
    /// element.
    pub at: Option<At<[Finite; 3]>>,
    /// A node by its number in the mesh file; it has neither stress nor state.
    pub node: Option<At<u64>>,
    /// A node, facet or element set: the mean over its nodes; it has neither
    /// stress nor state.
    pub set: Option<At<String>>,
    /// An element by its number in the mesh file, or in the refined mesh; it has stress and state alone.
    pub element: Option<At<u64>>,
    /// The element set in which the point lies, which decides the side of a joint or interface.
    pub among: Option<At<String>>,
    /// How far the point may be moved to lie in an element (m), such as onto the chord of a round
    /// wall; 0.001 by default.
    pub within: Option<At<Positive>>,
    /// What is recorded; displacement, velocity and acceleration by default, the stress of an
    /// element.
    pub quantities: Option<At<Vec<At<Quantity>>>>,
}

/// The displacement of a place relative to another one, in x, y, z and along the line between
/// them. Each of the two is given by exactly one key.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelativeDisplacement {
    /// The name in results.
    pub name: At<String>,
    /// The place by a point (m).
    pub at: Option<At<[Finite; 3]>>,
    /// The place by a node's number in the mesh file.
    pub node: Option<At<u64>>,
    /// The place by a set: the mean over its nodes.
    pub set: Option<At<String>>,
    /// The point to which its displacement is relative (m).
    pub from: Option<At<[Finite; 3]>>,
    /// The node to which it is relative.
    pub from_node: Option<At<u64>>,
    /// The set to whose mean it is relative.
    pub from_set: Option<At<String>>,
    /// How far points may be moved to lie in an element (m); 0.001 by default.
    pub within: Option<At<Positive>>,
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
    /// Only elements in the cube of which `at` is the centre and this half the edge, along the axes,
    /// belong to the cut (m); all by default. A plane cuts a ring twice: this picks one side.
    pub reach: Option<Positive>,
}

/// What is recorded of a joint.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum JointQuantity {
    /// Shares of the area that slide, are open, and whose bond has broken.
    State,
    /// The largest accumulated slip of any pair (m).
    Slip,
    /// The largest opening of any pair at the time (m), negative where all overlap.
    Opening,
    /// The largest opening of any pair so far (m).
    PeakOpening,
    /// Means over the area of normal traction, tension positive, and of the size of shear traction
    /// (Pa).
    Traction,
    /// Dissipated by friction so far (J).
    Friction,
    /// Dissipated where bonds broke (J).
    Bond,
    /// Lost where sides met (J).
    Impact,
    /// Means over the area of the history variables of the joint's law, by their names.
    History,
}

/// Histories of a joint, or of the pairs that at most one of `at`, `node`, `set` and `low` with `high`
/// picks.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointHistory {
    /// The name in results.
    pub name: At<String>,
    /// The joint's name.
    pub joint: At<String>,
    /// A point (m): the pairs at the node that is nearest to it.
    pub at: Option<At<[Finite; 3]>>,
    /// How far from the point that node may be (m); 0.001 by default.
    pub within: Option<At<Positive>>,
    /// A node by its number in the mesh file.
    pub node: Option<At<u64>>,
    /// A node, facet or element set: the pairs with a node in it.
    pub set: Option<At<String>>,
    /// The lowest corner of a box (m): the pairs in it, or on its faces.
    pub low: Option<At<[Finite; 3]>>,
    /// The highest corner of the box (m).
    pub high: Option<At<[Finite; 3]>>,
    /// What is recorded; everything by default.
    pub quantities: Option<At<Vec<At<JointQuantity>>>>,
}

impl JointHistory {
    /// The pairs that it picks; none if all of them.
    pub fn zone(&self) -> Option<Zone> {
        let zone = Zone {
            at: self.at.clone(),
            within: self.within.clone(),
            node: self.node.clone(),
            set: self.set.clone(),
            low: self.low.clone(),
            high: self.high.clone(),
        };
        (!zone.is_empty()).then_some(zone)
    }
}

/// Greatest values over the run, with their times.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Envelope {
    /// What is tracked; displacement, velocity and acceleration by default.
    pub quantities: Option<At<Vec<At<Quantity>>>>,
    /// Element sets on which it is tracked; all parts by default.
    pub sets: Option<Vec<At<String>>>,
    /// Time between looks (s); 0.005 by default.
    pub every: Option<At<Positive>>,
}

/// Pictures of the whole body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Snapshots {
    /// Time between them (s).
    pub every: At<Positive>,
    /// What they hold; displacement and velocity by default.
    pub quantities: Option<At<Vec<At<Quantity>>>>,
}
