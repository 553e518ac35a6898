//! Reading of a [`SceneFile`] from text, with the byte range of every value.
//!
//! serde's internally tagged enums and flattened maps lose the byte ranges of their values. So tables
//! with a `kind` are rewritten to externally tagged ones first, and the open tables are split into
//! the keys of the format and those of the registered type, all with their byte ranges.

use std::sync::Arc;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer};

use super::former::{self, FormerKey};
use super::strict::Strict;
use super::{Material, Parameters, SceneFile, change};
use crate::fault::{Fault, Problem};

/// Keys whose table, or whose tables in an array, have a variant selected by `kind`.
const TAGGED: [&str; 10] = [
    "baseline",
    "damping",
    "function",
    "in_situ_stress",
    "leg",
    "load",
    "preload",
    "pulse",
    "strain_curves",
    "support",
];
/// Key of a tagged table in whose place a text may stand, and this text.
const ABSENT: (&str, &str) = ("damping", "none");
/// Open tables, and their keys that belong to the scene format.
const MATERIAL: (&str, &[&str]) = ("material", &["name", "law"]);
const JOINT: (&str, &[&str]) = (
    "joint",
    &[
        "name",
        "between",
        "facets",
        "tolerance",
        "corner",
        "law",
        "preload",
        "gap",
        "unbonded",
    ],
);
const BOUNDARY: (&str, &[&str]) = (crate::keys::BOUNDARY_TABLE, &crate::keys::BOUNDARY);

/// Reads a scene from text.
///
/// # Errors
/// The first fault with its byte range: invalid syntax, an unknown or missing key, a value of a wrong
/// type or outside its range.
pub fn decode(text: &str) -> Result<SceneFile, Fault> {
    read(text, None)
}

/// Reads a scene with the changes of one of its cases; as [`decode`] if there is no such case.
///
/// # Errors
/// As [`decode`]; a table that the case changes and the scene does not have.
pub fn decode_case(text: &str, case: &str) -> Result<SceneFile, Fault> {
    let scene = read(text, Some(case))?;
    let found = scene.cases.iter().find(|found| *found.name == case);
    Ok(match found {
        Some(case) => scene.with_case(case),
        None => scene,
    })
}

fn read(text: &str, case: Option<&str>) -> Result<SceneFile, Fault> {
    let mut root = tree_of(text, case)?;
    for (section, shared) in [MATERIAL, JOINT, BOUNDARY] {
        split(root.get_mut(), section, shared);
    }
    let mut scene =
        SceneFile::deserialize(Strict(Deserializer::from(root))).map_err(Fault::from_toml)?;
    let text = Source::of(text, case);
    for (index, material) in scene.materials.iter_mut().enumerate() {
        material.parameters = Parameters::new(text.clone(), (MATERIAL.0, index), MATERIAL.1);
    }
    for (index, joint) in scene.joints.iter_mut().enumerate() {
        joint.parameters = Parameters::new(text.clone(), (JOINT.0, index), JOINT.1);
    }
    if let Some(boundary) = &mut scene.boundary {
        boundary.parameters = Parameters::new(text, (BOUNDARY.0, 0), BOUNDARY.1);
    }
    Ok(scene)
}

/// Text of a scene, and the name of the selected case.
#[derive(Clone, Debug, Default)]
pub(super) struct Source {
    text: Arc<str>,
    case: Option<Arc<str>>,
}

impl Source {
    fn of(text: &str, case: Option<&str>) -> Self {
        Self {
            text: text.into(),
            case: case.map(Into::into),
        }
    }
    /// Parses the text into a tree.
    pub(super) fn tree(&self) -> Result<Spanned<DeTable<'_>>, Fault> {
        tree_of(&self.text, self.case.as_deref())
    }
}

/// Keys of a scene's text, and of its cases, that have other names now.
///
/// # Errors
/// Invalid syntax; a key under both names.
pub(crate) fn former_keys(text: &str) -> Result<Vec<FormerKey>, Fault> {
    let mut root = DeTable::parse(text).map_err(Fault::from_toml)?;
    former::rename(root.get_mut())
}

/// Reads a structure whose tables with a `kind` are those of scenes.
pub(crate) fn decode_tagged<T: DeserializeOwned>(text: &str) -> Result<T, Fault> {
    T::deserialize(Strict(Deserializer::from(tree(text)?))).map_err(Fault::from_toml)
}

/// Reads only the materials of a text.
pub(crate) fn decode_materials(text: &str) -> Result<Vec<Material>, Fault> {
    #[derive(Deserialize)]
    struct Materials {
        #[serde(rename = "material")]
        materials: Vec<Material>,
    }
    let mut root = tree(text)?;
    split(root.get_mut(), MATERIAL.0, MATERIAL.1);
    let read =
        Materials::deserialize(Strict(Deserializer::from(root))).map_err(Fault::from_toml)?;
    let text = Source::of(text, None);
    let mut materials = read.materials;
    for (index, material) in materials.iter_mut().enumerate() {
        material.parameters = Parameters::new(text.clone(), (MATERIAL.0, index), MATERIAL.1);
    }
    Ok(materials)
}

/// Parsed text with the changes of a case applied and tagged tables rewritten.
fn tree_of<'t>(text: &'t str, case: Option<&str>) -> Result<Spanned<DeTable<'t>>, Fault> {
    let mut root = tree(text)?;
    if let Some(case) = case {
        change::apply(root.get_mut(), case)?;
    }
    Ok(root)
}

/// Parsed text with tagged tables rewritten.
fn tree(text: &str) -> Result<Spanned<DeTable<'_>>, Fault> {
    let mut root = DeTable::parse(text).map_err(Fault::from_toml)?;
    former::rename(root.get_mut())?;
    tag_tables(root.get_mut())?;
    Ok(root)
}

/// Removes the parameters from the open tables of a section and returns them, table by table; shared keys
/// remain. Values that are not tables are left for serde to reject.
pub(super) fn split<'t>(
    root: &mut DeTable<'t>,
    section: &str,
    shared: &[&str],
) -> Vec<Spanned<DeTable<'t>>> {
    match root
        .get_mut(section)
        .map(|value| (value.span(), value.get_mut()))
    {
        Some((_, DeValue::Array(items))) => items
            .iter_mut()
            .map(|item| split_table(item.span(), item.get_mut(), shared))
            .collect(),
        Some((span, value)) => vec![split_table(span, value, shared)],
        None => Vec::new(),
    }
}

fn split_table<'t>(
    span: core::ops::Range<usize>,
    value: &mut DeValue<'t>,
    shared: &[&str],
) -> Spanned<DeTable<'t>> {
    let mut own = DeTable::new();
    if let DeValue::Table(table) = value {
        for (key, value) in core::mem::take(table) {
            let is_shared = shared.contains(&&**key.get_ref());
            let side = if is_shared { &mut *table } else { &mut own };
            side.insert(key, value);
        }
    }
    Spanned::new(span, own)
}

/// Turns `{ kind = "a", rest }` into `{ a = { rest } }` under the tagged keys.
fn tag_tables(table: &mut DeTable) -> Result<(), Fault> {
    for (key, value) in table.iter_mut() {
        let is_absent = **key.get_ref() == *ABSENT.0 && value.get_ref().as_str() == Some(ABSENT.1);
        let tagged = TAGGED.contains(&&**key.get_ref()) && !is_absent;
        let expected = match **key.get_ref() == *ABSENT.0 {
            true => "a table with the key 'kind', or \"none\"",
            false => "a table with the key 'kind'",
        };
        tag(value, tagged.then_some(expected))?;
    }
    Ok(())
}

/// Tags a value, or the items of a list, if a form is expected.
fn tag(value: &mut Spanned<DeValue>, expected: Option<&str>) -> Result<(), Fault> {
    let span = value.span();
    match value.get_mut() {
        DeValue::Array(items) => {
            for item in items.iter_mut() {
                tag(item, expected)?;
            }
        }
        DeValue::Table(table) => {
            tag_tables(table)?;
            if expected.is_some() {
                let key = "kind".to_owned();
                let Some(kind) = table.remove("kind") else {
                    return Err(Fault::new(span, Problem::MissingKey { key }));
                };
                let kind_span = kind.span();
                let kind = match kind.into_inner() {
                    DeValue::String(kind) => kind,
                    other => {
                        let found = format!("{} {}", article(other.type_str()), other.type_str());
                        let expected = "a text in quotes".into();
                        return Err(Fault::new(kind_span, Problem::Value { found, expected }));
                    }
                };
                let rest = DeValue::Table(core::mem::take(table));
                table.insert(Spanned::new(kind_span, kind), Spanned::new(span, rest));
            }
        }
        other => {
            if let Some(expected) = expected {
                let found = format!("{} {}", article(other.type_str()), other.type_str());
                let expected = expected.into();
                return Err(Fault::new(span, Problem::Value { found, expected }));
            }
        }
    }
    Ok(())
}

fn article(noun: &str) -> &'static str {
    if noun.starts_with(['a', 'i']) {
        "an"
    } else {
        "a"
    }
}
