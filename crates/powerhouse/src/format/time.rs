//! Duration, step and number format.

use core::fmt;
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use super::{At, Finite, Positive, Share};

/// Duration and time step.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// How long the run lasts (s).
    pub duration: Positive,
    /// The time at which it starts (s), 0 by default; records arrive as their waves say.
    pub start: Option<At<Finite>>,
    /// The body's motion at the start.
    #[serde(default)]
    pub initial: At<InitialMotion>,
    /// The time step: `"auto"` (the largest stable one times `safety`) or a number (s). A number
    /// above the stable step is refused.
    #[serde(default)]
    pub step: At<Step>,
    /// The share of the stable step that `"auto"` takes, 1 by default. The stable step is a safe
    /// one already.
    pub safety: Option<Share>,
    /// The integration scheme.
    #[serde(default)]
    pub scheme: At<Scheme>,
}

/// The time step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Step {
    /// The largest stable step.
    #[default]
    Auto,
    /// A step (s).
    Seconds(f64),
}

impl<'de> Deserialize<'de> for Step {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = Step;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("\"auto\" or a number of seconds above 0")
            }
            fn visit_str<E: Error>(self, value: &str) -> Result<Step, E> {
                match value {
                    "auto" => Ok(Step::Auto),
                    _ => Err(E::invalid_value(Unexpected::Str(value), &self)),
                }
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Step, E> {
                if value.is_finite() && value > 0.0 {
                    Ok(Step::Seconds(value))
                } else {
                    Err(E::invalid_value(Unexpected::Float(value), &self))
                }
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Step, E> {
                self.visit_f64(value as f64)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

impl JsonSchema for Step {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Step".into()
    }
    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "oneOf": [{ "const": "auto" }, { "type": "number", "exclusiveMinimum": 0 }]
        })
    }
}

/// The body's motion at the start of a run.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum InitialMotion {
    /// At rest.
    #[default]
    Rest,
    /// The motion of the free field, for waves that are in the body already.
    Field,
}

/// The integration scheme.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Central difference in leapfrog form, dashpots implicit.
    #[default]
    Leapfrog,
    /// Wang, Chen & Xiao (2019), Eqs. (14)-(17), with a one-sided velocity. Refused without
    /// stiffness damping of at least half a step.
    OneSided,
}

/// Number format of nodes and elements.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// Double precision.
    #[default]
    F64,
    /// Nodes in double, element arithmetic in single precision, but for a tenth at most of the elements,
    /// those of the highest natural frequency.
    Mixed,
    /// As mixed, with velocities and forces of nodes in single precision; displacements stay in double.
    F32,
}
