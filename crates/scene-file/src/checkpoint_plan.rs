//! Checkpoints that a scene requests.

use core::fmt;
use core::str::FromStr;
use std::time::Duration;

use thiserror::Error;

/// Wall time between two checkpoints of a run.
///
/// ```
/// use powerhouse_scene_file::CheckpointInterval;
/// use std::time::Duration;
/// let every: CheckpointInterval = "1.5 h".parse()?;
/// assert_eq!(every, CheckpointInterval::Every(Duration::from_secs(5400)));
/// assert_eq!("never".parse(), Ok(CheckpointInterval::Never));
/// assert!("10".parse::<CheckpointInterval>().is_err());
/// # Ok::<(), powerhouse_scene_file::IntervalError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckpointInterval {
    /// A wall time above 0.
    Every(Duration),
    /// No checkpoint but those of interruptions.
    Never,
}

impl CheckpointInterval {
    /// The interval of a run whose scene and command line give none: ten minutes.
    pub const DEFAULT: Self = Self::Every(Duration::from_secs(600));

    /// The wall time; the longest there is for [`Never`](Self::Never).
    pub const fn duration(self) -> Duration {
        match self {
            Self::Every(duration) => duration,
            Self::Never => Duration::MAX,
        }
    }
}

/// Text that is no interval of wall time.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("expected a time above 0 with a unit, such as 30s, 10min or 1h, or `never`")]
pub struct IntervalError;

impl FromStr for CheckpointInterval {
    type Err = IntervalError;
    /// Reads a number with the unit s, min or h, or `never`.
    fn from_str(text: &str) -> Result<Self, IntervalError> {
        let text = text.trim();
        if text == "never" {
            return Ok(Self::Never);
        }
        let start = text.find(|c: char| c.is_alphabetic()).unwrap_or(text.len());
        let unit = match text[start..].trim() {
            "s" => 1.0,
            "min" => 60.0,
            "h" => 3600.0,
            _ => return Err(IntervalError),
        };
        let number: f64 = text[..start].trim().parse().map_err(|_| IntervalError)?;
        let seconds = Duration::try_from_secs_f64(number * unit).map_err(|_| IntervalError)?;
        if seconds.is_zero() {
            Err(IntervalError)
        } else {
            Ok(Self::Every(seconds))
        }
    }
}

impl fmt::Display for CheckpointInterval {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Every(duration) => write!(f, "{}s", duration.as_secs_f64()),
            Self::Never => f.write_str("never"),
        }
    }
}

/// Checkpoints that a scene requests: their interval, and states that are kept after the run.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CheckpointPlan {
    /// Wall time between two checkpoints; none for [`CheckpointInterval::DEFAULT`].
    pub every: Option<CheckpointInterval>,
    /// Times of the motion (s), in rising order, whose states are kept: those after the first step that reaches each of
    /// them. They are after the start of the run and before its end.
    pub keep: Vec<f64>,
}

impl CheckpointPlan {
    /// The same plan with an interval of wall time.
    #[must_use]
    pub fn with_every(mut self, every: CheckpointInterval) -> Self {
        self.every = Some(every);
        self
    }
    /// The same plan with times (s) of which states are kept, in any order.
    #[must_use]
    pub fn with_keep(mut self, times: impl IntoIterator<Item = f64>) -> Self {
        self.keep = times.into_iter().collect();
        self.keep.sort_by(f64::total_cmp);
        self
    }
}
