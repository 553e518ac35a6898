//! The keys of an open table: what a registered law or boundary wants.

use core::ops::Range;

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

use super::decode::{self, Source};
use super::strict::Strict;
use crate::fault::Fault;

/// The keys of a material or boundary that its law or kind reads.
#[derive(Clone, Debug, Default)]
pub struct Parameters {
    /// The whole scene: parsed trees borrow from the text that they came from, so a table is found
    /// again in it rather than kept.
    text: Source,
    section: &'static str,
    index: usize,
    /// Keys of the table that the scene format reads itself.
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
    /// Reads the keys into a structure.
    ///
    /// # Errors
    /// An unknown or missing key or a value of a wrong type or range, with its place.
    pub fn decode<T: DeserializeOwned>(&self) -> Result<T, Fault> {
        let table = self.table()?;
        let table = Spanned::new(table.span(), DeValue::Table(table.into_inner()));
        T::deserialize(Strict(ValueDeserializer::from(table)))
            .map_err(|error| Fault::from_toml(error).with_permitted(self.shared))
    }
    /// Where the value of a key stands, or the whole table if there is no such key.
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
