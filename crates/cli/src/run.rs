//! `powerhouse run`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use powerhouse::engine::Ended;
use powerhouse::{ResultFolder, RunHooks, Scene};
use powerhouse_study::FreeFieldCheck;

use crate::{INTERRUPTED, Outcome, progress, report};

pub(crate) fn run(path: &Path, out: Option<PathBuf>) -> Outcome {
    let scene = Scene::from_file(path)?;
    let folder = out.map_or_else(|| scene.result_folder(), ResultFolder::new);
    let text = scene.source().map(|source| source.text.clone());
    let limit = scene.self_check();
    let free_field = match limit {
        Some(_) => Some(FreeFieldCheck::of(&scene)?),
        None => None,
    };
    let mut simulation = scene.prepare()?;
    report::before_run(&mut simulation)?;

    let stop = Arc::new(AtomicBool::new(false));
    let raised = stop.clone();
    ctrlc::set_handler(move || raised.store(true, Ordering::Relaxed))?;
    if let (Some(check), Some(limit)) = (free_field, limit) {
        let bar = progress::bar("free field");
        let hooks = RunHooks {
            progress: Some(progress::hook(&bar)),
            ..RunHooks::default()
        };
        let found = check.run(simulation.step()?, hooks)?;
        bar.finish_and_clear();
        report::free_field(&found);
        found.require(limit)?;
    }
    let (title, mesh) = (simulation.title().to_owned(), simulation.mesh().clone());
    let remarks = simulation.remarks().to_vec();
    let bar = progress::bar("run");
    let hooks = RunHooks {
        progress: Some(progress::hook(&bar)),
        stop: Some(stop),
        snapshots: Some(folder.snapshots(&mesh)?),
        ..RunHooks::default()
    };
    let results = simulation.run(hooks)?;
    bar.finish_and_clear();
    let files = folder.write((&title, &mesh), &results, &remarks, text.as_deref())?;
    report::after_run(&mesh, &results, &files);
    Ok(match results.run.ended {
        Ended::Stopped => ExitCode::from(INTERRUPTED),
        Ended::Completed | Ended::Observer(_) => ExitCode::SUCCESS,
    })
}
