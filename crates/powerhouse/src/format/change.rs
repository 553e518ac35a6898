//! Application of a case's changed keys to the tables of the scene.
//!
//! The keys are replaced before the tables are deserialised: so every key of a law or a record can be changed,
//! and a fault in a changed key is reported at its position in the case.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::fault::{Fault, Problem};

/// Tables that a case may change, with the key that selects one of them.
pub(crate) const NAMED: [(&str, &str); 6] = [
    ("material", "name"),
    ("part", "set"),
    ("joint", "name"),
    ("record", "name"),
    ("bolt", "name"),
    ("stage", "name"),
];
/// Keys that tables have beside those of their `law`: a change that names another law keeps these alone.
const BESIDE_LAW: [(&str, &[&str]); 2] = [
    ("material", &["name"]),
    (
        "joint",
        &[
            "name",
            "between",
            "facets",
            "tolerance",
            "corner",
            "preload",
            "gap",
            "unbonded",
        ],
    ),
];
/// Tables that a scene has once.
const SINGLE: [&str; 2] = ["boundary", "time"];

/// Applies the changed keys of a case. Values of a wrong type are left for serde to reject.
///
/// # Errors
/// The case changes a table that the scene does not have.
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
            if let Some((_, kept)) = BESIDE_LAW.iter().find(|(of, _)| *of == section)
                && let (Some(new), Some(old)) = (text(change, "law"), text(table, "law"))
                && new.get_ref() != old.get_ref()
            {
                let keys: Vec<_> = table.keys().map(|key| key.get_ref().clone()).collect();
                for of_old in keys.iter().filter(|key| !kept.contains(&&***key)) {
                    table.remove(&**of_old);
                }
            }
            replace(table, change, key);
        }
    }
    for section in SINGLE {
        if let Some(DeValue::Table(change)) = own.get(section).map(Spanned::get_ref)
            && let Some(DeValue::Table(table)) = root.get_mut(section).map(Spanned::get_mut)
        {
            replace(table, change, "");
        }
    }
    Ok(())
}

/// Replaces keys of a table by the changed ones, except the key that selects the table.
fn replace<'t>(table: &mut DeTable<'t>, change: &DeTable<'t>, name: &str) {
    for (key, value) in change {
        if key.get_ref() != name {
            // Inserting over an existing key would keep the old key's span: remove it first.
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

/// First table of a section in which a key has the given value.
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

/// Text of a key, with its byte range.
fn text<'a>(table: &'a DeTable, key: &str) -> Option<Spanned<&'a str>> {
    let value = table.get(key)?;
    match value.get_ref() {
        DeValue::String(text) => Some(Spanned::new(value.span(), &**text)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use schemars::{JsonSchema, schema_for};

    use super::BESIDE_LAW;
    use crate::format::{JointSection, Material};

    fn keys<T: JsonSchema>() -> Vec<String> {
        let schema = schema_for!(T);
        let keys = schema.get("properties").and_then(|all| all.as_object());
        keys.unwrap().keys().cloned().collect()
    }

    /// The keys beside those of a law are all keys that its table has, but for `law`.
    #[test]
    fn keys_beside_a_law_are_those_of_its_table() {
        for (section, keys) in [
            ("material", keys::<Material>()),
            ("joint", keys::<JointSection>()),
        ] {
            let (_, kept) = BESIDE_LAW.iter().find(|(of, _)| *of == section).unwrap();
            let mut kept = [kept, &["law"][..]].concat();
            kept.sort_unstable();
            let mut keys = keys;
            keys.sort_unstable();
            assert_eq!(keys, kept, "{section}");
        }
    }
}
