//! Values of a TOML text with their byte ranges, independent of the text.

use core::ops::Range;
use std::collections::BTreeMap;

use serde::ser::{Serialize, SerializeMap, SerializeSeq, Serializer};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use powerhouse_scene::{Fault, Problem};

/// Value of a TOML text with its byte range.
#[derive(Clone, Debug, Default)]
pub(super) struct Node {
    pub(super) value: Value,
    pub(super) span: Range<usize>,
}

/// Value of TOML.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(String),
    Integer(i128),
    Float(f64),
    Boolean(bool),
    /// Date or time, as it is written; scenes have none.
    Date(String),
    List(Vec<Node>),
    Table(Table),
}

impl Default for Value {
    fn default() -> Self {
        Self::Table(Table::default())
    }
}

/// Values of a table by their keys, in the order of these.
#[derive(Clone, Debug, Default)]
pub(super) struct Table(BTreeMap<String, Entry>);

/// Value under a key.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Byte range of the key.
    pub(super) key: Range<usize>,
    pub(super) node: Node,
}

impl Node {
    /// Parses a TOML text into its root table.
    ///
    /// # Errors
    /// Invalid syntax; a number beyond the range of its type.
    pub(super) fn parse(text: &str) -> Result<Self, Fault> {
        let root = DeTable::parse(text).map_err(|error| {
            let message = error.message().to_owned();
            Fault::new(error.span().unwrap_or(0..0), Problem::Syntax { message })
        })?;
        let span = root.span();
        Self::of(Spanned::new(span, DeValue::Table(root.into_inner())))
    }

    fn of(parsed: Spanned<DeValue>) -> Result<Self, Fault> {
        let span = parsed.span();
        let overflow = |what: &str| {
            let message = format!("{what} number overflowed");
            Fault::new(span.clone(), Problem::Syntax { message })
        };
        let value = match parsed.into_inner() {
            DeValue::String(text) => Value::Text(text.into_owned()),
            DeValue::Integer(digits) => {
                let number = i128::from_str_radix(digits.as_str(), digits.radix());
                Value::Integer(number.map_err(|_| overflow("integer"))?)
            }
            DeValue::Float(digits) => {
                let number = digits.as_str().parse::<f64>().ok();
                // Digits beyond the largest number are infinite as well.
                let number = number.filter(|x| x.is_finite() || !has_digits(digits.as_str()));
                Value::Float(number.ok_or_else(|| overflow("floating-point"))?)
            }
            DeValue::Boolean(value) => Value::Boolean(value),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(items) => {
                let items = items.into_iter().map(Self::of);
                Value::List(items.collect::<Result<_, _>>()?)
            }
            DeValue::Table(entries) => {
                let entries = entries.into_iter().map(|(key, value)| {
                    let (span, node) = (key.span(), Self::of(value)?);
                    Ok((key.into_inner().into_owned(), Entry { key: span, node }))
                });
                Value::Table(Table(entries.collect::<Result<_, Fault>>()?))
            }
        };
        Ok(Self { value, span })
    }

    /// A value of a program, with the byte range of what it replaces.
    pub(super) fn of_value(value: &toml::Value, span: &Range<usize>) -> Self {
        let of = |value| Self::of_value(value, span);
        let value = match value {
            toml::Value::String(text) => Value::Text(text.clone()),
            toml::Value::Integer(number) => Value::Integer((*number).into()),
            toml::Value::Float(number) => Value::Float(*number),
            toml::Value::Boolean(value) => Value::Boolean(*value),
            toml::Value::Datetime(date) => Value::Date(date.to_string()),
            toml::Value::Array(items) => Value::List(items.iter().map(of).collect()),
            toml::Value::Table(table) => {
                let entry = |(key, value): (&String, _)| {
                    let (span, node) = (span.clone(), of(value));
                    (key.clone(), Entry { key: span, node })
                };
                Value::Table(Table(table.iter().map(entry).collect()))
            }
        };
        let span = span.clone();
        Self { value, span }
    }
    pub(super) fn table(span: Range<usize>, table: Table) -> Self {
        let value = Value::Table(table);
        Self { value, span }
    }
    pub(super) fn as_table(&self) -> Option<&Table> {
        match &self.value {
            Value::Table(table) => Some(table),
            _ => None,
        }
    }
    pub(super) fn as_table_mut(&mut self) -> Option<&mut Table> {
        match &mut self.value {
            Value::Table(table) => Some(table),
            _ => None,
        }
    }
    pub(super) fn as_text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
    /// Numerical value of an integer or float.
    pub(super) fn as_number(&self) -> Option<f64> {
        match self.value {
            Value::Integer(number) => Some(number as f64),
            Value::Float(number) => Some(number),
            _ => None,
        }
    }
    /// Name of the type of the value.
    pub(super) fn type_name(&self) -> &'static str {
        match self.value {
            Value::Text(_) => "a string",
            Value::Integer(_) => "an integer",
            Value::Float(_) => "a float",
            Value::Boolean(_) => "a boolean",
            Value::Date(_) => "a datetime",
            Value::List(_) => "an array",
            Value::Table(_) => "a table",
        }
    }
}

fn has_digits(text: &str) -> bool {
    text.contains(|letter: char| letter.is_ascii_digit())
}

impl Table {
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        self.0.get(key).map(|entry| &entry.node)
    }
    pub(super) fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.0.get_mut(key).map(|entry| &mut entry.node)
    }
    /// Adds a value under a key, or replaces it with its byte ranges.
    pub(super) fn insert(&mut self, key: impl Into<String>, entry: Entry) {
        self.0.insert(key.into(), entry);
    }
    pub(super) fn remove(&mut self, key: &str) -> Option<Entry> {
        self.0.remove(key)
    }
    /// Keeps the keys of which a condition is true, and returns the others.
    pub(super) fn split(&mut self, keep: impl Fn(&str) -> bool) -> Self {
        let (kept, others) = core::mem::take(&mut self.0)
            .into_iter()
            .partition(|(key, _)| keep(key));
        self.0 = kept;
        Self(others)
    }
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = (&str, &Entry)> {
        self.0.iter().map(|(key, entry)| (key.as_str(), entry))
    }
    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = (&str, &mut Entry)> {
        self.0.iter_mut().map(|(key, entry)| (key.as_str(), entry))
    }

    /// The tables of a list of tables; none if the key is missing or another value.
    pub(super) fn tables(&self, key: &str) -> impl Iterator<Item = &Self> {
        let items = match self.get(key).map(|node| &node.value) {
            Some(Value::List(items)) => &items[..],
            _ => &[],
        };
        items.iter().filter_map(Node::as_table)
    }
    /// As [`tables`](Self::tables).
    pub(super) fn tables_mut(&mut self, key: &str) -> impl Iterator<Item = &mut Self> {
        let items = match self.get_mut(key).map(|node| &mut node.value) {
            Some(Value::List(items)) => &mut items[..],
            _ => &mut [],
        };
        items.iter_mut().filter_map(Node::as_table_mut)
    }
}

/// Comparison ignores byte ranges; an integer equals the float of its value.
impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        match (&self.value, &other.value) {
            (Value::Text(a), Value::Text(b)) | (Value::Date(a), Value::Date(b)) => a == b,
            (Value::Boolean(a), Value::Boolean(b)) => a == b,
            (Value::List(a), Value::List(b)) => a == b,
            (Value::Table(a), Value::Table(b)) => a == b,
            _ => match (self.as_number(), other.as_number()) {
                (Some(a), Some(b)) => a == b,
                _ => false,
            },
        }
    }
}

impl PartialEq for Table {
    fn eq(&self, other: &Self) -> bool {
        let pairs = self.iter().zip(other.iter());
        self.len() == other.len()
            && pairs
                .into_iter()
                .all(|((a, x), (b, y))| a == b && x.node == y.node)
    }
}

impl Serialize for Node {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.value {
            Value::Text(text) | Value::Date(text) => serializer.serialize_str(text),
            Value::Integer(number) => match i64::try_from(*number) {
                Ok(number) => serializer.serialize_i64(number),
                Err(_) => serializer.serialize_i128(*number),
            },
            Value::Float(number) => serializer.serialize_f64(*number),
            Value::Boolean(value) => serializer.serialize_bool(*value),
            Value::List(items) => {
                let mut list = serializer.serialize_seq(Some(items.len()))?;
                for item in items {
                    list.serialize_element(item)?;
                }
                list.end()
            }
            Value::Table(table) => table.serialize(serializer),
        }
    }
}

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.len()))?;
        for (key, entry) in self.iter() {
            map.serialize_entry(key, &entry.node)?;
        }
        map.end()
    }
}
