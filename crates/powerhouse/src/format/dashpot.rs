//! Velocity ratio B of viscous-spring boundaries.

use core::fmt;
use std::borrow::Cow;

use powerhouse_boundary::AxisParameters;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

/// Velocity ratio B of a viscous-spring boundary: physical over apparent wave speed, by which dashpots are
/// multiplied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DashpotRatio {
    /// Value of Wang, Chen & Xiao (2019), 1.1.
    Paper,
    /// A given ratio, 0.1 to 10.
    Number(f64),
}

impl DashpotRatio {
    /// Value of the ratio.
    pub fn get(self) -> f64 {
        match self {
            Self::Paper => AxisParameters::PAPER.speed_ratio,
            Self::Number(ratio) => ratio,
        }
    }
}

impl<'de> Deserialize<'de> for DashpotRatio {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = DashpotRatio;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("\"paper\" or a number of 0.1 to 10")
            }
            fn visit_str<E: Error>(self, value: &str) -> Result<DashpotRatio, E> {
                match value {
                    "paper" => Ok(DashpotRatio::Paper),
                    _ => Err(E::invalid_value(Unexpected::Str(value), &self)),
                }
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<DashpotRatio, E> {
                if (0.1..=10.0).contains(&value) {
                    Ok(DashpotRatio::Number(value))
                } else {
                    Err(E::invalid_value(Unexpected::Float(value), &self))
                }
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<DashpotRatio, E> {
                self.visit_f64(value as f64)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

impl JsonSchema for DashpotRatio {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "DashpotRatio".into()
    }
    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "oneOf": [
                { "enum": ["paper"] },
                { "type": "number", "minimum": 0.1, "maximum": 10 }
            ]
        })
    }
}
