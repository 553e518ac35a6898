//! Joints: geometry, initial state and contact law.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, Finite, GroundWater, NonNegative, Parameters, Positive};
use powerhouse_model::keys::words_or_number;

/// Joint: two facing surfaces of the mesh with their initial state and the contact law of their tractions.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
pub struct JointSection {
    /// Name of the joint in results.
    pub name: At<String>,
    /// Two element sets that share nodes: the nodes of their common facets are doubled. A joint has either
    /// this or `facets`.
    pub between: Option<At<[String; 2]>>,
    /// Two facet sets that face each other, of a mesh whose nodes are doubled there already.
    pub facets: Option<At<[String; 2]>>,
    /// Largest distance between two nodes that are paired (m), above 0; by default a millionth of the mesh's
    /// diagonal.
    pub tolerance: Option<Positive>,
    /// Largest angle between the normals of facets of one smooth patch (degrees), above 0, 40 by default. Nodes
    /// on a sharper edge have one pair for each patch.
    pub corner: Option<At<Positive>>,
    /// Preload: initial traction on the joint in the reference configuration; none by default. The law is
    /// evaluated with the sum of it and the traction of the motion, and must admit it.
    pub preload: Option<At<Preload>>,
    /// Water in the joint: its pressure acts on both sides, and the law bears effective tractions. `water = {}` has no pressure until a
    /// stage sets a level.
    pub water: Option<At<GroundWater>>,
    /// Initial gap between the two sides along the normal (m), 0 by default, or `"meshed"`: the distance of the
    /// nodes in the mesh. A node pair with a gap has neither bond nor preload.
    pub gap: Option<At<Gap>>,
    /// Zones that start without bond, such as an existing crack; none by default.
    pub unbonded: Option<Vec<At<Zone>>>,
    /// Contact law: its name in the registry, such as `bonded-coulomb`.
    pub law: At<String>,
    /// All other keys of the table: parameters of the contact law.
    #[serde(skip_deserializing, flatten)]
    #[schemars(skip)]
    pub parameters: Parameters,
}

/// Preload: initial traction on a joint in the reference configuration.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Preload {
    /// Uniform normal pressure.
    Pressure {
        /// Normal pressure (Pa), compression positive.
        pressure: Finite,
    },
    /// Uniform traction vector.
    Traction {
        /// Traction vector on the side of the joint's first set (Pa): x, y, z.
        traction: [Finite; 3],
    },
    /// Traction of a uniform stress.
    Stress {
        /// Stress tensor (Pa), tension positive: xx, yy, zz, xy, yz, zx.
        stress: [Finite; 6],
    },
    /// Traction of the geostatic stress of ground under its own weight (9.81 m/s2).
    Ground {
        /// Height z of the ground surface (m).
        level: Finite,
        /// Density of the ground (kg/m3), above 0.
        density: Positive,
        /// Coefficient of lateral stress K0: horizontal over vertical stress, 0 or above.
        lateral: NonNegative,
    },
}

/// Zone of a joint: node pairs selected by exactly one of `at`, `node`, `set` and `low` with `high`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Zone {
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
}

impl Zone {
    /// Returns whether no key is given.
    pub fn is_empty(&self) -> bool {
        let Self {
            at,
            within,
            node,
            set,
            low,
            high,
        } = self;
        let points = [at, low, high].iter().all(|point| point.is_none());
        points && within.is_none() && node.is_none() && set.is_none()
    }
}

/// Initial gap between the two sides of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Gap {
    /// Distance of the paired nodes in the mesh, along the normal.
    Meshed,
    /// Uniform gap (m), 0 or above.
    Distance(f64),
}

words_or_number! {
    Gap { "meshed" => Meshed, number => Distance }
    "\"meshed\" or a number of 0 or above", |x| x >= 0.0, { "type": "number", "minimum": 0 }
}
