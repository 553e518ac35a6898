//! Checkpoints of a run: the state from which it is resumed or starts.

use std::path::PathBuf;
use std::sync::Arc;

use powerhouse::{KeptState, ResultFolder, ResumedRun, RunHooks};

use crate::terminal::say;

/// Prints from where a run is resumed, and which checkpoints are not used.
pub(crate) fn say_resumed(resumed: &ResumedRun) {
    for reason in &resumed.unused {
        say!("warning: a checkpoint is not used: {reason}");
    }
    match (&resumed.run, &resumed.body) {
        (Some(run), _) => say!("resumed after {} steps, at t = {:.6} s", run.done, run.time),
        (None, Some(body)) => {
            let last = body.stages().last().map_or("", |stage| stage.name.as_str());
            say!("resumed after the stage '{last}'");
        }
        (None, None) => {}
    }
    if let Some(solution) = &resumed.solution {
        say!(
            "the solution of stage {} goes on from {:.1} % of its load, after {} steps",
            solution.stage + 1,
            100.0 * solution.saved.time,
            solution.saved.done
        );
    }
}

/// Prints how an interrupted run is resumed.
pub(crate) fn say_resumable(folder: &ResultFolder) {
    let path = folder.path().display();
    say!("`powerhouse run --resume {path}` goes on");
}

/// A state that a run has kept: the folder of its results, and its time (s).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KeptAt {
    pub(crate) folder: PathBuf,
    pub(crate) time: f64,
}

/// Reads a folder and a time, such as `results/bay@5.2s`.
pub(crate) fn kept_at(text: &str) -> Result<KeptAt, String> {
    let wanted = "expected DIR@TIME, the folder of the results of a run and the time (s) of a state that it has kept, such \
                  as results/bay@5.2s";
    let (folder, time) = text.rsplit_once('@').ok_or(wanted)?;
    let time = time.strip_suffix('s').unwrap_or(time).trim();
    match time.parse::<f64>() {
        Ok(time) if time.is_finite() && !folder.is_empty() => Ok(KeptAt {
            folder: folder.into(),
            time,
        }),
        _ => Err(wanted.into()),
    }
}

/// Adds the state of another run from which a run starts.
pub(crate) fn starting_from<'a>(hooks: RunHooks<'a>, kept: KeptState) -> RunHooks<'a> {
    let hooks = match kept.body {
        Some(body) => hooks.with_equilibrated_body(body),
        None => hooks,
    };
    hooks.with_resume(Arc::new(kept.run))
}

/// Adds the state from which a run of a scene with a number of stages is resumed.
pub(crate) fn resuming<'a>(
    mut hooks: RunHooks<'a>,
    resumed: ResumedRun,
    stages: usize,
) -> RunHooks<'a> {
    // Without the body of all stages those that are missing are computed again, to the same bits.
    match resumed.body {
        Some(body) if body.stages().len() == stages => {
            hooks = hooks.with_equilibrated_body(body);
        }
        Some(body) => hooks = hooks.with_completed_stages(body),
        None => {}
    }
    if let Some(solution) = resumed.solution {
        hooks = hooks.with_stage_solution(solution);
    }
    match resumed.run {
        Some(run) => hooks.with_resume(Arc::new(run)),
        None => hooks,
    }
}
