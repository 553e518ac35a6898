//! Keys that a case changes in the tables of a scene.
//!
//! They are put in their places before anything is read of the tables: so whatever a law or a record
//! wants can be changed, and a fault in it is shown where it stands, in the case.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::fault::{Fault, Problem};

/// Tables that a case changes, with the key that says which of the scene's it means.
const NAMED: [(&str, &str); 6] = [
    ("material", "name"),
    ("part", "set"),
    ("joint", "name"),
    ("record", "name"),
    ("bolt", "name"),
    ("stage", "name"),
];
/// Tables of which a scene has one.
const SINGLE: [&str; 2] = ["boundary", "time"];

/// Puts the keys of a case in their places. What has not the shape of a change is left for serde to
/// refuse.
///
/// # Errors
/// A table that the scene does not have.
pub(super) fn apply(root: &mut DeTable, case: &str) -> Result<(), Fault> {
    let Some(own) = table_of(root, "case", ("name", case)).map(|own| own.clone()) else {
        return Ok(());
    };
    for (section, key) in NAMED {
        for change in items(&own, section).into_iter().flatten() {
            let Some(name) = text(change, key) else {
                continue;
            };
            let Some(table) = table_of(root, section, (key, name.get_ref())) else {
                let tables = items(root, section).into_iter().flatten();
                let names = tables.filter_map(|table| text(table, key));
                let problem = Problem::NoSuchName {
                    what: section,
                    name: (*name.get_ref()).into(),
                    available: names.map(|name| (*name.get_ref()).into()).collect(),
                };
                return Err(Fault::new(name.span(), problem));
            };
            put(table, change, key);
        }
    }
    for section in SINGLE {
        if let Some(DeValue::Table(change)) = own.get(section).map(Spanned::get_ref)
            && let Some(DeValue::Table(table)) = root.get_mut(section).map(Spanned::get_mut)
        {
            put(table, change, "");
        }
    }
    Ok(())
}

/// Replaces the keys of a table by those of a change, but for the one that names it.
fn put<'t>(table: &mut DeTable<'t>, change: &DeTable<'t>, name: &str) {
    for (key, value) in change {
        if key.get_ref() != name {
            // A key keeps its first place unless it goes first.
            table.remove(&**key.get_ref());
            table.insert(key.clone(), value.clone());
        }
    }
}

/// The tables of a section.
fn items<'a, 't>(
    table: &'a DeTable<'t>,
    section: &str,
) -> Option<impl Iterator<Item = &'a DeTable<'t>>> {
    let DeValue::Array(items) = table.get(section)?.get_ref() else {
        return None;
    };
    Some(items.iter().filter_map(|item| match item.get_ref() {
        DeValue::Table(table) => Some(table),
        _ => None,
    }))
}

/// The table of a section in which a key has a value.
fn table_of<'a, 't>(
    root: &'a mut DeTable<'t>,
    section: &str,
    (key, value): (&str, &str),
) -> Option<&'a mut DeTable<'t>> {
    let DeValue::Array(items) = root.get_mut(section)?.get_mut() else {
        return None;
    };
    items.iter_mut().find_map(|item| match item.get_mut() {
        DeValue::Table(table)
            if text(table, key).is_some_and(|found| *found.get_ref() == value) =>
        {
            Some(table)
        }
        _ => None,
    })
}

/// The text of a key, with its place.
fn text<'a>(table: &'a DeTable, key: &str) -> Option<Spanned<&'a str>> {
    let value = table.get(key)?;
    match value.get_ref() {
        DeValue::String(text) => Some(Spanned::new(value.span(), &**text)),
        _ => None,
    }
}
