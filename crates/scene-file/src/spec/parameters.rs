//! Parameters of a registered law or boundary: the keys of an open table.

use core::ops::Range;
use std::collections::BTreeMap;

use schemars::{JsonSchema, SchemaGenerator};
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Serialize, Serializer};
use serde_json::Value;

use super::node::{Entry, Node};
use powerhouse_scene::Fault;

/// Keys of a material, joint or boundary that are parameters of its law or kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    own: Node,
    /// Keys of the table that belong to the scene format.
    shared: &'static [&'static str],
}

impl Parameters {
    pub(super) fn new(own: Node, shared: &'static [&'static str]) -> Self {
        Self { own, shared }
    }
    /// Deserialises the keys into a structure.
    ///
    /// # Errors
    /// An unknown or missing key, or a value of a wrong type or outside its range, with its byte range.
    pub fn decode<T: DeserializeOwned>(&self) -> Result<T, Fault> {
        let read = self.own.read();
        read.map_err(|fault| fault.with_permitted(self.shared))
    }
    /// Deserialises the keys into the parameters of a registered type, by its schema; keys that are not given have given
    /// defaults.
    ///
    /// # Errors
    /// As [`decode`](Self::decode).
    pub(crate) fn decode_by_schema<P: DeserializeOwned + JsonSchema>(
        &self,
        defaults: &toml::Table,
    ) -> Result<P, Fault> {
        let schema = P::json_schema(&mut SchemaGenerator::default());
        let none = serde_json::Map::new();
        let properties = schema.get("properties").and_then(Value::as_object);
        let properties = properties.unwrap_or(&none);
        let mut complete = self.clone();
        complete.join_tables(properties.keys())?;
        for (key, value) in defaults {
            if complete.node(key).is_none() {
                complete.set(key, value);
            }
        }
        for (key, property) in properties {
            let like = property.get("x-like").and_then(Value::as_str);
            let Some(like) = like.filter(|_| complete.node(key).is_none()) else {
                continue;
            };
            let times = property.get("x-times").and_then(Value::as_f64);
            let number = |node: &Node| Some((node.as_number()?, node.span.clone()));
            if let Some((number, span)) = complete.node(like).and_then(number) {
                complete.insert(key, &(number * times.unwrap_or(1.0)).into(), span);
            }
        }
        complete.decode()
    }

    /// Joins the tables within: `key` of the table `table` becomes `table.key`, if there are such keys.
    fn join_tables<'k>(&mut self, keys: impl Iterator<Item = &'k String>) -> Result<(), Fault> {
        for (table, _) in keys.filter_map(|key| key.split_once('.')) {
            let Some(own) = self.own.as_table_mut() else {
                break;
            };
            let Some(Entry { node, .. }) = own.remove(table) else {
                continue;
            };
            let Some(within) = node.as_table() else {
                return node.read::<BTreeMap<String, IgnoredAny>>().map(drop);
            };
            for (key, entry) in within.iter() {
                own.insert(format!("{table}.{key}"), entry.clone());
            }
        }
        Ok(())
    }

    fn node(&self, key: &str) -> Option<&Node> {
        self.own.as_table()?.get(key)
    }
    /// The value of a key; none if it is not given.
    pub fn get(&self, key: &str) -> Option<toml::Value> {
        toml::Value::try_from(self.node(key)?).ok()
    }
    /// Sets a key, in place of a value that it has.
    pub fn set(&mut self, key: &str, value: &toml::Value) {
        self.insert(key, value, self.span_of(key));
    }
    fn insert(&mut self, key: &str, value: &toml::Value, span: Range<usize>) {
        let node = Node::of_value(value, &span);
        if let Some(table) = self.own.as_table_mut() {
            table.insert(key, Entry { key: span, node });
        }
    }
    /// Removes the keys of which a condition is false.
    pub fn retain(&mut self, keep: impl Fn(&str) -> bool) {
        if let Some(table) = self.own.as_table_mut() {
            table.split(keep);
        }
    }
    /// Byte range of the value of a key, or of the whole table if the key is not given.
    pub fn span_of(&self, key: &str) -> Range<usize> {
        self.node(key).unwrap_or(&self.own).span.clone()
    }
}

impl Serialize for Parameters {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.own.serialize(serializer)
    }
}
