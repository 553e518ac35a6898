//! Deserializer that rejects lists of a wrong length, and lists in place of tables.
//!
//! serde ignores entries of a list beyond the length of an array, and reads a structure from a list, entry by
//! entry. In a scene file both are mistakes.

use core::fmt;

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, IgnoredAny, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor,
};

/// Strict wrapper of a deserializer, visitor, seed or access of serde, at any depth of a file.
pub(crate) struct Strict<T>(pub(crate) T);

/// Form of value that a visitor requires.
#[derive(Clone, Copy)]
enum Required {
    /// Any value, or a list of any length.
    Any,
    /// List of this length.
    Length(usize),
    /// Table.
    Table,
}

struct StrictVisitor<V>(V, Required);

macro_rules! forward {
    ($($method:ident($($argument:ident: $type:ty),*) -> $required:expr;)*) => {
        $(
            fn $method<V: Visitor<'de>>(
                self,
                $($argument: $type,)*
                visitor: V,
            ) -> Result<V::Value, Self::Error> {
                self.0.$method($($argument,)* StrictVisitor(visitor, $required))
            }
        )*
    };
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Strict<D> {
    type Error = D::Error;

    forward! {
        deserialize_any() -> Required::Any;
        deserialize_bool() -> Required::Any;
        deserialize_i8() -> Required::Any;
        deserialize_i16() -> Required::Any;
        deserialize_i32() -> Required::Any;
        deserialize_i64() -> Required::Any;
        deserialize_i128() -> Required::Any;
        deserialize_u8() -> Required::Any;
        deserialize_u16() -> Required::Any;
        deserialize_u32() -> Required::Any;
        deserialize_u64() -> Required::Any;
        deserialize_u128() -> Required::Any;
        deserialize_f32() -> Required::Any;
        deserialize_f64() -> Required::Any;
        deserialize_char() -> Required::Any;
        deserialize_str() -> Required::Any;
        deserialize_string() -> Required::Any;
        deserialize_bytes() -> Required::Any;
        deserialize_byte_buf() -> Required::Any;
        deserialize_option() -> Required::Any;
        deserialize_unit() -> Required::Any;
        deserialize_unit_struct(name: &'static str) -> Required::Any;
        deserialize_newtype_struct(name: &'static str) -> Required::Any;
        deserialize_seq() -> Required::Any;
        deserialize_tuple(length: usize) -> Required::Length(length);
        deserialize_tuple_struct(name: &'static str, length: usize) -> Required::Length(length);
        deserialize_map() -> Required::Table;
        deserialize_struct(name: &'static str, fields: &'static [&'static str]) -> Required::Table;
        deserialize_enum(name: &'static str, variants: &'static [&'static str]) -> Required::Any;
        deserialize_identifier() -> Required::Any;
        deserialize_ignored_any() -> Required::Any;
    }
}

macro_rules! pass_on {
    ($($method:ident: $type:ty,)*) => {
        $(
            fn $method<E: Error>(self, value: $type) -> Result<V::Value, E> {
                self.0.$method(value)
            }
        )*
    };
}

impl<'de, V: Visitor<'de>> Visitor<'de> for StrictVisitor<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.expecting(f)
    }

    pass_on! {
        visit_bool: bool,
        visit_i8: i8,
        visit_i16: i16,
        visit_i32: i32,
        visit_i64: i64,
        visit_i128: i128,
        visit_u8: u8,
        visit_u16: u16,
        visit_u32: u32,
        visit_u64: u64,
        visit_u128: u128,
        visit_f32: f32,
        visit_f64: f64,
        visit_char: char,
        visit_str: &str,
        visit_borrowed_str: &'de str,
        visit_string: String,
        visit_bytes: &[u8],
        visit_borrowed_bytes: &'de [u8],
        visit_byte_buf: Vec<u8>,
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_none()
    }
    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_unit()
    }
    fn visit_some<D: Deserializer<'de>>(self, inner: D) -> Result<V::Value, D::Error> {
        self.0.visit_some(Strict(inner))
    }
    fn visit_newtype_struct<D: Deserializer<'de>>(self, inner: D) -> Result<V::Value, D::Error> {
        self.0.visit_newtype_struct(Strict(inner))
    }
    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(Strict(map))
    }
    fn visit_enum<A: EnumAccess<'de>>(self, choice: A) -> Result<V::Value, A::Error> {
        self.0.visit_enum(Strict(choice))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<V::Value, A::Error> {
        match self.1 {
            Required::Any => self.0.visit_seq(Strict(list)),
            Required::Table => Err(A::Error::invalid_type(Unexpected::Seq, &"a map")),
            Required::Length(length) => {
                let value = self.0.visit_seq(Strict(&mut list))?;
                let mut found = length;
                while list.next_element::<IgnoredAny>()?.is_some() {
                    found += 1;
                }
                if found == length {
                    return Ok(value);
                }
                let expected = format!("an array of length {length}");
                Err(A::Error::invalid_length(found, &expected.as_str()))
            }
        }
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Strict<S> {
    type Value = S::Value;
    fn deserialize<D: Deserializer<'de>>(self, inner: D) -> Result<S::Value, D::Error> {
        self.0.deserialize(Strict(inner))
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Strict<A> {
    type Error = A::Error;
    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, A::Error> {
        self.0.next_element_seed(Strict(seed))
    }
    fn size_hint(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Strict<A> {
    type Error = A::Error;
    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, A::Error> {
        self.0.next_key_seed(seed)
    }
    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, A::Error> {
        self.0.next_value_seed(Strict(seed))
    }
    fn size_hint(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

impl<'de, A: EnumAccess<'de>> EnumAccess<'de> for Strict<A> {
    type Error = A::Error;
    type Variant = Strict<A::Variant>;
    fn variant_seed<T: DeserializeSeed<'de>>(
        self,
        seed: T,
    ) -> Result<(T::Value, Self::Variant), A::Error> {
        let (value, variant) = self.0.variant_seed(seed)?;
        Ok((value, Strict(variant)))
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for Strict<A> {
    type Error = A::Error;
    fn unit_variant(self) -> Result<(), A::Error> {
        self.0.unit_variant()
    }
    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, A::Error> {
        self.0.newtype_variant_seed(Strict(seed))
    }
    fn tuple_variant<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        let visitor = StrictVisitor(visitor, Required::Length(length));
        self.0.tuple_variant(length, visitor)
    }
    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        let visitor = StrictVisitor(visitor, Required::Table);
        self.0.struct_variant(fields, visitor)
    }
}
