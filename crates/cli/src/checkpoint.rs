//! Checkpoints of a run: their interval, and the state from which a run is resumed.

use std::sync::Arc;
use std::time::Duration;

use powerhouse::{ResultFolder, ResumedRun, RunHooks};

use crate::terminal::say;

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
}

/// Prints how an interrupted run is resumed.
pub(crate) fn say_resumable(folder: &ResultFolder) {
    let path = folder.path().display();
    say!("`powerhouse run --resume {path}` goes on");
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
