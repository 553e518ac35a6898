//! Reports and pictures of results: one HTML page of a sweep or a run, motions as engineers read them, fields of snapshots.
//!
//! - [`write_report`] writes the results of a sweep or of a run to one self-contained HTML page; of a sweep over a set of records what
//!   they have in common on a few pages, and every case on a page of its own.
//! - [`motion`] measures recorded motions, [`floor`] draws spectra for the design of what floors carry, and [`fields`] draws what snapshots have, after a run.
//! - [`sensitivity`](fn@sensitivity) compares the cases of a sweep that vary one parameter.
//!
//! # Why so
//! *It reads only result files*, so that a report can be written again for old results and for incomplete ones, in
//! which missing results are left out.
//!
//! *Plots and pictures are embedded in the page*, so that a page can be sent as one file and the colours of a plot
//! follow the light or dark scheme of the reader.

mod charts;
pub mod fields;
pub mod floor;
mod forces;
mod fourier;
pub mod motion;
mod motions;
mod page;
mod records;
mod repetition;
mod run_warnings;
mod section;
mod sensitivity;
mod single;
mod spectra;
mod statistics;
mod sweep;
mod tables;

use std::path::{Path, PathBuf};

use powerhouse::io::{TableColumn, read_table};
use powerhouse::summary::RunSummary;

use powerhouse_study::StudyError;
use powerhouse_study::internal::{
    Accelerations, CASES, CaseEntry, FoundSummary, MARK, OUTCOME, read_json, write_text,
};
use powerhouse_study::sweep::CaseOutcome;

pub use section::{ReportItem, ReportSection, ReportTable};
pub use sensitivity::{Variation, VariedFigure, sensitivity};

/// Name of the page in the result folder.
const FILE: &str = "report.html";
/// Name of the folder of the plots of the report.
const PLOTS: &str = "report";

/// Results of a finished case of a sweep, from its files.
#[non_exhaustive]
pub struct ReportCase {
    /// Folder of the case.
    pub folder: PathBuf,
    /// Results that are compared.
    pub outcome: CaseOutcome,
    /// Histories against time, the first column.
    pub histories: Vec<TableColumn>,
    /// Accelerations from which spectra are.
    accelerations: Accelerations,
    /// Summary of the run; none of a case without files.
    pub summary: Option<RunSummary>,
    /// Contents of the fingerprint file.
    fingerprint: serde_json::Value,
}

impl ReportCase {
    /// A case without files, such as one that is made up for a test.
    pub fn of_outcome(outcome: CaseOutcome) -> Self {
        Self {
            folder: PathBuf::new(),
            outcome,
            histories: Vec::new(),
            accelerations: Accelerations::default(),
            summary: None,
            fingerprint: serde_json::Value::Null,
        }
    }

    /// Whether the case is unvaried except for its wave.
    pub fn is_plain(&self) -> bool {
        let input = &self.outcome.input;
        input.varies.is_none() && !input.continuous
    }
}

/// Writes the report `report.html` of a result folder of a sweep or a single run; returns its path.
///
/// # Errors
/// [`StudyError::NoResults`] for a folder without results; a file that cannot be read or written.
pub fn write_report(folder: impl AsRef<Path>) -> Result<PathBuf, StudyError> {
    write_report_with(folder, &[])
}

/// The same with further sections of a sweep, before its results.
///
/// # Errors
/// As [`write_report`].
pub fn write_report_with(
    folder: impl AsRef<Path>,
    sections: &[&dyn ReportSection],
) -> Result<PathBuf, StudyError> {
    let folder = folder.as_ref();
    let file = folder.join(FILE);
    let page = match read_cases(folder)? {
        Some(cases) if !cases.is_empty() => {
            let page = sweep::page(folder, &cases, sections)?;
            match records::found(folder)? {
                None => page,
                Some(found) => {
                    let of_cases = folder.join(records::CASES_PAGE);
                    write_text(&of_cases, &page.html())?;
                    records::page(folder, &cases, &found)?
                }
            }
        }
        _ => single::page(folder)?,
    };
    write_text(&file, &page.html())?;
    Ok(file)
}

/// Lists the missing results of a folder, one sentence for each: unfinished cases, missing files, an incomplete run;
/// empty for complete results.
///
/// # Errors
/// A file that cannot be read.
pub fn report_gaps(folder: impl AsRef<Path>) -> Result<Vec<String>, StudyError> {
    let folder = folder.as_ref();
    if let Some(cases) = listed(folder)? {
        return Ok(cases.iter().filter_map(|case| case.gap(folder)).collect());
    }
    let Some(summary) = FoundSummary::read(folder)? else {
        return Ok(Vec::new());
    };
    let mut gaps = Vec::new();
    if summary.ended() == "incomplete" {
        let reason = summary.failure().unwrap_or("");
        gaps.push(format!("the run is incomplete: {reason}"));
    }
    let files = summary.files().iter();
    for file in files.filter(|file| !folder.join(file).exists()) {
        gaps.push(format!("{file} is gone"));
    }
    Ok(gaps)
}

/// Reads the outcomes of the finished cases of a sweep, in the order of the scene; empty for a folder without a sweep.
///
/// # Errors
/// A file that cannot be read.
pub fn read_outcomes(folder: impl AsRef<Path>) -> Result<Vec<CaseOutcome>, StudyError> {
    let cases = case_folders(folder.as_ref())?.unwrap_or_default();
    let outcomes = cases
        .iter()
        .map(|case| CaseOutcome::read(&case.join(OUTCOME)));
    outcomes.collect()
}

/// The folders of the finished cases of a sweep, in order; `None` if the folder contains no sweep.
fn case_folders(folder: &Path) -> Result<Option<Vec<PathBuf>>, StudyError> {
    let Some(cases) = listed(folder)? else {
        return Ok(None);
    };
    let finished = cases.iter().filter(|case| case.is_finished(folder));
    Ok(Some(
        finished.map(|case| folder.join(case.name())).collect(),
    ))
}

/// The list of cases of a sweep; `None` if the folder contains no sweep.
fn listed(folder: &Path) -> Result<Option<Vec<CaseEntry>>, StudyError> {
    let file = folder.join(CASES);
    let Ok(text) = std::fs::read(&file) else {
        return Ok(None);
    };
    let cases = serde_json::from_slice(&text);
    let cases: Vec<CaseEntry> = cases.map_err(|source| StudyError::Outcome { file, source })?;
    Ok(Some(cases))
}

/// Reads the results of the finished cases of a sweep; `None` if the folder contains no sweep.
fn read_cases(folder: &Path) -> Result<Option<Vec<ReportCase>>, StudyError> {
    let Some(folders) = case_folders(folder)? else {
        return Ok(None);
    };
    let cases = folders.into_iter().map(|folder| {
        let histories = folder.join("histories.csv");
        Ok(ReportCase {
            outcome: CaseOutcome::read(&folder.join(OUTCOME))?,
            histories: if histories.exists() {
                read_table(&histories).map_err(powerhouse::Error::from)?
            } else {
                Vec::new()
            },
            accelerations: Accelerations::of_folder(&folder)?,
            summary: Some(FoundSummary::of_results(&folder)?),
            fingerprint: json_or_null(&folder.join(MARK))?,
            folder,
        })
    });
    cases.collect::<Result<_, _>>().map(Some)
}

/// The contents of a JSON file; null if there is none.
fn json_or_null(file: &Path) -> Result<serde_json::Value, StudyError> {
    if file.exists() {
        read_json(file)
    } else {
        Ok(serde_json::Value::Null)
    }
}

/// The unvaried cases of each kind of wave that occurs.
fn kinds(cases: &[ReportCase]) -> Vec<(&'static str, Vec<&ReportCase>)> {
    let kinds = ["sv", "p", "sh"].map(|kind| {
        let of_kind = cases.iter().filter(|case| {
            let wave = case.outcome.input.wave();
            case.is_plain() && wave.is_some_and(|(own, _)| own == kind)
        });
        (kind, of_kind.collect::<Vec<_>>())
    });
    let some = kinds.into_iter().filter(|(_, cases)| !cases.is_empty());
    some.collect()
}

/// The column with a name.
fn column<'t>(table: &'t [TableColumn], name: &str) -> Option<&'t TableColumn> {
    table.iter().find(|column| column.name == name)
}
