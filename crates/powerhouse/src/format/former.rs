//! Former names of keys, which are still read.

use std::borrow::Cow;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::fault::{Fault, Problem};
use crate::keys;

/// Key of a scene file that has another name now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormerKey {
    /// Table of the key.
    pub table: &'static str,
    /// The former name and the present one.
    pub names: &'static [&'static str; 2],
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
pub(super) fn rename(root: &mut DeTable) -> Result<Vec<FormerKey>, Fault> {
    let mut found = Vec::new();
    let has_springs = is_of_springs(root.get(keys::BOUNDARY_TABLE), true);
    tables(root, has_springs, &mut found)?;
    if let Some(DeValue::Table(output)) = root.get_mut("output").map(Spanned::get_mut) {
        in_tables(output, "history", HISTORY, &mut found)?;
        in_tables(output, "section", SECTION, &mut found)?;
    }
    for case in items(root, "case") {
        let own = is_of_springs(case.get(keys::BOUNDARY_TABLE), has_springs);
        tables(case, own, &mut found)?;
    }
    Ok(found)
}

/// Whether a boundary is of springs and dashpots; as `otherwise` if it does not say.
fn is_of_springs(boundary: Option<&Spanned<DeValue>>, otherwise: bool) -> bool {
    let table = boundary.and_then(|boundary| boundary.get_ref().as_table());
    let kind = table.and_then(|table| table.get(keys::KIND)?.get_ref().as_str());
    kind.map_or(otherwise, |kind| kind == keys::VISCOUS_SPRING)
}

/// Renames the keys of the tables that scenes and cases have.
fn tables(root: &mut DeTable, has_springs: bool, found: &mut Vec<FormerKey>) -> Result<(), Fault> {
    in_tables(root, PART.table, PART, found)?;
    in_tables(root, STAGE.table, STAGE, found)?;
    let boundary = root.get_mut(keys::BOUNDARY_TABLE).map(Spanned::get_mut);
    if let (Some(DeValue::Table(boundary)), true) = (boundary, has_springs) {
        for former in SPRINGS {
            rename_key(boundary, former, found)?;
            for axis in keys::AXES {
                if let Some(DeValue::Table(axis)) = boundary.get_mut(axis).map(Spanned::get_mut) {
                    rename_key(axis, former, found)?;
                }
            }
        }
    }
    Ok(())
}

fn in_tables(
    root: &mut DeTable,
    section: &str,
    former: FormerKey,
    found: &mut Vec<FormerKey>,
) -> Result<(), Fault> {
    items(root, section).try_for_each(|table| rename_key(table, former, found))
}

/// The tables of a section.
fn items<'a, 't>(
    table: &'a mut DeTable<'t>,
    section: &str,
) -> impl Iterator<Item = &'a mut DeTable<'t>> {
    let items = match table.get_mut(section).map(Spanned::get_mut) {
        Some(DeValue::Array(items)) => Some(items.iter_mut()),
        _ => None,
    };
    items
        .into_iter()
        .flatten()
        .filter_map(|item| match item.get_mut() {
            DeValue::Table(table) => Some(table),
            _ => None,
        })
}

fn rename_key(
    table: &mut DeTable,
    former: FormerKey,
    found: &mut Vec<FormerKey>,
) -> Result<(), Fault> {
    let [old, new] = *former.names;
    let Some((key, value)) = table.remove_entry(old) else {
        return Ok(());
    };
    if table.contains_key(new) {
        let (keys, found) = (former.names, 2);
        return Err(Fault::new(key.span(), Problem::OneOf { keys, found }));
    }
    table.insert(Spanned::new(key.span(), Cow::Borrowed(new)), value);
    if !found.contains(&former) {
        found.push(former);
    }
    Ok(())
}
