//! Parameters of a registered law or boundary: the keys of an open table.

use core::ops::Range;

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

use super::decode::{self, Source};
use super::strict::Strict;
use crate::fault::Fault;

/// Keys of a material, joint or boundary that are parameters of its law or kind.
#[derive(Clone, Debug, Default)]
pub struct Parameters {
    /// Text of the whole scene: parsed trees borrow from their text, so the table is parsed again rather than
    /// stored.
    text: Source,
    section: &'static str,
    index: usize,
    /// Keys of the table that belong to the scene format.
    shared: &'static [&'static str],
}

impl Parameters {
    pub(super) fn new(
        text: Source,
        (section, index): (&'static str, usize),
        shared: &'static [&'static str],
    ) -> Self {
        Self {
            text,
            section,
            index,
            shared,
        }
    }
    /// Deserialises the keys into a structure.
    ///
    /// # Errors
    /// An unknown or missing key, or a value of a wrong type or outside its range, with its byte range.
    pub fn decode<T: DeserializeOwned>(&self) -> Result<T, Fault> {
        let table = self.table()?;
        let table = Spanned::new(table.span(), DeValue::Table(table.into_inner()));
        T::deserialize(Strict(ValueDeserializer::from(table)))
            .map_err(|error| Fault::from_toml(error).with_permitted(self.shared))
    }
    /// Byte range of the value of a key, or of the whole table if the key is not given.
    pub fn span_of(&self, key: &str) -> Range<usize> {
        self.table().map_or(0..0, |table| {
            table.get_ref().get(key).map_or(table.span(), Spanned::span)
        })
    }
    fn table(&self) -> Result<Spanned<DeTable<'_>>, Fault> {
        let mut root = self.text.tree()?;
        let mut own = decode::split(root.get_mut(), self.section, self.shared);
        Ok(if self.index < own.len() {
            own.swap_remove(self.index)
        } else {
            Spanned::new(0..0, DeTable::new())
        })
    }
}
