//! Parameters as keys of scene files: numbers with a permitted range, which is checked when they are read.
//!
//! A field that holds `f64` or `Option<f64>` is read as one of these numbers, and documented as such in the JSON schema, by
//! the attribute `#[serde(with = "Positive")]`. Scene files know three more forms of keys. A field that is renamed to `+`
//! takes its own fields from the same table, `table.key` is a key of a table within, and a key without a value has that of
//! the key that the schema names as `x-like`, times `x-times`.

use core::fmt;
use std::borrow::Cow;

pub use schemars::JsonSchema;
use schemars::{Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
pub use serde::{Deserialize, Deserializer, Serialize, Serializer};

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $expected:literal, $valid:expr, $schema:tt) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            /// Checked number; `None` if it is not finite or outside the range.
            pub fn new(value: f64) -> Option<Self> {
                let valid: fn(f64) -> bool = $valid;
                (value.is_finite() && valid(value)).then_some(Self(value))
            }
            /// Value of the number.
            pub fn get(self) -> f64 {
                self.0
            }
            /// Reads the number into a field.
            ///
            /// # Errors
            /// A value that is no number, or outside the range.
            pub fn deserialize<'de, D: Deserializer<'de>, T: From<f64>>(
                deserializer: D,
            ) -> Result<T, D::Error> {
                <Self as Deserialize>::deserialize(deserializer).map(|number| number.0.into())
            }
            /// Writes the number of a field.
            ///
            /// # Errors
            /// Those of the serializer.
            pub fn serialize<S: Serializer, T: Copy + Into<Option<f64>>>(
                number: &T,
                serializer: S,
            ) -> Result<S::Ok, S::Error> {
                let number: Option<f64> = (*number).into();
                number.serialize(serializer)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                struct Reader;
                impl Visitor<'_> for Reader {
                    type Value = $name;
                    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                        f.write_str($expected)
                    }
                    fn visit_f64<E: Error>(self, value: f64) -> Result<$name, E> {
                        $name::new(value)
                            .ok_or_else(|| E::invalid_value(Unexpected::Float(value), &self))
                    }
                    fn visit_i64<E: Error>(self, value: i64) -> Result<$name, E> {
                        self.visit_f64(value as f64)
                    }
                }
                deserializer.deserialize_f64(Reader)
            }
        }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_f64(self.0)
            }
        }

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
    };
}

/// Implements the reading and writing of an enum as a key: variants that are words, and one that is a number within a range.
/// The crate of the enum needs `serde` and `schemars`.
#[macro_export]
macro_rules! words_or_number {
    (
        $name:ident { $($word:literal => $variant:ident,)* number => $number:ident }
        $expected:literal, $valid:expr, $schema:tt
    ) => {
        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                use serde::de::{Error, Unexpected};
                struct Reader;
                impl serde::de::Visitor<'_> for Reader {
                    type Value = $name;
                    fn expecting(&self, f: &mut core::fmt::Formatter) -> core::fmt::Result {
                        f.write_str($expected)
                    }
                    fn visit_str<E: Error>(self, value: &str) -> Result<$name, E> {
                        match value {
                            $($word => Ok($name::$variant),)*
                            _ => Err(E::invalid_value(Unexpected::Str(value), &self)),
                        }
                    }
                    fn visit_f64<E: Error>(self, value: f64) -> Result<$name, E> {
                        let valid: fn(f64) -> bool = $valid;
                        if value.is_finite() && valid(value) { Ok($name::$number(value)) } else { Err(E::invalid_value(Unexpected::Float(value), &self)) }
                    }
                    fn visit_i64<E: Error>(self, value: i64) -> Result<$name, E> {
                        self.visit_f64(value as f64)
                    }
                }
                deserializer.deserialize_any(Reader)
            }
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                match *self {
                    $($name::$variant => serializer.serialize_str($word),)*
                    $name::$number(number) => serializer.serialize_f64(number),
                }
            }
        }

        impl schemars::JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(_generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({ "oneOf": [{ "enum": [$($word),*] }, $schema] })
            }
        }
    };
}
pub use words_or_number;

quantity! {
    /// Finite number.
    Finite, "a finite number", |_| true, { "type": "number" }
}

impl Finite {
    /// Checked numbers; `None` if one of them is not finite.
    pub fn array<const N: usize>(values: [f64; N]) -> Option<[Self; N]> {
        let finite = values.iter().all(|value| value.is_finite());
        finite.then(|| values.map(Self))
    }
}

quantity! {
    /// Positive finite number.
    Positive, "a number above 0", |x| x > 0.0, { "type": "number", "exclusiveMinimum": 0 }
}
quantity! {
    /// Non-negative finite number.
    NonNegative, "a number of 0 or above", |x| x >= 0.0, { "type": "number", "minimum": 0 }
}
quantity! {
    /// Fraction above zero and at most one.
    Share, "a number above 0 and at most 1", |x| x > 0.0 && x <= 1.0,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1 }
}
quantity! {
    /// Factor on the stable step, above 1 and at most 10.
    StepFactor, "a factor above 1 and at most 10", |x| x > 1.0 && x <= 10.0,
    { "type": "number", "exclusiveMinimum": 1, "maximum": 10 }
}
quantity! {
    /// Angle of incidence from the vertical (degrees), 0 to 180.
    Incidence, "an angle of 0 to 180 degrees", |x| (0.0..=180.0).contains(&x),
    { "type": "number", "minimum": 0, "maximum": 180 }
}
quantity! {
    /// Azimuth: horizontal direction (degrees), -360 to 360.
    Azimuth, "an angle of -360 to 360 degrees", |x| (-360.0..=360.0).contains(&x),
    { "type": "number", "minimum": -360, "maximum": 360 }
}
quantity! {
    /// Poisson's ratio, above -1 and below 0.5.
    PoissonRatio, "a number above -1 and below 0.5", |x| x > -1.0 && x < 0.5,
    { "type": "number", "exclusiveMinimum": -1, "exclusiveMaximum": 0.5 }
}
quantity! {
    /// Amplitude ratio A of a viscous-spring boundary, 0 to 100.
    AmplitudeRatio, "a number of 0 to 100", |x| (0.0..=100.0).contains(&x),
    { "type": "number", "minimum": 0, "maximum": 100 }
}

/// Default of a switch that is on.
pub fn yes() -> bool {
    true
}

/// Default of a number: `N / D`.
pub fn ratio<const N: i32, const D: i32>() -> f64 {
    f64::from(N) / f64::from(D)
}
