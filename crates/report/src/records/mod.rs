//! Report page of a sweep over a set of records: what its cases have in common, on a few pages.
//!
//! What single cases have is on a page of its own, and in tables.

mod figures;
mod lining;
mod nearest;
mod spectra;
mod warnings;

use std::path::Path;

use powerhouse_study::StudyError;
use powerhouse_study::internal::{STATISTICS, rounded};
use powerhouse_study::sweep::{ScaleStatistics, SetStatistics};

use super::page::Page;
use super::run_warnings::RunWarnings;
use super::{PLOTS, ReportCase, report_gaps, statistics, tables};

/// Name of the page of all cases in the result folder.
pub(super) const CASES_PAGE: &str = "report-cases.html";
/// Most sections that are of no ring and are drawn.
const MOST_SECTIONS: usize = 4;

/// Statistics of the folder of a sweep; `None` of one without a set of records.
pub(super) fn found(folder: &Path) -> Result<Option<SetStatistics>, StudyError> {
    let file = folder.join(STATISTICS);
    if file.exists() {
        SetStatistics::read(&file).map(Some)
    } else {
        Ok(None)
    }
}

/// The page of the statistics of a set of records.
pub(super) fn page(
    folder: &Path,
    cases: &[ReportCase],
    found: &SetStatistics,
) -> Result<Page, StudyError> {
    let title = (cases[0].summary.as_ref()).map_or("sweep", |summary| &summary.title);
    let title = title.rsplit_once(": ").map_or(title, |(scene, _)| scene);
    let mut page = Page::new(title);
    let plots = folder.join(PLOTS);
    page.paragraph(&overview(cases, found));
    page.warnings(&report_gaps(folder)?);
    for scale in &found.scales {
        page.warnings(statistics::missing(scale).as_slice());
    }
    let warnings = warnings::grouped(&RunWarnings::of_cases(cases), cases.len());
    if !warnings.is_empty() {
        page.section("Warnings of the runs");
        page.warnings(&warnings);
    }
    if let Some(spectra) = &found.spectra {
        spectra::add(&mut page, spectra, &plots)?;
    }
    if !found.fragility.is_empty() {
        page.section("Fragility");
        page.paragraph(
            "Fragility curves: lognormal distributions of the greatest binomial likelihood (Baker 2015), with intervals of \
             95 % confidence by the expected information at the estimate, too narrow for few runs.",
        );
        page.table(&statistics::fragility(found));
        page.figures(statistics::curves(found, &plots)?)?;
    }
    figures::add(&mut page, found);
    lining::add(&mut page, (folder, found), &plots)?;
    nearest::add(&mut page, cases, found)?;
    page.section("Single cases and records");
    page.paragraph(&format!(
        "{CASES_PAGE} has every case: peaks, histories, pictures, section forces, joints, energies, and the scene as it was run. \
         sweep.csv has the results of all cases, statistics.csv the fractiles, envelopes.csv the envelopes of section forces; the folder \
         {PLOTS} has the records (records.csv), their spectra (spectra.csv) and the plots of this page.",
    ));
    Ok(page)
}

/// The scale nearest to that of the records themselves of which cases are finished.
fn middle_scale(found: &SetStatistics) -> Option<&ScaleStatistics> {
    let off = |scale: &&ScaleStatistics| scale.scale.ln().abs();
    let with_cases = found.scales.iter().filter(|scale| !scale.cases.is_empty());
    with_cases.min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// What was computed, and how well its energies are balanced.
fn overview(cases: &[ReportCase], found: &SetStatistics) -> String {
    let scales: Vec<String> = found.scales.iter().map(|of| of.scale.to_string()).collect();
    let all = |of: &ScaleStatistics| of.finished + of.missing.len();
    let records = found.scales.iter().map(all).max().unwrap_or(0);
    let finished: usize = found.scales.iter().map(|of| of.finished).sum();
    let of: usize = found.scales.iter().map(all).sum();
    let at = match &scales[..] {
        [one] => format!("scale {one}"),
        many => format!("the scales {}", many.join(", ")),
    };
    let summaries: Vec<_> = (cases.iter())
        .filter_map(|case| case.summary.as_ref())
        .collect();
    let worst = cases.iter().max_by(|a, b| {
        let [a, b] = [a, b].map(|case| case.outcome.energy_residual);
        a.total_cmp(&b)
    });
    let energy = worst.map_or(String::new(), |case| {
        let (residual, name) = (rounded(case.outcome.energy_residual), &case.outcome.name);
        format!(" The energy balance of the worst case ({name}) misses {residual} of the largest energy.")
    });
    let end = cases
        .iter()
        .map(|case| case.outcome.end)
        .fold(0.0, f64::max);
    format!(
        "{records} records of the set '{}' at {at}: {finished} of {of} cases have results, of runs of {} s. {}{energy}",
        found.set,
        rounded(end),
        tables::computed_by(&summaries),
    )
}
