//! Reference frequency of the moduli of a damped material.

use core::fmt;
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

/// Reference frequency at which a material with flat damping has its stated moduli and wave speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Reference {
    /// Geometric centre of the damping band.
    #[default]
    Centre,
    /// Given frequency (Hz), above 0.
    Frequency(f64),
    /// Zero frequency: static moduli.
    Static,
}

impl<'de> Deserialize<'de> for Reference {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = Reference;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("\"centre\", \"static\" or a number above 0")
            }
            fn visit_str<E: Error>(self, value: &str) -> Result<Reference, E> {
                match value {
                    "centre" => Ok(Reference::Centre),
                    "static" => Ok(Reference::Static),
                    _ => Err(E::invalid_value(Unexpected::Str(value), &self)),
                }
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Reference, E> {
                if value > 0.0 && value.is_finite() {
                    Ok(Reference::Frequency(value))
                } else {
                    Err(E::invalid_value(Unexpected::Float(value), &self))
                }
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Reference, E> {
                self.visit_f64(value as f64)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

impl JsonSchema for Reference {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Reference".into()
    }
    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "oneOf": [
                { "enum": ["centre", "static"] },
                { "type": "number", "exclusiveMinimum": 0 }
            ]
        })
    }
}
