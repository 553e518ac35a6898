//! Deserialisation of [`Node`]s: every fault has the byte range of its value, lists have the length of their type.
//!
//! serde ignores entries of a list beyond the length of an array, and reads a structure from a list, entry by
//! entry. In a scene file both are mistakes.

use core::fmt;
use core::ops::Range;

use serde::de::{
    self, DeserializeSeed, Deserializer, EnumAccess, Error, Expected, MapAccess, SeqAccess,
    Unexpected, VariantAccess, Visitor,
};

use super::at::SPANNED;
use super::node::{Entry, Node, Table, Value};
use crate::plain::plain;
use powerhouse_scene::{Fault, Problem};

/// Value that does not fit its type, with the byte range as soon as it is known.
#[derive(Debug)]
pub(super) struct Misfit {
    problem: Problem,
    span: Option<Range<usize>>,
}

impl Misfit {
    fn at(mut self, span: &Range<usize>) -> Self {
        self.span.get_or_insert_with(|| span.clone());
        self
    }
    /// Value in place of a permitted one, both in the words of serde.
    fn value(found: &impl fmt::Display, expected: &dyn Expected) -> Self {
        let expected = plain(&expected.to_string());
        let found = plain(&found.to_string());
        Problem::Value { found, expected }.into()
    }
}

impl From<Problem> for Misfit {
    fn from(problem: Problem) -> Self {
        let span = None;
        Self { problem, span }
    }
}

impl From<Misfit> for Fault {
    fn from(misfit: Misfit) -> Self {
        Self::new(misfit.span.unwrap_or(0..0), misfit.problem)
    }
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.problem.fmt(f)
    }
}

impl std::error::Error for Misfit {}

impl Error for Misfit {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Problem::Refused(message.to_string().into()).into()
    }
    fn invalid_type(found: Unexpected, expected: &dyn Expected) -> Self {
        Self::value(&found, expected)
    }
    fn invalid_value(found: Unexpected, expected: &dyn Expected) -> Self {
        Self::value(&found, expected)
    }
    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Self::value(&length, expected)
    }
    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        let found = variant.to_owned();
        let permitted = names(expected);
        Problem::UnknownChoice { found, permitted }.into()
    }
    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        let key = field.to_owned();
        let permitted = names(expected);
        Problem::UnknownKey { key, permitted }.into()
    }
    fn missing_field(field: &'static str) -> Self {
        let key = field.to_owned();
        Problem::MissingKey { key }.into()
    }
}

fn names(list: &[&str]) -> Vec<String> {
    list.iter().map(|&name| name.to_owned()).collect()
}

impl Node {
    /// Deserialises the value into a type.
    ///
    /// # Errors
    /// The first value that does not fit, with its byte range.
    pub(super) fn read<T: de::DeserializeOwned>(&self) -> Result<T, Fault> {
        Ok(T::deserialize(self)?)
    }

    /// Checks that the value is no list, from which serde would read a structure or a table.
    fn no_list(&self) -> Result<(), Misfit> {
        match self.value {
            Value::List(_) => Err(Misfit::invalid_type(Unexpected::Seq, &"a map").at(&self.span)),
            _ => Ok(()),
        }
    }

    /// Calls a visitor of a list with exactly so many entries.
    fn of_length<'de, V: Visitor<'de>>(
        &'de self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let value = self.deserialize_any(visitor)?;
        match &self.value {
            Value::List(items) if items.len() > length => {
                let expected = format!("an array of length {length}");
                Err(Misfit::invalid_length(items.len(), &&*expected).at(&self.span))
            }
            _ => Ok(value),
        }
    }
}

impl<'de> Deserializer<'de> for &'de Node {
    type Error = Misfit;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let read = match &self.value {
            Value::Text(text) => visitor.visit_borrowed_str(text),
            Value::Integer(number) => match (i64::try_from(*number), u64::try_from(*number)) {
                (Ok(number), _) => visitor.visit_i64(number),
                (_, Ok(number)) => visitor.visit_u64(number),
                _ => visitor.visit_i128(*number),
            },
            Value::Float(number) => visitor.visit_f64(*number),
            Value::Boolean(value) => visitor.visit_bool(*value),
            Value::Date(_) => Err(Misfit::invalid_type(Unexpected::Other("a date"), &visitor)),
            Value::List(items) => visitor.visit_seq(Items(items.iter())),
            Value::Table(table) => visitor.visit_map(Entries {
                entries: table.iter(),
                node: None,
                rest: None,
            }),
        };
        read.map_err(|misfit| misfit.at(&self.span))
    }
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let read = visitor.visit_some(self);
        read.map_err(|misfit| misfit.at(&self.span))
    }
    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let read = visitor.visit_newtype_struct(self);
        read.map_err(|misfit| misfit.at(&self.span))
    }
    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        self.of_length(length, visitor)
    }
    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        self.of_length(length, visitor)
    }
    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.no_list()?;
        self.deserialize_any(visitor)
    }
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        if name == SPANNED {
            return visitor.visit_seq(WithSpan {
                node: self,
                item: 0,
            });
        }
        self.no_list()?;
        if fields.contains(&SAME_TABLE) {
            let part = Part {
                table: self,
                known: Vec::new(),
            };
            return part.deserialize_struct(name, fields, visitor);
        }
        self.deserialize_any(visitor)
    }
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let choice = match &self.value {
            Value::Text(text) => Choice {
                name: text,
                span: &self.span,
                node: None,
            },
            Value::Table(table) => match (table.iter().next(), table.len()) {
                (Some((name, entry)), 1) => Choice {
                    name,
                    span: &entry.key,
                    node: Some(&entry.node),
                },
                (_, count) => {
                    let found = format!("a table with {count} keys");
                    return Err(Misfit::value(&found, &"a table with one key").at(&self.span));
                }
            },
            _ => {
                let found = self.type_name();
                return Err(Misfit::value(&found, &"a text or a table").at(&self.span));
            }
        };
        let read = visitor.visit_enum(choice);
        read.map_err(|misfit| misfit.at(&self.span))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string
        bytes byte_buf unit unit_struct seq identifier ignored_any
    }
}

/// Entries of a list.
struct Items<'de>(core::slice::Iter<'de, Node>);

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = Misfit;
    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Misfit> {
        self.0.next().map(|item| seed.deserialize(item)).transpose()
    }
    fn size_hint(&self) -> Option<usize> {
        Some(self.0.len())
    }
}

/// Name of a field that takes its own fields from the same table.
const SAME_TABLE: &str = "+";

/// The keys of a table that are fields of a structure. The others are those of the structures around it, and of the one in
/// its field [`SAME_TABLE`].
struct Part<'de> {
    table: &'de Node,
    /// Keys of the structures around it.
    known: Vec<&'static str>,
}

impl<'de> Deserializer<'de> for Part<'de> {
    type Error = Misfit;
    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.table.deserialize_any(visitor)
    }
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let Self { table, mut known } = self;
        known.extend(fields.iter().filter(|field| **field != SAME_TABLE));
        let entries = || table.as_table().into_iter().flat_map(Table::iter);
        let is_last = !fields.contains(&SAME_TABLE);
        if is_last && let Some((key, entry)) = entries().find(|(key, _)| !known.contains(key)) {
            let (key, permitted) = (key.to_owned(), names(&known));
            return Err(Misfit::from(Problem::UnknownKey { key, permitted }).at(&entry.key));
        }
        let read = visitor.visit_map(Entries {
            entries: entries().filter(|(key, _)| *key != SAME_TABLE && fields.contains(key)),
            node: None,
            rest: (!is_last).then_some(Self { table, known }),
        });
        read.map_err(|misfit| misfit.at(&table.span))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option
        unit unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

/// Keys and values of a table.
struct Entries<'de, I: Iterator<Item = (&'de str, &'de Entry)>> {
    entries: I,
    /// Value of the last key.
    node: Option<&'de Node>,
    /// The table, if a part of it is to follow its keys.
    rest: Option<Part<'de>>,
}

impl<'de, I: Iterator<Item = (&'de str, &'de Entry)>> MapAccess<'de> for Entries<'de, I> {
    type Error = Misfit;
    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Misfit> {
        let Some((key, entry)) = self.entries.next() else {
            let key = de::value::BorrowedStrDeserializer::new(SAME_TABLE);
            let part = self.rest.as_ref();
            return part.map(|_| seed.deserialize(key)).transpose();
        };
        self.node = Some(&entry.node);
        let read = seed.deserialize(de::value::BorrowedStrDeserializer::new(key));
        read.map(Some)
            .map_err(|misfit: Misfit| misfit.at(&entry.key))
    }
    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Misfit> {
        match self.node.take() {
            Some(node) => {
                let read = seed.deserialize(node);
                read.map_err(|misfit| misfit.at(&node.span))
            }
            None => match self.rest.take() {
                Some(part) => seed.deserialize(part),
                None => Err(Misfit::custom("a value without a key")),
            },
        }
    }
}

/// Value with the ends of its byte range, as an [`At`](super::At) reads it.
struct WithSpan<'de> {
    node: &'de Node,
    item: u8,
}

impl<'de> SeqAccess<'de> for WithSpan<'de> {
    type Error = Misfit;
    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Misfit> {
        let end = |byte: usize| de::value::UsizeDeserializer::new(byte);
        self.item += 1;
        let read = match self.item {
            1 => seed.deserialize(end(self.node.span.start)),
            2 => seed.deserialize(end(self.node.span.end)),
            _ => seed.deserialize(self.node),
        };
        read.map(Some)
    }
}

/// Variant of an enum: a text, or a table with one key.
struct Choice<'de> {
    name: &'de str,
    span: &'de Range<usize>,
    /// Contents of the variant.
    node: Option<&'de Node>,
}

impl<'de> EnumAccess<'de> for Choice<'de> {
    type Error = Misfit;
    type Variant = Self;
    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, Self), Misfit> {
        let read = seed.deserialize(de::value::BorrowedStrDeserializer::new(self.name));
        let variant = read.map_err(|misfit: Misfit| misfit.at(self.span))?;
        Ok((variant, self))
    }
}

impl<'de> Choice<'de> {
    /// The contents of a variant that needs some.
    fn contents(&self, expected: &'static str) -> Result<&'de Node, Misfit> {
        let missing = || Misfit::invalid_type(Unexpected::UnitVariant, &expected).at(self.span);
        self.node.ok_or_else(missing)
    }
}

impl<'de> VariantAccess<'de> for Choice<'de> {
    type Error = Misfit;
    fn unit_variant(self) -> Result<(), Misfit> {
        let Some(node) = self.node else {
            return Ok(());
        };
        let is_empty = match &node.value {
            Value::Table(table) => table.is_empty(),
            Value::List(items) => items.is_empty(),
            _ => false,
        };
        if is_empty {
            Ok(())
        } else {
            Err(Misfit::value(&node.type_name(), &"an empty table").at(&node.span))
        }
    }
    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Misfit> {
        seed.deserialize(self.contents("newtype variant")?)
    }
    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Misfit> {
        self.contents("tuple variant")?.of_length(length, visitor)
    }
    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let node = self.contents("struct variant")?;
        // An unknown key is reported before a wrong value, of which it may be the cause.
        let unknown = |table: &'de Table| table.iter().find(|(key, _)| !fields.contains(key));
        if let Some((key, entry)) = node.as_table().and_then(unknown) {
            return Err(Misfit::unknown_field(key, fields).at(&entry.key));
        }
        node.deserialize_struct("", fields, visitor)
    }
}
