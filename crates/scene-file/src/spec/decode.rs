//! Reading of structures from parsed text.
//!
//! serde's internally tagged enums and flattened maps lose the byte ranges of their values. So tables
//! with a `kind` are rewritten to externally tagged ones first, and the open tables are split into
//! the keys of the format and those of the registered type, all with their byte ranges.

use core::ops::Range;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::node::{Entry, Node, Value};
use super::{Material, Parameters, SceneSpec, change, former};
use powerhouse_scene::{Fault, Problem};

/// Keys whose table, or whose tables in an array, have a variant selected by `kind`.
const TAGGED: [&str; 12] = [
    "added_mass",
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
    "target",
];
/// Key of a tagged table in whose place a text may stand, and this text.
const ABSENT: (&str, &str) = ("damping", "none");
/// Open tables, by the way to them, and their keys that belong to the scene format.
type Open = (&'static [&'static str], &'static [&'static str]);
const MATERIAL: Open = (&["material"], &["name", "law", "pore_water"]);
const OUTPUT: Open = (&["output", "own"], &["name", "kind"]);
const JOINT: Open = (
    &["joint"],
    &[
        "name",
        "between",
        "facets",
        "tolerance",
        "corner",
        "law",
        "preload",
        "water",
        "gap",
        "unbonded",
    ],
);
const BOUNDARY: Open = (&[crate::keys::BOUNDARY_TABLE], &crate::keys::BOUNDARY);

/// Reads the scene of parsed tables, or a case of it; as the scene itself if there is no such case.
///
/// # Errors
/// The first fault with its byte range: an unknown or missing key, a value of a wrong type or outside its range; a table
/// that the case changes and the scene does not have.
pub(super) fn scene(tables: &Node, case: Option<&str>) -> Result<SceneSpec, Fault> {
    let mut root = tables.clone();
    tag_tables(&mut root)?;
    if let Some(case) = case {
        change::apply(&mut root, case)?;
    }
    let [materials, joints, boundary, outputs] =
        [MATERIAL, JOINT, BOUNDARY, OUTPUT].map(|open| split(&mut root, open));
    let mut scene: SceneSpec = root.read()?;
    give(
        scene.materials.iter_mut().map(|m| &mut m.parameters),
        materials,
    );
    give(scene.joints.iter_mut().map(|j| &mut j.parameters), joints);
    give(
        scene.boundary.iter_mut().map(|b| &mut b.parameters),
        boundary,
    );
    let of_outputs = scene.output.own.iter_mut();
    give(of_outputs.map(|output| &mut output.parameters), outputs);
    let Some(case) = case else {
        return Ok(scene);
    };
    let found = scene.cases.iter().find(|found| *found.name == case);
    Ok(match found {
        Some(case) => scene.with_case(case),
        None => scene,
    })
}

/// Reads a structure whose tables with a `kind` are those of scenes.
pub(crate) fn decode_tagged<T: DeserializeOwned>(text: &str) -> Result<T, Fault> {
    let mut root = Node::parse(text)?;
    former::rename(&mut root)?;
    tag_tables(&mut root)?;
    root.read()
}

/// Reads only the materials of a text.
pub(crate) fn decode_materials(text: &str) -> Result<Vec<Material>, Fault> {
    #[derive(Deserialize)]
    struct Materials {
        #[serde(rename = "material")]
        materials: Vec<Material>,
    }
    let mut root = Node::parse(text)?;
    former::rename(&mut root)?;
    tag_tables(&mut root)?;
    let own = split(&mut root, MATERIAL);
    let Materials { mut materials } = root.read()?;
    give(materials.iter_mut().map(|m| &mut m.parameters), own);
    Ok(materials)
}

/// Gives open tables their own keys, in the same order.
fn give<'a>(of: impl Iterator<Item = &'a mut Parameters>, own: Vec<Parameters>) {
    for (parameters, own) in of.zip(own) {
        *parameters = own;
    }
}

/// Removes the parameters from the open tables of a section and returns them, table by table; shared keys
/// remain. Values that are not tables are left for serde to reject.
fn split(root: &mut Node, (way, shared): Open) -> Vec<Parameters> {
    let of_table = |node: &mut Node| {
        let span = node.span.clone();
        let table = node.as_table_mut();
        let own = table.map(|table| table.split(|key| shared.contains(&key)));
        Parameters::new(Node::table(span, own.unwrap_or_default()), shared)
    };
    let start = Some(root);
    let found = way
        .iter()
        .fold(start, |node, key| node?.as_table_mut()?.get_mut(key));
    match found {
        Some(Node {
            value: Value::List(items),
            ..
        }) => items.iter_mut().map(of_table).collect(),
        Some(table) => vec![of_table(table)],
        None => Vec::new(),
    }
}

/// Turns `{ kind = "a", rest }` into `{ a = { rest } }` under the tagged keys.
pub(super) fn tag_tables(node: &mut Node) -> Result<(), Fault> {
    let Some(table) = node.as_table_mut() else {
        return Ok(());
    };
    for (key, entry) in table.iter_mut() {
        let may_be_text = key == ABSENT.0;
        let is_absent = may_be_text && entry.node.as_text() == Some(ABSENT.1);
        let tagged = TAGGED.contains(&key) && !is_absent;
        let expected = if may_be_text {
            "a table with the key 'kind', or \"none\""
        } else {
            "a table with the key 'kind'"
        };
        tag(&mut entry.node, tagged.then_some(expected))?;
    }
    Ok(())
}

/// Tags a value, or the items of a list, if a form is expected.
fn tag(node: &mut Node, expected: Option<&str>) -> Result<(), Fault> {
    if let Value::List(items) = &mut node.value {
        return items.iter_mut().try_for_each(|item| tag(item, expected));
    }
    tag_tables(node)?;
    let Some(expected) = expected else {
        return Ok(());
    };
    let (span, found) = (node.span.clone(), node.type_name());
    let Some(table) = node.as_table_mut() else {
        return Err(value(span, found, expected));
    };
    let Some(Entry { node: kind, .. }) = table.remove("kind") else {
        let key = "kind".to_owned();
        return Err(Fault::new(span, Problem::MissingKey { key }));
    };
    let Some(name) = kind.as_text() else {
        return Err(value(
            kind.span.clone(),
            kind.type_name(),
            "a text in quotes",
        ));
    };
    let rest = Node::table(span, core::mem::take(table));
    let (key, node) = (kind.span.clone(), rest);
    table.insert(name, Entry { key, node });
    Ok(())
}

fn value(span: Range<usize>, found: &str, expected: &str) -> Fault {
    let (found, expected) = (found.into(), expected.into());
    Fault::new(span, Problem::Value { found, expected })
}

/// Turns `{ a = { rest } }` and the text `a` into `{ kind = "a", rest }` under the tagged keys: the reverse of reading.
pub(super) fn untag_tables(table: &mut toml::Table) {
    for (key, value) in table.iter_mut() {
        let is_absent = *key == ABSENT.0 && value.as_str() == Some(ABSENT.1);
        untag(value, TAGGED.contains(&&**key) && !is_absent);
    }
}

fn untag(value: &mut toml::Value, tagged: bool) {
    match value {
        toml::Value::Array(items) => items.iter_mut().for_each(|item| untag(item, tagged)),
        toml::Value::String(kind) if tagged => {
            let kind = core::mem::take(kind);
            *value = toml::Table::from_iter([("kind".to_owned(), kind.into())]).into();
        }
        toml::Value::Table(table) => {
            if tagged && let Some((kind, rest)) = core::mem::take(table).into_iter().next() {
                if let toml::Value::Table(rest) = rest {
                    *table = rest;
                }
                table.insert("kind".into(), kind.into());
            }
            untag_tables(table);
        }
        _ => {}
    }
}
