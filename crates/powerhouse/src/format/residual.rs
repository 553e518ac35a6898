//! Tolerance of the energy balance.

use core::fmt;
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

/// Tolerance of the energy balance: relative residual above which a run stops.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Residual {
    /// Default of the precision: 1e-7 in double, 1e-4 in mixed, 1e-2 in single.
    #[default]
    Auto,
    /// Given tolerance over the largest energy, above 0 and at most 1.
    Share(f64),
    /// No check of the balance.
    Off,
}

impl<'de> Deserialize<'de> for Residual {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = Residual;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("\"auto\", \"off\" or a number above 0 and at most 1")
            }
            fn visit_str<E: Error>(self, value: &str) -> Result<Residual, E> {
                match value {
                    "auto" => Ok(Residual::Auto),
                    "off" => Ok(Residual::Off),
                    _ => Err(E::invalid_value(Unexpected::Str(value), &self)),
                }
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Residual, E> {
                if value > 0.0 && value <= 1.0 {
                    Ok(Residual::Share(value))
                } else {
                    Err(E::invalid_value(Unexpected::Float(value), &self))
                }
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Residual, E> {
                self.visit_f64(value as f64)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

impl JsonSchema for Residual {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Residual".into()
    }
    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "oneOf": [
                { "enum": ["auto", "off"] },
                { "type": "number", "exclusiveMinimum": 0, "maximum": 1 }
            ]
        })
    }
}
