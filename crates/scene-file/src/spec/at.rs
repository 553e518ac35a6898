//! Values with their byte range in the scene file.

use core::fmt;
use core::marker::PhantomData;
use core::ops::{Deref, DerefMut, Range};
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use powerhouse_scene::{Fault, Problem};

/// Name of the structure that asks a deserialiser for a value with its byte range: start, end, value.
pub(super) const SPANNED: &str = "$powerhouse::At";

/// A value of the scene file with the byte range from which it was read.
///
/// Comparison ignores the byte range.
#[derive(Clone, Debug, Default)]
pub struct At<T> {
    value: T,
    span: Range<usize>,
}

impl<T> At<T> {
    /// Value with its byte range.
    pub fn new(value: T, span: Range<usize>) -> Self {
        Self { value, span }
    }
    /// Byte range in the scene file.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }
}

impl At<String> {
    /// Fault of a name that none of the available ones is.
    pub(crate) fn unknown(&self, what: &'static str, available: Vec<String>) -> Fault {
        let name = self.to_string();
        let problem = Problem::NoSuchName {
            what,
            name,
            available,
        };
        Fault::new(self.span(), problem)
    }
    /// Fault of a name that is defined before.
    pub(crate) fn duplicate(&self, what: &'static str) -> Fault {
        let name = self.to_string();
        Fault::new(self.span(), Problem::Duplicate { what, name })
    }
}

impl<T> From<T> for At<T> {
    /// Value of a program, without a byte range.
    fn from(value: T) -> Self {
        Self::new(value, 0..0)
    }
}

impl<T> Deref for At<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.value
    }
}

/// A changed value keeps the byte range of the former one.
impl<T> DerefMut for At<T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.value
    }
}

impl<T: PartialEq> PartialEq for At<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for At<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Reader<T> {
            type Value = At<T>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a value with its byte range")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<At<T>, A::Error> {
                let start = list.next_element()?;
                let end = list.next_element()?;
                match (start, end, list.next_element()?) {
                    (Some(start), Some(end), Some(value)) => Ok(At::new(value, start..end)),
                    _ => Err(A::Error::custom("a value without its byte range")),
                }
            }
        }
        deserializer.deserialize_struct(SPANNED, &["start", "end", "value"], Reader(PhantomData))
    }
}

impl<T: Serialize> Serialize for At<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value.serialize(serializer)
    }
}

impl<T: JsonSchema> JsonSchema for At<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }
    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }
    fn schema_id() -> Cow<'static, str> {
        T::schema_id()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}
