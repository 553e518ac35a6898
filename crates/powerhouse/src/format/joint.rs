//! Joints between parts.

use core::fmt;
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use super::{At, Finite, NonNegative, Parameters, Positive};

/// A joint: where two parts touch, how it starts, and the law of its tractions with the law's
/// parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub struct JointSection {
    /// The name in results.
    pub name: At<String>,
    /// Two element sets that share nodes: the mesh is cut open along their common facets. A joint
    /// has either this or `facets`.
    pub between: Option<At<[String; 2]>>,
    /// Two facet sets that face each other, of a mesh that is meshed apart there.
    pub facets: Option<At<[String; 2]>>,
    /// Largest distance of nodes that face each other (m); by default a millionth of the mesh's
    /// diagonal.
    pub tolerance: Option<Positive>,
    /// Largest angle (degrees) between facets that count as one smooth patch, 40 by default.
    /// Beyond it nodes on the edge have a pair for each side of it.
    pub corner: Option<At<Positive>>,
    /// Traction on the joint in the state from which displacements are counted; none by default.
    /// The law sees the sum of it and what the motion adds, and must admit it.
    pub preload: Option<At<Preload>>,
    /// Distance of the sides in that state (m), or `"meshed"`: that of the nodes in the mesh, along
    /// the normal. None by default. A pair apart has neither bond nor preload.
    pub gap: Option<At<Gap>>,
    /// Zones that start without the bond that the law gives, as where the joint was cracked before.
    pub unbonded: Option<Vec<At<Zone>>>,
    /// The law's name in the registry, such as `bonded-coulomb`.
    pub law: At<String>,
    /// All other keys: what the law wants.
    #[serde(skip)]
    pub parameters: Parameters,
}

/// The traction on a joint in the state from which displacements are counted.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Preload {
    /// Pressure across it.
    Pressure {
        /// Pressure (Pa), positive where the sides are pressed together.
        pressure: Finite,
    },
    /// The same traction everywhere.
    Traction {
        /// Traction on the side of the joint's first set (Pa), in x, y and z.
        traction: [Finite; 3],
    },
    /// The traction of a stress that is the same everywhere.
    Stress {
        /// Stress (Pa), tension positive: xx, yy, zz, xy, yz, zx.
        stress: [Finite; 6],
    },
    /// The traction of the stress of ground under its own weight (9.81 m/s2).
    Ground {
        /// Height of the ground's surface (m).
        level: Finite,
        /// Density of the ground (kg/m3).
        density: Positive,
        /// Horizontal over vertical stress.
        lateral: NonNegative,
    },
}

/// Some pairs of a joint: exactly one of `at`, `node`, `set` and `low` with `high`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Zone {
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
}

impl Zone {
    /// Whether no key is given.
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

/// The distance of a joint's sides at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gap {
    /// That of the nodes in the mesh.
    Meshed,
    /// A distance (m), not negative.
    Distance(f64),
}

impl<'de> Deserialize<'de> for Gap {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = Gap;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("\"meshed\" or a number of 0 or above")
            }
            fn visit_str<E: Error>(self, value: &str) -> Result<Gap, E> {
                match value {
                    "meshed" => Ok(Gap::Meshed),
                    _ => Err(E::invalid_value(Unexpected::Str(value), &self)),
                }
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Gap, E> {
                if value.is_finite() && value >= 0.0 {
                    Ok(Gap::Distance(value))
                } else {
                    Err(E::invalid_value(Unexpected::Float(value), &self))
                }
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Gap, E> {
                self.visit_f64(value as f64)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

impl JsonSchema for Gap {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Gap".into()
    }
    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        json_schema!({ "oneOf": [{ "const": "meshed" }, { "type": "number", "minimum": 0 }] })
    }
}
