//! `powerhouse report`.

use std::path::Path;
use std::process::ExitCode;

use powerhouse_study::{
    Conclusion, Verdict, conclusions, read_outcomes, sensitivity, write_report,
};

use crate::Outcome;

/// Writes the page of a folder of results; of a sweep it also prints what became of the conclusions of the
/// paper, and what single choices do.
pub(crate) fn page(folder: &Path) -> Outcome {
    println!("{}", write_report(folder)?.display());
    let outcomes = read_outcomes(folder)?;
    let claims = conclusions(&outcomes);
    // Of a sweep of something else there is nothing to say.
    let is_open = |claim: &Conclusion| matches!(claim.verdict, Verdict::Missing(_));
    if !claims.iter().all(is_open) {
        claims.iter().for_each(|claim| println!("{claim}"));
    }
    for found in sensitivity(&outcomes) {
        let figures = found.figures.iter().map(ToString::to_string);
        let figures: Vec<String> = figures.collect();
        println!(
            "sensitivity.{} = {}, against {}: {}",
            found.case,
            found.varies,
            found.base,
            figures.join("; ")
        );
    }
    Ok(ExitCode::SUCCESS)
}
