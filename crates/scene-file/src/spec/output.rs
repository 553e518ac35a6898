//! Output requests of a scene.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, Finite, NonNegative, Parameters, Positive, Zone};

/// Output requests of a run, and the results folder.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// Path of the results folder, relative to the working directory; `results/` followed by the name of the
    /// scene file by default.
    pub directory: Option<PathBuf>,
    /// Sampling interval of histories, relative displacements, section forces, joints and bolts (s), above 0;
    /// 0.005 by default.
    pub every: Option<At<Positive>>,
    /// Accelerations of histories and envelopes; `mean` by default.
    pub acceleration: Option<AccelerationRule>,
    /// Highest frequency of the accelerations of the histories in `accelerations.csv` (Hz), from which peaks, spectra and intensities
    /// are, above 0; 100 by default. A filter of linear phase takes away what is above it.
    pub band: Option<At<Positive>>,
    /// History requests: motion, stress or state variables against time at a point, node, set or element.
    #[serde(rename = "history", default, skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<History>,
    /// Relative displacement requests: histories of the displacement of one point relative to another.
    #[serde(rename = "relative", default, skip_serializing_if = "Vec::is_empty")]
    pub relative: Vec<RelativeDisplacement>,
    /// Section force requests: normal force, shear forces and moments of linings and pillars.
    #[serde(rename = "section", default, skip_serializing_if = "Vec::is_empty")]
    pub sections: Vec<Section>,
    /// Requests for the forces of sections around linings.
    #[serde(rename = "ring", default, skip_serializing_if = "Vec::is_empty")]
    pub rings: Vec<Ring>,
    /// Joint history requests, for joints or zones of them. Contact state, slip, peak opening and energies of
    /// every whole joint are recorded in any case.
    #[serde(rename = "joint", default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<JointHistory>,
    /// Requests of kinds that a program has registered, among the histories; none come with the software.
    #[serde(rename = "own", default, skip_serializing_if = "Vec::is_empty")]
    pub own: Vec<OwnOutput>,
    /// Sampling interval of the energy balance (s), above 0; a hundredth of the duration by default.
    pub energies: Option<At<Positive>>,
    /// Envelope request: greatest values over the run in all nodes and elements; none by default.
    pub envelope: Option<Envelope>,
    /// Snapshot request: fields of the whole body at regular times, for ParaView; none by default.
    pub snapshots: Option<Snapshots>,
}

/// Accelerations of histories and envelopes.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum AccelerationRule {
    /// The mean over the interval around each sample, of envelopes over that before it: the change of the velocity.
    Mean,
    /// The acceleration of the steps around each sample, from which all peaks and spectra are then, too. Where cracks close or bodies
    /// hit each other it jumps from step to step: samples are aliased, and peaks grow with ever finer meshes and steps.
    Instant,
}

/// Request of a kind that a program has registered: its columns are among the histories.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
pub struct OwnOutput {
    /// Name in results; 1 to 100 characters.
    pub name: At<String>,
    /// Kind of the output: its name in the registry.
    pub kind: At<String>,
    /// All other keys of the table: parameters of the kind.
    #[serde(skip_deserializing, flatten)]
    #[schemars(skip)]
    pub parameters: Parameters,
}

/// Recorded field quantity.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Displacement (m).
    Displacement,
    /// Velocity (m/s).
    Velocity,
    /// Acceleration (m/s2).
    Acceleration,
    /// Stress (Pa), tension positive, mean over an element: sum of the stress after the construction stages and
    /// of the dynamic run; in envelopes the greatest and least principal stress. The stress of
    /// stiffness-proportional damping is not contained in it, nor in section forces.
    Stress,
    /// History variables (internal state variables) of the constitutive law, such as plastic strain, damage and
    /// yield state: the mean over an element, of whole numbers such as a yield state what any of its points has; in
    /// envelopes their greatest values.
    State,
}

/// History request: quantities against time at exactly one of `at`, `node`, `set` and `element`.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct History {
    /// Name in results; 1 to 100 characters.
    pub name: At<String>,
    /// Point (m): x, y, z. Motion is interpolated in the element that contains it; stress and state variables
    /// are those of that element.
    pub at: Option<At<[Finite; 3]>>,
    /// Node number in the mesh file; a node has motion only, no stress or state variables.
    pub node: Option<At<u64>>,
    /// Node, facet or element set: mean motion of its nodes; no stress or state variables.
    pub set: Option<At<String>>,
    /// Element number in the mesh file, or in the refined mesh: stress and state variables only, no motion.
    pub element: Option<At<u64>>,
    /// Element set in which the point is located, which selects the side of a joint or interface; all by default.
    pub in_set: Option<At<String>>,
    /// Largest distance by which the point may be moved into an element (m), such as onto the chord of a curved
    /// wall; above 0, 0.001 by default.
    pub within: Option<At<Positive>>,
    /// Whether the stress is that at the point `at` itself, such as the surface of a lining: in bricks of `hex8-natural` the
    /// stress is linear. By default it is the mean over the element.
    pub stress_at_point: Option<At<bool>>,
    /// Recorded quantities; displacement, velocity and acceleration by default, stress for `element`.
    pub quantities: Option<At<Vec<At<Quantity>>>>,
}

/// Relative displacement request: displacement of one location relative to another one, in x, y, z and along the
/// line between them. Each of the two is given by exactly one key.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct RelativeDisplacement {
    /// Name in results; 1 to 100 characters.
    pub name: At<String>,
    /// Point (m) whose displacement is recorded.
    pub at: Option<At<[Finite; 3]>>,
    /// Node, by its number in the mesh file, whose displacement is recorded.
    pub node: Option<At<u64>>,
    /// Set whose mean displacement over its nodes is recorded.
    pub set: Option<At<String>>,
    /// Reference point (m), whose displacement is subtracted.
    pub from: Option<At<[Finite; 3]>>,
    /// Reference node, by its number in the mesh file.
    pub from_node: Option<At<u64>>,
    /// Reference set: the mean displacement of its nodes is subtracted.
    pub from_set: Option<At<String>>,
    /// Largest distance by which points may be moved into an element (m), above 0; 0.001 by default.
    pub within: Option<At<Positive>>,
}

/// Section force request: normal force, shear forces and moments of a plane cut through a lining or pillar.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Name in results; 1 to 100 characters.
    pub name: At<String>,
    /// Element set that the plane cuts.
    pub set: At<String>,
    /// Point of the plane (m): x, y, z.
    pub at: At<[Finite; 3]>,
    /// Normal of the plane, a vector of any length: direction of the normal force, tension positive.
    pub normal: At<[Finite; 3]>,
    /// Direction in the plane, a vector of any length whose normal component is ignored, such as the axis of a tunnel:
    /// forces per metre are divided by the extent along it.
    pub along: At<[Finite; 3]>,
    /// Half the edge length (m) of a cube around `at`, along the axes, outside of which elements are ignored;
    /// unlimited by default. A plane cuts a ring twice: this selects one side.
    pub half_extent: Option<Positive>,
    /// Reinforcement of concrete, by which the moments are compared with those that the section bears with its normal
    /// force; none by default.
    pub reinforcement: Option<At<Reinforcement>>,
}

/// Request for the forces of sections around the lining of a tunnel or cavern: normal to its centre line, at equal angles about an
/// axis. They are sections like any other, named after the ring and their angle, such as `lining-090`, and have a table and a
/// plot in common.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Ring {
    /// Name in results, before the angles of the sections; 1 to 100 characters.
    pub name: At<String>,
    /// Element set of the lining.
    pub set: At<String>,
    /// Point within the lining (m), from which rays go out: x, y, z. The nearest wall is cut where a ray meets several, and
    /// none where it meets none.
    pub centre: At<[Finite; 3]>,
    /// Axis of the tunnel, a vector of any length. The first ray goes upward, along x about a vertical axis; the others turn about
    /// the axis by the right-hand rule.
    pub axis: At<[Finite; 3]>,
    /// Number of rays, 4 to 360; 24 by default.
    pub rays: Option<At<usize>>,
    /// Reinforcement of all sections, by which the moments are compared with those that a section bears with its normal
    /// force; none by default. The side of positive `t` is the inner face.
    pub reinforcement: Option<At<Reinforcement>>,
}

/// Reinforcement of a section of concrete. Strengths are those of the comparison: design values include their factors.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Reinforcement {
    /// Compressive strength of the concrete (Pa), above 0.
    pub concrete_strength: Positive,
    /// Areas of the bars per metre (m2/m), not negative: at the face of negative `t` and at that of positive `t`, the direction
    /// `along x normal`.
    pub bars: [NonNegative; 2],
    /// Distance of the axes of the bars from their face (m), not negative and below half of the section's extent across.
    pub cover: NonNegative,
    /// Yield stress of the bars (Pa), above 0.
    pub yield_stress: Positive,
}

/// Recorded quantity of a joint.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum JointQuantity {
    /// Shares of the area that are sliding, open, and without bond (dimensionless).
    State,
    /// Largest accumulated slip of any node pair (m).
    Slip,
    /// Largest current opening of any node pair (m); negative where all overlap.
    Opening,
    /// Largest opening of any node pair up to the current time (m).
    PeakOpening,
    /// Area means of the normal traction, tension positive, and of the magnitude of the shear traction (Pa).
    Traction,
    /// Energy dissipated by friction up to the current time (J).
    Friction,
    /// Energy dissipated by bond failure up to the current time (J).
    Bond,
    /// Kinetic energy lost by impact of the two sides up to the current time (J).
    Impact,
    /// Means over the area of the history variables of the joint's law, by their names.
    History,
}

/// Joint history request: quantities against time of a joint, or of the node pairs selected by one of `at`,
/// `node`, `set` and `low` with `high`.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct JointHistory {
    /// Name in results; 1 to 100 characters.
    pub name: At<String>,
    /// Name of the joint.
    pub joint: At<String>,
    /// Point (m): selects the pairs of the nearest node.
    pub at: Option<At<[Finite; 3]>>,
    /// Largest distance of that node from the point (m), above 0; 0.001 by default.
    pub within: Option<At<Positive>>,
    /// Node number in the mesh file: selects the pairs of this node.
    pub node: Option<At<u64>>,
    /// Node, facet or element set: selects the pairs with a node in it.
    pub set: Option<At<String>>,
    /// Lowest corner of a box (m): selects the pairs in it, or on its faces; with `high`.
    pub low: Option<At<[Finite; 3]>>,
    /// Highest corner of the box (m); with `low`.
    pub high: Option<At<[Finite; 3]>>,
    /// Recorded quantities; all by default.
    pub quantities: Option<At<Vec<At<JointQuantity>>>>,
}

impl JointHistory {
    /// Zone of the selected node pairs; `None` for the whole joint.
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

/// Envelope request: greatest values of quantities over the run, with the times at which they occur.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Envelope {
    /// Recorded quantities; displacement, velocity and acceleration by default.
    pub quantities: Option<At<Vec<At<Quantity>>>>,
    /// Element sets whose elements and nodes are recorded; all parts by default.
    pub sets: Option<Vec<At<String>>>,
    /// Sampling interval (s), above 0; 0.005 by default.
    pub every: Option<At<Positive>>,
}

/// Snapshot request: fields of the whole body at regular times.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Snapshots {
    /// Interval between snapshots (s), above 0.
    pub every: At<Positive>,
    /// Recorded quantities; displacement and velocity by default.
    pub quantities: Option<At<Vec<At<Quantity>>>>,
}
