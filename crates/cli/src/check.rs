//! `powerhouse check`.

use std::num::NonZeroUsize;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use powerhouse::RunHooks;
use powerhouse_study::{FreeFieldCheck, FreeFieldReport, StudyError};

use crate::progress::Display;
use crate::terminal::say;
use crate::{INTERRUPTED, Outcome, WARNED, forecast, read, report, stop};

/// Checks a scene and prints the report, also of a run on some ranks if a number is given; the exit status is 1 if there
/// are warnings.
pub(crate) fn check(path: &Path, case: Option<&str>, ranks: Option<NonZeroUsize>) -> Outcome {
    let found = powerhouse_study::check(read(path, case)?)?;
    report::check(&found);
    if let Some(ranks) = ranks {
        let simulation = read(path, case)?.prepare()?;
        forecast::print(&simulation.model().rank_forecast(ranks.get())?, &found);
    }
    Ok(if found.warnings.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(WARNED)
    })
}

/// Runs the free-field check of a scene; the exit status is 2 if the error is above the scene's limit.
pub(crate) fn free_field(path: &Path, case: Option<&str>) -> Outcome {
    let scene = read(path, case)?;
    let limit = scene.self_check();
    let check = FreeFieldCheck::of(&scene)?;
    let step = scene.prepare()?.step()?;
    let Some(found) = compare(check, step, &stop::flag()?)? else {
        return Ok(ExitCode::from(INTERRUPTED));
    };
    if let Some(limit) = limit {
        found.require(limit)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Runs a free-field check and prints its report; `None` if it was interrupted.
pub(crate) fn compare(
    check: FreeFieldCheck,
    step: f64,
    stop: &Arc<AtomicBool>,
) -> Result<Option<FreeFieldReport>, StudyError> {
    let display = Display::new("free field");
    let hooks = RunHooks::default()
        .with_progress(display.hook())
        .with_stop(stop.clone());
    let found = check.run(step, hooks);
    display.clear();
    match found {
        Ok(found) => {
            report::free_field(&found);
            Ok(Some(found))
        }
        Err(StudyError::Interrupted) => {
            say!("interrupted during the free-field check: nothing was run");
            Ok(None)
        }
        Err(error) => Err(error),
    }
}
