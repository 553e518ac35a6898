//! Section forces of linings and floors.

use std::path::Path;

use powerhouse::io::{TableColumn, read_table};
use powerhouse::summary::UtilisationSummary;

use super::ReportTable;
use super::column;
use powerhouse_study::StudyError;
use powerhouse_study::internal::rounded;
use powerhouse_study::sweep::{CaseOutcome, Utilisation};

/// Columns of a section (N/m and N m/m), their symbols and units in the table.
const FORCES: [(&str, &str, &str); 3] = [
    ("axial_per_metre", "N", "kN/m"),
    ("shear_per_metre", "Q", "kN/m"),
    ("moment_per_metre", "M", "kN m/m"),
];

/// What the forces and columns of the tables are.
pub(super) const MEANING: &str = "Normal force N (tension positive), shear force Q and bending moment M of sections through \
     linings and floors, per metre along them: static, and the least and greatest of the run with their times.";

/// The table of the greatest utilisation of each reinforced section of a run; `None` without one.
pub(super) fn utilisation(uses: &[UtilisationSummary]) -> Option<ReportTable> {
    let thousands = |value: f64| rounded(1e-3 * value);
    let row = |of: &UtilisationSummary| {
        let borne = |[least, greatest]: [f64; 2]| {
            format!("{} to {}", thousands(least), thousands(greatest))
        };
        vec![
            of.section.clone(),
            of.utilisation.map_or("beyond".to_owned(), rounded),
            format!("{:.2}", of.time),
            thousands(of.axial),
            thousands(of.moment),
            of.borne.map_or("none".to_owned(), borne),
            rounded(of.thickness),
            (of.beyond_from).map_or("never".to_owned(), |time| format!("from {time:.2} s")),
        ]
    };
    (!uses.is_empty()).then(|| ReportTable {
        header: [
            "section",
            "greatest utilisation",
            "at (s)",
            "N (kN/m)",
            "M (kN m/m)",
            "M borne with N (kN m/m)",
            "thickness (m)",
            "beyond",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: uses.iter().map(row).collect(),
    })
}

/// The extremes of each ring, and of each section that is of none, a line for each case; `None` without sections.
pub(super) fn of_cases(outcomes: &[CaseOutcome]) -> Option<ReportTable> {
    let mut names: Vec<&str> = Vec::new();
    for section in outcomes.iter().flat_map(|outcome| &outcome.sections) {
        if !names.contains(&section.name.as_str()) {
            names.push(&section.name);
        }
    }
    let row = |name: &str, outcome: &CaseOutcome| {
        let section = outcome.sections.iter().find(|of| of.name == name)?;
        let forces = [&section.axial, &section.shear, &section.moment];
        let forces = forces.into_iter().flatten();
        let utilisation = section.utilisation.map(|of| match of {
            Utilisation::Of(value) => rounded(value),
            Utilisation::Beyond => "beyond".to_owned(),
        });
        let names = [name.to_owned(), outcome.name.clone()].into_iter();
        let forces = forces.map(|peak| rounded(1e-3 * peak.value));
        Some(names.chain(forces).chain(utilisation).collect())
    };
    let rows: Vec<Vec<String>> = (names.iter())
        .flat_map(|name| outcomes.iter().filter_map(|outcome| row(name, outcome)))
        .collect();
    let extremes = FORCES.iter().flat_map(|(_, letter, _)| {
        ["least", "greatest"].map(|extreme| format!("{extreme} {letter}"))
    });
    let heads = ["section", "case"].into_iter().map(str::to_owned);
    let mut header: Vec<String> = heads.chain(extremes).collect();
    if rows.iter().any(|row| row.len() > header.len()) {
        header.push("greatest utilisation".into());
    }
    let columns = header.len();
    let rows = rows.into_iter().map(|mut row| {
        row.resize(columns, String::new());
        row
    });
    let rows: Vec<_> = rows.collect();
    (!rows.is_empty()).then_some(ReportTable { header, rows })
}

/// The static, the least and the greatest force of each section in a result folder, the latter with their times; `None`
/// without sections.
pub(super) fn table(folder: &Path) -> Result<Option<ReportTable>, StudyError> {
    let file = folder.join("sections.csv");
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
    Ok(Some(ReportTable {
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
