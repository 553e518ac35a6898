//! Checkpoints of a run.

use core::fmt;
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{At, Finite};
use crate::CheckpointInterval;

/// Checkpoints of the run, from which it can be resumed, and states that are kept after it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Checkpoint {
    /// Wall time between two checkpoints: a number with the unit s, min or h, `"10min"` by default, or `"never"`.
    /// `--checkpoint-every` takes its place.
    pub every: Option<Interval>,
    /// Times (s), after the start of the run and before its end, of which states are kept in the subfolder `kept` of
    /// the results: `powerhouse run --from DIR@TIME` starts a variant of the run from one of them. None by default.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keep: Vec<At<Finite>>,
}

/// Interval of wall time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval(pub CheckpointInterval);

impl<'de> Deserialize<'de> for Interval {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = Interval;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(
                    "a time above 0 with a unit, such as \"30s\", \"10min\" or \"1h\", or \"never\"",
                )
            }
            fn visit_str<E: Error>(self, value: &str) -> Result<Interval, E> {
                let parsed = value.parse().map(Interval);
                parsed.map_err(|_| E::invalid_value(Unexpected::Str(value), &self))
            }
        }
        deserializer.deserialize_str(Reader)
    }
}

impl Serialize for Interval {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

impl JsonSchema for Interval {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Interval".into()
    }
    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "string",
            "pattern": r"^\s*(never|[0-9.]+\s*(s|min|h))\s*$"
        })
    }
}
