//! Pictures of the case that is nearest to the medians.

use powerhouse_study::StudyError;
use powerhouse_study::sweep::{ScaleStatistics, SetStatistics};

use super::super::ReportCase;
use super::super::page::Page;
use super::middle_scale;

/// Most pictures.
const MOST: usize = 6;
/// Beginnings and ends of the names of pictures that are shown, the most telling first.
const SHOWN: [[&str; 2]; 8] = [
    ["joint-", "-over-the-run"],
    ["joint-", "-slip"],
    ["joint-", "-peak-opening"],
    ["damage", ""],
    ["equivalent_plastic_strain", ""],
    ["greatest-principal-stress", ""],
    ["least-principal-stress", ""],
    ["largest-displacement", ""],
];

/// Adds the section, if there is such a case and it has pictures.
pub(super) fn add(
    page: &mut Page,
    cases: &[ReportCase],
    found: &SetStatistics,
) -> Result<(), StudyError> {
    let Some(scale) = middle_scale(found) else {
        return Ok(());
    };
    let own = cases
        .iter()
        .filter(|case| scale.cases.contains(&case.outcome.name));
    let Some(case) = own.min_by(|a, b| distance(a, scale).total_cmp(&distance(b, scale))) else {
        return Ok(());
    };
    let names = pictures(case);
    if names.is_empty() {
        return Ok(());
    }
    page.section("Nearest to the medians");
    page.paragraph(&format!(
        "Of the cases at scale {} the results of {} are nearest to the medians, by the mean of their logarithms.",
        scale.scale, case.outcome.name
    ));
    page.pictures(std::slice::from_ref(case), |_| names.clone())
}

/// Mean distance of the results of a case from the medians, as logarithms, each two at most.
fn distance(case: &ReportCase, scale: &ScaleStatistics) -> f64 {
    const MOST: f64 = 2.0;
    let figures = case.outcome.figures();
    let distances = scale.figures.iter().filter_map(|figure| {
        let median = figure.median.filter(|median| *median != 0.0)?;
        let (_, value) = figures.iter().find(|(name, _)| *name == figure.figure)?;
        let ratio = value / median;
        Some(if ratio > 0.0 {
            ratio.ln().abs().min(MOST)
        } else {
            MOST
        })
    });
    let distances: Vec<f64> = distances.collect();
    distances.iter().sum::<f64>() / distances.len().max(1) as f64
}

/// Names of the pictures of a case that are shown.
fn pictures(case: &ReportCase) -> Vec<String> {
    let files = std::fs::read_dir(case.folder.join("pictures"));
    let files = files.into_iter().flatten().flatten();
    let names = files.filter_map(|file| file.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".png")).collect();
    names.sort();
    let mut shown: Vec<String> = Vec::new();
    for [beginning, end] in SHOWN {
        let end = format!("{end}.png");
        let is_one = |name: &&String| name.starts_with(beginning) && name.ends_with(&end);
        let own = names.iter().filter(is_one);
        let own: Vec<String> = own.filter(|name| !shown.contains(name)).cloned().collect();
        shown.extend(own);
    }
    shown.truncate(MOST);
    shown
}
