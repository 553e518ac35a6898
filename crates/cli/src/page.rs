//! `powerhouse report`.

use std::path::Path;
use std::process::ExitCode;

use powerhouse_study::{
    Conclusion, Verdict, conclusions, read_outcomes, report_gaps, sensitivity, write_report,
};

use crate::terminal::say;
use crate::{Outcome, WARNED};

/// Writes the page of a folder of results; of a sweep it also prints what became of the conclusions of the
/// paper, and what single choices do. The exit status is 1 if cases or files are missing.
pub(crate) fn page(folder: &Path) -> Outcome {
    say!("{}", write_report(folder)?.display());
    let outcomes = read_outcomes(folder)?;
    let claims = conclusions(&outcomes);
    // Of a sweep of something else there is nothing to say.
    let is_open = |claim: &Conclusion| matches!(claim.verdict, Verdict::Missing(_));
    if !claims.iter().all(is_open) {
        claims.iter().for_each(|claim| say!("{claim}"));
    }
    for found in sensitivity(&outcomes) {
        let figures = found.figures.iter().map(ToString::to_string);
        let figures: Vec<String> = figures.collect();
        say!(
            "sensitivity.{} = {}, against {}: {}",
            found.case,
            found.varies,
            found.base,
            figures.join("; ")
        );
    }
    // The page has them too; who only looks at the status must not take it for a whole one.
    let gaps = report_gaps(folder)?;
    for gap in &gaps {
        say!("warning: {gap}");
    }
    Ok(match gaps.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::from(WARNED),
    })
}
