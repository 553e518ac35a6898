//! Fibres: added inertia of the motion across thin parts, for a longer time step.

use core::fmt;
use std::borrow::Cow;

use powerhouse_scene::FibreOptions;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::At;
use super::StepFactor;

/// Fibres of the dynamic run.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Fibres {
    /// No fibres.
    #[default]
    None,
    /// Fibres in all thin parts, for a requested factor on the step.
    Factor(StepFactor),
    /// Fibres in some sets.
    InSets(FibreSection),
}

/// Fibres in some element sets.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct FibreSection {
    /// Requested stable step over that without fibres, above 1 and at most 10.
    pub factor: StepFactor,
    /// Element sets with fibres.
    pub sets: Vec<At<String>>,
}

impl Fibres {
    /// Fibres for another requested factor, in the same sets.
    #[must_use]
    pub fn with_factor(&self, factor: StepFactor) -> Self {
        match self {
            Self::InSets(section) => Self::InSets(FibreSection {
                factor,
                sets: section.sets.clone(),
            }),
            _ => Self::Factor(factor),
        }
    }
    /// The options of the scene.
    pub(crate) fn options(&self) -> Option<FibreOptions> {
        match self {
            Self::None => None,
            Self::Factor(factor) => Some(FibreOptions::new(factor.get())),
            Self::InSets(FibreSection { factor, sets }) => {
                let sets = sets.iter().map(|set| set.to_string());
                Some(FibreOptions::new(factor.get()).in_sets(sets))
            }
        }
    }
    /// The names of sets.
    pub(crate) fn sets(&self) -> &[At<String>] {
        match self {
            Self::InSets(section) => &section.sets,
            _ => &[],
        }
    }
}

/// Text of the value that means no fibres.
const NONE: &str = "none";

impl<'de> Deserialize<'de> for Fibres {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Fibres;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(
                    "\"none\", a factor above 1 and at most 10, or a table with `factor` and `sets`",
                )
            }
            fn visit_str<E: Error>(self, value: &str) -> Result<Fibres, E> {
                match value {
                    NONE => Ok(Fibres::None),
                    _ => Err(E::invalid_value(Unexpected::Str(value), &self)),
                }
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Fibres, E> {
                let factor = StepFactor::new(value).map(Fibres::Factor);
                factor.ok_or_else(|| E::invalid_value(Unexpected::Float(value), &self))
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Fibres, E> {
                self.visit_f64(value as f64)
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Fibres, A::Error> {
                let section = FibreSection::deserialize(MapAccessDeserializer::new(map));
                section.map(Fibres::InSets)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

impl Serialize for Fibres {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::None => serializer.serialize_str(NONE),
            Self::Factor(factor) => factor.serialize(serializer),
            Self::InSets(section) => section.serialize(serializer),
        }
    }
}

impl JsonSchema for Fibres {
    fn schema_name() -> Cow<'static, str> {
        "Fibres".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let factor = generator.subschema_for::<StepFactor>();
        let section = generator.subschema_for::<FibreSection>();
        json_schema!({ "anyOf": [{ "enum": [NONE] }, factor, section] })
    }
}
