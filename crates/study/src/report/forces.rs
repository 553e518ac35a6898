//! Section forces of linings and floors.

use powerhouse::io::{TableColumn, read_table};

use super::page::Table;
use super::{CaseFiles, column};
use crate::StudyError;
use crate::rounded::rounded;

/// Columns of a section (N/m and N m/m), their symbols and units in the table.
const FORCES: [(&str, &str, &str); 3] = [
    ("axial_per_metre", "N", "kN/m"),
    ("shear_per_metre", "Q", "kN/m"),
    ("moment_per_metre", "M", "kN m/m"),
];

/// The static, the least and the greatest force of each section of a case, the latter with their times; `None` without
/// sections.
pub(super) fn table(case: &CaseFiles) -> Result<Option<Table>, StudyError> {
    let file = case.folder.join("sections.csv");
    if !file.exists() {
        return Ok(None);
    }
    let columns = read_table(&file).map_err(powerhouse::Error::from)?;
    let Some((time, others)) = columns.split_first() else {
        return Ok(None);
    };
    let sections = others.iter().filter_map(|column| {
        let (section, force) = column.name.rsplit_once('.')?;
        (force == FORCES[0].0).then_some(section)
    });
    let rows = sections.map(|section| {
        let forces = FORCES.iter().flat_map(|(name, ..)| {
            let found = column(others, &format!("{section}.{name}"));
            found.map_or_else(
                || vec![String::new(); 3],
                |force| cells(&time.values, force),
            )
        });
        std::iter::once(section.to_owned()).chain(forces).collect()
    });
    let header = FORCES.iter().flat_map(|(_, letter, unit)| {
        [
            format!("{letter} static ({unit})"),
            format!("least {letter} (s)"),
            format!("greatest {letter} (s)"),
        ]
    });
    Ok(Some(Table {
        header: std::iter::once("section".to_owned())
            .chain(header)
            .collect(),
        rows: rows.collect(),
    }))
}

/// The first value of a force, and the least and the greatest with their times.
fn cells(times: &[f64], force: &TableColumn) -> Vec<String> {
    let all = || force.values.iter().copied().zip(times.iter().copied());
    let least = all().min_by(|a, b| a.0.total_cmp(&b.0));
    let greatest = all().max_by(|a, b| a.0.total_cmp(&b.0));
    let text = |found: Option<(f64, f64)>| {
        found.map_or(String::new(), |(value, time)| {
            format!("{} ({time:.2})", rounded(1e-3 * value))
        })
    };
    let first = force.values.first();
    let first = first.map_or(String::new(), |value| rounded(1e-3 * value));
    vec![first, text(least), text(greatest)]
}
