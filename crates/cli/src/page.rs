//! `powerhouse report`.

use std::path::Path;
use std::process::ExitCode;

use powerhouse_report::{read_outcomes, report_gaps, sensitivity, write_report_with};
use powerhouse_wang_2019::{Comparison, Conclusion, Verdict, conclusions};

use crate::terminal::{say, say_warning};
use crate::{Outcome, WARNED};

/// Writes the report of a result folder; for a sweep also prints the test of the conclusions of the paper and the
/// sensitivity to single parameters. The exit status is 1 if cases or files are missing.
pub(crate) fn page(folder: &Path) -> Outcome {
    say!("{}", write_report_with(folder, &[&Comparison])?.display());
    let outcomes = read_outcomes(folder)?;
    let claims = conclusions(&outcomes);
    // A sweep of another scene has none of the paper's cases.
    let is_open = |claim: &Conclusion| matches!(claim.verdict, Verdict::Missing(_));
    if !claims.iter().all(is_open) {
        claims.iter().for_each(|claim| say!("{claim}"));
    }
    for found in sensitivity(&outcomes) {
        let figures = found.figures.iter().map(ToString::to_string);
        let figures: Vec<String> = figures.collect();
        say!(
            "sensitivity.{} = {}, compared with {}: {}",
            found.case,
            found.varies,
            found.base,
            figures.join("; ")
        );
    }
    // Printed, too, so that an incomplete report is noticed without reading the page.
    let gaps = report_gaps(folder)?;
    for gap in &gaps {
        say_warning!("{gap}");
    }
    Ok(match gaps.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::from(WARNED),
    })
}
