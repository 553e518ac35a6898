//! Application of a case's changed keys to the tables of the scene.
//!
//! The keys are replaced before the tables are deserialised: so every key of a law or a record can be changed,
//! and a fault in a changed key is reported at its position in the case.

use super::node::{Node, Table};
use powerhouse_scene::{Fault, Problem};

/// Tables that a case may change, with the key that selects one of them.
pub(crate) const NAMED: [(&str, &str); 6] = [
    ("material", "name"),
    ("part", "set"),
    ("joint", "name"),
    ("record", "name"),
    ("bolt", "name"),
    ("stage", "name"),
];
/// Tables whose keys belong to what one of them names, with that key and the keys beside: a change that names another law or
/// kind keeps the latter alone.
const OF_KIND: [(&str, &str, &[&str]); 3] = [
    ("material", "law", &["name", "pore_water"]),
    (
        "boundary",
        "kind",
        &["faces", "scatterer", "through", "region", "stations"],
    ),
    (
        "joint",
        "law",
        &[
            "name",
            "between",
            "facets",
            "tolerance",
            "corner",
            "preload",
            "water",
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
pub(super) fn apply(root: &mut Node, case: &str) -> Result<(), Fault> {
    let Some(root) = root.as_table_mut() else {
        return Ok(());
    };
    let Some(own) = table_of(root, "case", ("name", case)).cloned() else {
        return Ok(());
    };
    for (section, key) in NAMED {
        for change in own.tables(section) {
            let Some(name) = change.get(key) else {
                continue;
            };
            let Some(wanted) = name.as_text() else {
                continue;
            };
            let names = root.tables(section).filter_map(|table| text(table, key));
            let available: Vec<String> = names.map(str::to_owned).collect();
            let Some(table) = table_of(root, section, (key, wanted)) else {
                let problem = Problem::NoSuchName {
                    what: section,
                    name: wanted.into(),
                    available,
                };
                return Err(Fault::new(name.span.clone(), problem));
            };
            replace(table, change, (section, key));
        }
    }
    for section in SINGLE {
        let change = own.get(section).and_then(Node::as_table);
        let table = root.get_mut(section).and_then(Node::as_table_mut);
        if let (Some(change), Some(table)) = (change, table) {
            replace(table, change, (section, ""));
        }
    }
    Ok(())
}

/// Replaces keys of a table of a section by the changed ones, except the key that selects the table. Of another law or kind
/// than before the table has none of the former keys.
fn replace(table: &mut Table, change: &Table, (section, name): (&str, &str)) {
    if let Some((_, kind, kept)) = OF_KIND.iter().find(|(of, ..)| *of == section)
        && let (Some(new), Some(old)) = (text(change, kind), text(table, kind))
        && new != old
    {
        table.split(|key| kept.contains(&key));
    }
    for (key, entry) in change.iter().filter(|(key, _)| *key != name) {
        table.insert(key, entry.clone());
    }
}

/// First table of a section in which a key has the given value.
fn table_of<'a>(
    root: &'a mut Table,
    section: &str,
    (key, value): (&str, &str),
) -> Option<&'a mut Table> {
    let mut tables = root.tables_mut(section);
    tables.find(|table| text(table, key) == Some(value))
}

/// Text of a key.
fn text<'a>(table: &'a Table, key: &str) -> Option<&'a str> {
    table.get(key)?.as_text()
}

#[cfg(test)]
mod tests {
    use schemars::{JsonSchema, schema_for};

    use super::OF_KIND;
    use crate::spec::{BoundarySection, JointSection, Material};

    fn keys<T: JsonSchema>() -> Vec<String> {
        let schema = schema_for!(T);
        let keys = schema.get("properties").and_then(|all| all.as_object());
        keys.unwrap().keys().cloned().collect()
    }

    /// The keys beside those of a law or kind are all keys that its table has, but for the one that names it.
    #[test]
    fn keys_beside_a_law_are_those_of_its_table() {
        for (section, keys) in [
            ("material", keys::<Material>()),
            ("boundary", keys::<BoundarySection>()),
            ("joint", keys::<JointSection>()),
        ] {
            let (_, kind, kept) = OF_KIND.iter().find(|(of, ..)| *of == section).unwrap();
            let mut kept = [kept, &[*kind][..]].concat();
            kept.sort_unstable();
            let mut keys = keys;
            keys.sort_unstable();
            assert_eq!(keys, kept, "{section}");
        }
    }
}
