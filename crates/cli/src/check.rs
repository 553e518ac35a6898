//! `powerhouse check`.

use std::num::NonZeroUsize;
use std::path::Path;
use std::process::ExitCode;

use powerhouse::io::is_packed_mesh;
use powerhouse::model::ModelError;
use powerhouse::{FileScene, KeyChange, RunHooks, SceneChoice};
use powerhouse_study::{FreeFieldCheck, FreeFieldReport, StudyError};

use crate::progress::Display;
use crate::terminal::say;
use crate::{INTERRUPTED, Outcome, WARNED, forecast, read, report, stop};

/// Checks a scene and prints the report, also of a run on some ranks if a number is given; the exit status is 1 if there
/// are warnings.
pub(crate) fn check(path: &Path, of_file: &SceneChoice, ranks: Option<NonZeroUsize>) -> Outcome {
    // Ranks that cannot share the body are refused before the check.
    let ranks = match ranks {
        None => None,
        Some(ranks) => {
            let scene = read(path, of_file)?;
            let is_packed = scene
                .spec()
                .is_some_and(|spec| is_packed_mesh(Path::new(&*spec.mesh.file)));
            let simulation = scene.prepare()?;
            let forecast = match simulation.model().distributed() {
                Some(distributed) => distributed.rank_forecast(ranks.get()),
                None => Err(ModelError::refused(
                    format!("{ranks} ranks"),
                    "the engine computes on one",
                )),
            };
            Some((forecast?, is_packed))
        }
    };
    let found = powerhouse_study::check(read(path, of_file)?)?;
    report::lines(&found.to_string());
    if let Some((forecast, is_packed)) = ranks {
        forecast::print(&forecast, &found, is_packed);
    }
    Ok(if found.warnings.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(WARNED)
    })
}

/// Checks the keys and values of a scene file and of its cases, without mesh and records.
pub(crate) fn keys(path: &Path, changes: &[KeyChange]) -> Outcome {
    let cases = FileScene::check_keys(path, changes, &powerhouse_wang_2019::registry())?;
    let cases = match cases {
        0 => String::new(),
        1 => " and its case".into(),
        count => format!(" and its {count} cases"),
    };
    say!(
        "the keys of {}{cases} exist, and each value is of the right form; mesh, sets and record files were not checked",
        path.display()
    );
    Ok(ExitCode::SUCCESS)
}

/// Runs the free-field check of a scene; the exit status is 2 if the error is above the scene's limit.
pub(crate) fn free_field(path: &Path, of_file: &SceneChoice) -> Outcome {
    let scene = read(path, of_file)?;
    let limit = scene.self_check();
    let check = FreeFieldCheck::of(&scene)?;
    let step = scene.prepare()?.step()?;
    let display = Display::new("free field");
    let hooks = RunHooks::default()
        .with_progress(display.hook())
        .with_stop(stop::flag()?);
    let found = check.run(step, hooks);
    display.clear();
    say_found(found.as_ref());
    let found = match found {
        Err(StudyError::Interrupted) => return Ok(ExitCode::from(INTERRUPTED)),
        found => found?,
    };
    if let Some(limit) = limit {
        found.require(limit)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints the report of a free-field check, or that it was interrupted.
pub(crate) fn say_found(found: Result<&FreeFieldReport, &StudyError>) {
    match found {
        Ok(found) => report::free_field(found),
        Err(StudyError::Interrupted) => {
            say!("interrupted during the free-field check: nothing was run");
        }
        Err(_) => {}
    }
}
