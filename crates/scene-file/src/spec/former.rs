//! Former names of keys, which are still read.

use super::node::{Node, Table};
use crate::keys;
use powerhouse_scene::{Fault, Problem};

/// Key of a scene file that has another name now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FormerKey {
    /// Table of the key.
    pub(crate) table: &'static str,
    /// The former name and the present one.
    pub(crate) names: &'static [&'static str; 2],
}

const PART: FormerKey = FormerKey {
    table: "part",
    names: &["rim", "elastic_rim"],
};
const STAGE: FormerKey = FormerKey {
    table: "stage",
    names: &["bonded", "grouted"],
};
const HISTORY: FormerKey = FormerKey {
    table: "output.history",
    names: &["among", "in_set"],
};
const SECTION: FormerKey = FormerKey {
    table: "output.section",
    names: &["reach", "half_extent"],
};
/// Keys of [`keys::VISCOUS_SPRING`] and of its tables of axes; other boundaries may have keys of these names.
const SPRINGS: [FormerKey; 2] = [
    FormerKey {
        table: keys::BOUNDARY_TABLE,
        names: &["a", keys::AMPLITUDE_RATIO],
    },
    FormerKey {
        table: keys::BOUNDARY_TABLE,
        names: &["b", keys::SPEED_RATIO],
    },
];

/// Gives former keys of a scene, and of its cases, their present names, and returns those found, each once. Values keep
/// their byte ranges.
///
/// # Errors
/// A table with a key under both names.
pub(super) fn rename(root: &mut Node) -> Result<Vec<FormerKey>, Fault> {
    let mut found = Vec::new();
    let Some(root) = root.as_table_mut() else {
        return Ok(found);
    };
    let has_springs = is_of_springs(root, true);
    tables(root, has_springs, &mut found)?;
    if let Some(output) = root.get_mut("output").and_then(Node::as_table_mut) {
        in_tables(output, "history", HISTORY, &mut found)?;
        in_tables(output, "section", SECTION, &mut found)?;
    }
    for case in root.tables_mut("case") {
        let own = is_of_springs(case, has_springs);
        tables(case, own, &mut found)?;
    }
    Ok(found)
}

/// Whether the boundary of a scene or a case is of springs and dashpots; as `otherwise` if it does not say.
fn is_of_springs(root: &Table, otherwise: bool) -> bool {
    let table = root.get(keys::BOUNDARY_TABLE).and_then(Node::as_table);
    let kind = table.and_then(|table| table.get(keys::KIND)?.as_text());
    kind.map_or(otherwise, |kind| kind == keys::VISCOUS_SPRING)
}

/// Renames the keys of the tables that scenes and cases have.
fn tables(root: &mut Table, has_springs: bool, found: &mut Vec<FormerKey>) -> Result<(), Fault> {
    in_tables(root, PART.table, PART, found)?;
    in_tables(root, STAGE.table, STAGE, found)?;
    let boundary = root
        .get_mut(keys::BOUNDARY_TABLE)
        .and_then(Node::as_table_mut);
    if let (Some(boundary), true) = (boundary, has_springs) {
        for former in SPRINGS {
            rename_key(boundary, former, found)?;
            for axis in keys::AXES {
                if let Some(axis) = boundary.get_mut(axis).and_then(Node::as_table_mut) {
                    rename_key(axis, former, found)?;
                }
            }
        }
    }
    Ok(())
}

fn in_tables(
    root: &mut Table,
    section: &str,
    former: FormerKey,
    found: &mut Vec<FormerKey>,
) -> Result<(), Fault> {
    let mut tables = root.tables_mut(section);
    tables.try_for_each(|table| rename_key(table, former, found))
}

fn rename_key(
    table: &mut Table,
    former: FormerKey,
    found: &mut Vec<FormerKey>,
) -> Result<(), Fault> {
    let [old, new] = *former.names;
    let Some(entry) = table.remove(old) else {
        return Ok(());
    };
    if table.get(new).is_some() {
        let (keys, found) = (former.names, 2);
        return Err(Fault::new(entry.key, Problem::OneOf { keys, found }));
    }
    table.insert(new, entry);
    if !found.contains(&former) {
        found.push(former);
    }
    Ok(())
}
