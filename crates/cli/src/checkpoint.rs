//! Checkpoints of a run: their interval, and the state from which a run is resumed.

use std::sync::Arc;
use std::time::Duration;

use powerhouse::{CheckpointError, CheckpointFiles, ResultFolder, ResumedRun, RunHooks};
use powerhouse_study::CheckpointEvent;

use crate::terminal::{say, warn_aside};

/// Wall time between two checkpoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval(pub(crate) Duration);

/// Reads an interval of wall time: a number with the unit s, min or h, or `never`.
pub(crate) fn interval(text: &str) -> Result<Interval, String> {
    let text = text.trim();
    if text == "never" {
        return Ok(Interval(Duration::MAX));
    }
    let start = text.find(|c: char| c.is_alphabetic()).unwrap_or(text.len());
    let unit = match text[start..].trim() {
        "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(WANTED.into()),
    };
    let number: f64 = text[..start].trim().parse().map_err(|_| WANTED)?;
    let seconds = Duration::try_from_secs_f64(number * unit).map_err(|_| WANTED)?;
    match seconds.is_zero() {
        true => Err(WANTED.into()),
        false => Ok(Interval(seconds)),
    }
}

const WANTED: &str = "a time above 0 with a unit, such as 30s, 10min or 1h, or `never`";

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
        (None, Some(body)) => {
            let last = body.stages().last().map_or("", |stage| stage.name.as_str());
            format!("after the stage '{last}'")
        }
        (None, None) => "from its start".into(),
    }
}

/// Adds the state from which a run of a scene with a number of stages is resumed, if it is.
pub(crate) fn from<'a>(
    hooks: RunHooks<'a>,
    resumed: Option<ResumedRun>,
    stages: usize,
) -> RunHooks<'a> {
    let Some(resumed) = resumed else {
        return hooks;
    };
    let mut hooks = hooks;
    // Without the body of all stages those that are missing are computed again, to the same bits.
    match resumed.body {
        Some(body) if body.stages().len() == stages => {
            hooks = hooks.with_equilibrated_body(body);
        }
        Some(body) => hooks = hooks.with_completed_stages(body),
        None => {}
    }
    match resumed.run {
        Some(run) => hooks.with_resume(Arc::new(run)),
        None => hooks,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Intervals with their units; others are refused.
    #[test]
    fn intervals_have_units() {
        for (text, seconds) in [
            ("30s", 30.0),
            ("10min", 600.0),
            ("1.5 h", 5400.0),
            ("0.2s", 0.2),
        ] {
            assert_eq!(
                interval(text),
                Ok(Interval(Duration::from_secs_f64(seconds))),
                "{text}"
            );
        }
        assert_eq!(interval("never"), Ok(Interval(Duration::MAX)));
        for text in ["", "10", "min", "-1s", "0s", "nan s", "1e300h", "3 days"] {
            assert_eq!(interval(text), Err(WANTED.into()), "{text}");
        }
    }
}
