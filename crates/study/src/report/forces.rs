//! Section forces of linings and floors.

use powerhouse::io::{TableColumn, read_table};

use super::page::Table;
use super::{CaseFiles, column};
use crate::StudyError;
use crate::rounded::rounded;

/// Columns of a cut (N/m and N m/m), and what they are called.
const FORCES: [(&str, &str, &str); 3] = [
    ("axial_per_metre", "N", "kN/m"),
    ("shear_per_metre", "Q", "kN/m"),
    ("moment_per_metre", "M", "kN m/m"),
];

/// The least and the greatest force of each cut of a case with their times, and the force at rest; nothing
/// if there are no cuts.
pub(super) fn table(case: &CaseFiles) -> Result<Option<Table>, StudyError> {
    let file = case.folder.join("sections.csv");
    if !file.exists() {
        return Ok(None);
    }
    let columns = read_table(&file).map_err(powerhouse::Error::from)?;
    let Some((time, others)) = columns.split_first() else {
        return Ok(None);
    };
    let cuts = others.iter().filter_map(|column| {
        let (cut, force) = column.name.rsplit_once('.')?;
        (force == FORCES[0].0).then_some(cut)
    });
    let rows = cuts.map(|cut| {
        let forces = FORCES.iter().flat_map(|(name, ..)| {
            let found = column(others, &format!("{cut}.{name}"));
            found.map_or_else(
                || vec![String::new(); 3],
                |force| cells(&time.values, force),
            )
        });
        std::iter::once(cut.to_owned()).chain(forces).collect()
    });
    let head = FORCES.iter().flat_map(|(_, letter, unit)| {
        [
            format!("{letter} at rest ({unit})"),
            format!("least {letter} (s)"),
            format!("greatest {letter} (s)"),
        ]
    });
    Ok(Some(Table {
        head: std::iter::once("cut".to_owned()).chain(head).collect(),
        rows: rows.collect(),
    }))
}

/// The first value of a force, the least and the greatest with their times.
fn cells(times: &[f64], force: &TableColumn) -> Vec<String> {
    let all = || force.values.iter().copied().zip(times.iter().copied());
    let least = all().min_by(|a, b| a.0.total_cmp(&b.0));
    let greatest = all().max_by(|a, b| a.0.total_cmp(&b.0));
    let told = |found: Option<(f64, f64)>| {
        found.map_or(String::new(), |(value, time)| {
            format!("{} ({time:.2})", rounded(1e-3 * value))
        })
    };
    let first = force.values.first();
    let first = first.map_or(String::new(), |value| rounded(1e-3 * value));
    vec![first, told(least), told(greatest)]
}
