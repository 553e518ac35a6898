//! Parameters of a registered law or boundary: the keys of an open table.

use core::ops::Range;

use serde::de::DeserializeOwned;
use serde::{Serialize, Serializer};

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
    /// The value of a key; none if it is not given.
    pub fn get(&self, key: &str) -> Option<toml::Value> {
        toml::Value::try_from(self.own.as_table()?.get(key)?).ok()
    }
    /// Sets a key, in place of a value that it has.
    pub fn set(&mut self, key: &str, value: &toml::Value) {
        let span = self.span_of(key);
        if let Some(table) = self.own.as_table_mut() {
            table.insert(
                key,
                Entry {
                    key: span.clone(),
                    node: Node::of_value(value, &span),
                },
            );
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
        let own = self.own.as_table().and_then(|table| table.get(key));
        own.unwrap_or(&self.own).span.clone()
    }
}

impl Serialize for Parameters {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.own.serialize(serializer)
    }
}
