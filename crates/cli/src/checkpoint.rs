//! Checkpoints of a run: the state from which it is resumed or starts.

use std::path::PathBuf;
use std::sync::Arc;

use powerhouse::{
    CheckpointError, CheckpointFiles, KeptState, ResultFolder, ResumedRun, RunHooks, RunInputs,
};
use powerhouse_study::CheckpointEvent;

use crate::terminal::{say, say_warning, warn_aside};

/// Refuses a new run in a folder with a checkpoint that cannot be read, or from which a run of the same inputs can go on; warns of
/// a checkpoint of other inputs, which will be removed.
pub(crate) fn refuse_resumable(folder: &ResultFolder, inputs: &RunInputs) -> Result<(), String> {
    let files = CheckpointFiles::of(folder.path());
    let path = folder.path().display();
    let found = match files.read() {
        Ok(found) => found,
        Err(CheckpointError::None { .. }) => return Ok(()),
        Err(error) => {
            return Err(format!(
                "{path} has a checkpoint, but {error}; `--restart` removes it, --out gives another folder"
            ));
        }
    };
    let start = from_where(&found);
    let is_same = found.inputs.origin == inputs.origin;
    if is_same && files.check(&found.inputs, inputs).is_ok() {
        return Err(format!(
            "a run of this scene ended before its time in {path}: `powerhouse run --resume {path}` goes on {start}; `--restart` begins anew"
        ));
    }
    say_warning!(
        "the checkpoint of another run in {path}, which would go on {start}, is removed: its scene or files differ"
    );
    Ok(())
}

/// Prints from where a run is resumed, and which checkpoints are not used.
pub(crate) fn say_resumed(resumed: &ResumedRun) {
    for reason in &resumed.unused {
        say!("{}", CheckpointEvent::Unused(reason));
    }
    say!("{}", CheckpointEvent::Resumed(resumed));
}

/// Prints how an interrupted run is resumed, if it can be.
pub(crate) fn say_resumable(folder: &ResultFolder) {
    let path = folder.path().display();
    match CheckpointFiles::of(folder.path()).read() {
        Ok(kept) => say!(
            "`powerhouse run --resume {path}` goes on {}",
            from_where(&kept)
        ),
        Err(CheckpointError::None { .. }) => {
            say!("no checkpoint was written: another run begins anew");
        }
        Err(error) => say!("another run begins anew: {error}"),
    }
}

/// Prints on the error stream which checkpoint a failed run has left and what it is good for. A run that diverged fails
/// again from it.
pub(crate) fn say_after_failure(folder: &ResultFolder, diverged: bool) {
    let path = folder.path().display();
    match CheckpointFiles::of(folder.path()).read() {
        Ok(kept) => {
            let start = from_where(&kept);
            warn_aside!(
                "note: the last good state is kept: `powerhouse run --resume {path}` goes on {start}"
            );
            if diverged {
                warn_aside!(
                    "note: a resumed run has the same scene and time step, and fails at the same step; after a change of the \
                     scene, such as a smaller step, the run begins anew (`powerhouse run SCENE --out DIR` into another \
                     folder keeps these files)"
                );
            }
        }
        Err(CheckpointError::None { .. }) => warn_aside!(
            "note: no checkpoint was written before the failure (the first is due after the time of --checkpoint-every)"
        ),
        Err(error) => warn_aside!("note: {error}"),
    }
}

/// The state from which a run goes on, in words.
fn from_where(kept: &ResumedRun) -> String {
    match (&kept.run, &kept.body) {
        (Some(run), _) => format!("from t = {:.6} s, after {} steps", run.time, run.done),
        _ if kept.solution.is_some() => "within the solution of a stage".into(),
        (None, Some(body)) => {
            let last = body.stages().last().map_or("", |stage| stage.name.as_str());
            format!("after the stage '{last}'")
        }
        (None, None) => "from its start".into(),
    }
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
