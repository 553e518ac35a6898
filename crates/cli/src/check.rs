//! `powerhouse check`.

use std::path::Path;
use std::process::ExitCode;

use powerhouse::{RunHooks, Scene};
use powerhouse_study::FreeFieldCheck;

use crate::{Outcome, WARNED, progress, report};

/// Looks at a scene; the exit status is 1 if there are warnings.
pub(crate) fn check(path: &Path) -> Outcome {
    let found = powerhouse_study::check(Scene::from_file(path)?)?;
    report::check(&found);
    Ok(if found.warnings.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(WARNED)
    })
}

/// Compares the scene's box without the structure with its field; the exit status is 2 if the
/// error is above the scene's own limit.
pub(crate) fn free_field(path: &Path) -> Outcome {
    let scene = Scene::from_file(path)?;
    let limit = scene.self_check();
    let check = FreeFieldCheck::of(&scene)?;
    let step = scene.prepare()?.step()?;
    let bar = progress::bar("free field");
    let hooks = RunHooks {
        progress: Some(progress::hook(&bar)),
        ..RunHooks::default()
    };
    let found = check.run(step, hooks)?;
    bar.finish_and_clear();
    report::free_field(&found);
    if let Some(limit) = limit {
        found.require(limit)?;
    }
    Ok(ExitCode::SUCCESS)
}
