//! Checkpoints of a run: the state from which it is resumed or starts.

use std::path::PathBuf;

use powerhouse::{CheckpointError, CheckpointFiles, ResultFolder};
use powerhouse_study::text::start_of;

use crate::terminal::{say, warn_aside};

/// Prints how an interrupted run is resumed, if it can be.
pub(crate) fn say_resumable(folder: &ResultFolder) {
    let path = folder.path().display();
    match CheckpointFiles::of(folder.path()).read() {
        Ok(kept) => say!(
            "`powerhouse run --resume {path}` goes on {}",
            start_of(&kept)
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
            let start = start_of(&kept);
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
