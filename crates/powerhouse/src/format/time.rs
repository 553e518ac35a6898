//! Duration, time step, integration scheme and precision.

use core::fmt;
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use super::{At, Finite, Positive, Share};

/// Time integration of the dynamic run: duration, start, step and scheme.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Duration of the run (s), above 0.
    pub duration: Positive,
    /// Start time of the run (s), 0 by default; it does not shift the arrival times of waves.
    pub start: Option<At<Finite>>,
    /// Initial motion of the body: `rest` (the default) or `field`.
    #[serde(default)]
    pub initial: At<InitialMotion>,
    /// Time step: `"auto"` (the stable step times `safety`; the default) or a number above 0 (s). A number above
    /// the stable step is an error.
    #[serde(default)]
    pub step: At<Step>,
    /// Factor on the stable step for `"auto"`, above 0 and at most 1, 1 by default; the stable step is a safe
    /// estimate already.
    pub safety: Option<Share>,
    /// Integration scheme: `leapfrog` (the default) or `one-sided`.
    #[serde(default)]
    pub scheme: At<Scheme>,
}

/// Time step of the dynamic run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Step {
    /// Stable step times the safety factor.
    #[default]
    Auto,
    /// Given step (s), above 0.
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

/// Initial motion of the body.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum InitialMotion {
    /// Zero displacement and velocity.
    #[default]
    Rest,
    /// Motion of the free field at the start, for waves that have entered the body already.
    Field,
}

/// Time integration scheme.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Central difference method in leapfrog form, with implicit dashpots.
    #[default]
    Leapfrog,
    /// Explicit scheme with one-sided velocity of Wang, Chen & Xiao (2019), Eqs. (14)-(17). An error unless the
    /// stiffness damping coefficient is at least half a step.
    OneSided,
}

/// Floating-point precision of nodal and element arithmetic.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// Double precision throughout.
    #[default]
    F64,
    /// Mixed precision: nodes in double, element arithmetic in single precision, except at most a tenth of the
    /// elements, those of the highest natural frequencies.
    Mixed,
    /// Single precision: as mixed, with nodal velocities and forces in single precision; displacements stay in
    /// double.
    F32,
}
