//! One HTML page of a sweep or a run, which needs nothing beside it.
//!
//! # Why so
//! *It reads what is on disk*, so that a report can be made again of old results, and of results that
//! are not complete: what is missing is left out.
//!
//! *Plots and pictures are part of the page* as data, each for itself, so that a page can be sent by
//! mail and the colours of a plot follow light and dark.

mod charts;
mod doubts;
mod forces;
mod fourier;
mod page;
mod paper;
mod repetition;
mod single;
mod spectra;
mod sweep;
mod tables;

use std::path::{Path, PathBuf};

use powerhouse::io::{TableColumn, read_table};
use powerhouse::wavefield::TimeHistory;

use crate::StudyError;
use crate::sweep::{CASES, CaseOutcome, Listed, MARK, OUTCOME, write_text};

/// The name of the page in its folder.
const FILE: &str = "report.html";
/// The folder of the plots that are made for it.
const PLOTS: &str = "report";

/// A case and what is on disk of it.
pub(super) struct CaseFiles {
    pub(super) folder: PathBuf,
    pub(super) outcome: CaseOutcome,
    pub(super) histories: Vec<TableColumn>,
    pub(super) summary: serde_json::Value,
    /// What it was computed from.
    pub(super) mark: serde_json::Value,
}

impl CaseFiles {
    /// Whether it varies nothing but its wave.
    fn is_plain(&self) -> bool {
        let input = &self.outcome.input;
        input.varies.is_none() && !input.continuous
    }
}

/// Writes `report.html` of a folder of results: of a sweep or of a single run. Returns the file.
///
/// # Errors
/// [`StudyError::NoResults`] for a folder that holds neither; a file that cannot be read or written.
pub fn write_report(folder: impl AsRef<Path>) -> Result<PathBuf, StudyError> {
    let folder = folder.as_ref();
    let page = match read_cases(folder)? {
        Some(cases) if !cases.is_empty() => sweep::page(folder, &cases)?,
        _ => single::page(folder)?,
    };
    let file = folder.join(FILE);
    write_text(&file, &page.html())?;
    Ok(file)
}

/// What a report of a folder cannot show though the sweep or the run has had it: cases that are not finished,
/// files that are gone, a run that ended before all its files were there. Nothing if all is there.
///
/// # Errors
/// A file that cannot be read.
pub fn report_gaps(folder: impl AsRef<Path>) -> Result<Vec<String>, StudyError> {
    let folder = folder.as_ref();
    if let Some(cases) = listed(folder)? {
        return Ok(cases.iter().filter_map(|case| case.lacks(folder)).collect());
    }
    let summary = read_json(&folder.join("summary.json"));
    let mut gaps = Vec::new();
    if summary["ended"] == "incomplete" {
        let why = summary["failure"].as_str().unwrap_or("");
        gaps.push(format!("the run is incomplete: {why}"));
    }
    let files = summary["files"].as_array().into_iter().flatten();
    let files = files.filter_map(serde_json::Value::as_str);
    for file in files.filter(|file| !folder.join(file).exists()) {
        gaps.push(format!("{file} is gone"));
    }
    Ok(gaps)
}

/// The outcomes of the cases of a sweep that are finished, in the order of the scene; none if the folder
/// holds no sweep.
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

/// The folders of the cases of a sweep that are finished, in order; none if it is no sweep.
fn case_folders(folder: &Path) -> Result<Option<Vec<PathBuf>>, StudyError> {
    let Some(cases) = listed(folder)? else {
        return Ok(None);
    };
    let finished = cases.iter().filter(|case| case.is_finished(folder));
    Ok(Some(
        finished.map(|case| folder.join(case.name())).collect(),
    ))
}

/// The cases of a sweep; none if the folder holds no sweep.
fn listed(folder: &Path) -> Result<Option<Vec<Listed>>, StudyError> {
    let file = folder.join(CASES);
    let Ok(text) = std::fs::read(&file) else {
        return Ok(None);
    };
    let cases = serde_json::from_slice(&text);
    let cases: Vec<Listed> = cases.map_err(|source| StudyError::Outcome { file, source })?;
    Ok(Some(cases))
}

/// What is on disk of the cases of a sweep that are finished; none if it is no sweep.
fn read_cases(folder: &Path) -> Result<Option<Vec<CaseFiles>>, StudyError> {
    let Some(folders) = case_folders(folder)? else {
        return Ok(None);
    };
    let cases = folders.into_iter().map(|folder| {
        let histories = folder.join("histories.csv");
        Ok(CaseFiles {
            outcome: CaseOutcome::read(&folder.join(OUTCOME))?,
            histories: match histories.exists() {
                true => read_table(&histories).map_err(powerhouse::Error::from)?,
                false => Vec::new(),
            },
            summary: read_json(&folder.join("summary.json")),
            mark: read_json(&folder.join(MARK)),
            folder,
        })
    });
    cases.collect::<Result<_, _>>().map(Some)
}

/// What a file says; null if there is none that can be read.
fn read_json(file: &Path) -> serde_json::Value {
    let text = std::fs::read(file).unwrap_or_default();
    serde_json::from_slice(&text).unwrap_or_default()
}

/// The plain cases of each kind of wave, of which there are some.
fn kinds(cases: &[CaseFiles]) -> Vec<(&'static str, Vec<&CaseFiles>)> {
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

/// The column of a name.
fn column<'t>(table: &'t [TableColumn], name: &str) -> Option<&'t TableColumn> {
    table.iter().find(|column| column.name == name)
}

/// Samples of an acceleration (m/s2) as a record at even times, as many as there are: a run samples at its
/// steps, which need not fall on the times that were asked for. None if they are no record.
fn history_of(times: &[f64], acceleration: &[f64]) -> Option<TimeHistory> {
    let ([first, _, ..], [.., last]) = (times, times) else {
        return None;
    };
    let step = (last - first) / (times.len() - 1) as f64;
    let mut place = 0;
    let even = (0..times.len()).map(|sample| {
        let time = first + step * sample as f64;
        while place + 2 < times.len() && times[place + 1] <= time {
            place += 1;
        }
        let share = (time - times[place]) / (times[place + 1] - times[place]);
        let [from, to] = [acceleration[place], acceleration[place + 1]];
        from + (to - from) * share.clamp(0.0, 1.0)
    });
    TimeHistory::new(step, even.collect()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples at uneven times are those of the same motion at even ones.
    #[test]
    fn uneven_samples_become_even_ones() {
        // Every first step of 6 ms at or past a multiple of 10 ms.
        let times: Vec<f64> = (0..100)
            .map(|sample| 6e-3 * (10.0 * f64::from(sample) / 6.0).ceil())
            .collect();
        let wave = |time: f64| (5.0 * time).sin();
        let uneven: Vec<f64> = times.iter().map(|&time| wave(time)).collect();
        let even = history_of(&times, &uneven).unwrap();
        let step = times[99] / 99.0;
        assert!((even.step() - step).abs() < 1e-15);
        for (sample, value) in even.acceleration().into_iter().enumerate() {
            // Chords of at most 12 ms.
            let off = value - wave(step * sample as f64);
            assert!(
                off.abs() < 25.0 * 0.012_f64.powi(2) / 8.0 + 1e-12,
                "{off:e}"
            );
        }
        let given: Vec<f64> = (0..50).map(|sample| 0.25 * f64::from(sample)).collect();
        let same = history_of(&given, &given).unwrap().acceleration();
        assert!(same.iter().zip(&given).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(history_of(&[0.0], &[1.0]).is_none());
    }
}
