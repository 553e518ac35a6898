//! `powerhouse report`.

use std::path::Path;
use std::process::ExitCode;

use powerhouse_report::{read_outcomes, report_gaps, sensitivity, write_report_with};
use powerhouse_wang_2019::{Comparison, conclusions};

use crate::terminal::{say, say_warning};
use crate::{Outcome, WARNED};

/// Writes the report of a result folder; for a sweep also prints the sensitivity to single parameters, and of the paper's bay the test
/// of its conclusions. The exit status is 1 if cases or files are missing.
pub(crate) fn page(folder: &Path) -> Outcome {
    say!("{}", write_report_with(folder, &[&Comparison])?.display());
    let outcomes = read_outcomes(folder)?;
    if Comparison::concerns(&outcomes) {
        conclusions(&outcomes)
            .iter()
            .for_each(|claim| say!("{claim}"));
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
    Ok(if gaps.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(WARNED)
    })
}
