//! Progress display: a bar on a terminal, lines at intervals elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use crate::terminal::{is_quiet, warn_aside};
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use powerhouse::ProgressHook;
use powerhouse::engine::{Progress, StaticProgress};

/// Number of steps between updates of the display.
const STEPS_PER_TICK: u64 = 32;
/// Least time between lines without a terminal, and inverse of its least share of the time since the start, so that a
/// run of hours has some hundred lines.
const BETWEEN_LINES: Duration = Duration::from_secs(5);
const SHARE_BETWEEN_LINES: u32 = 20;
const TEMPLATE: &str = "{prefix} {bar:32} {percent:>3} %  {msg}  {per_sec}  {eta} left";

/// Progress of a run on the error stream, with its rate and the remaining time.
pub(crate) enum Display {
    Bar(ProgressBar),
    Lines(String),
}

impl Display {
    pub(crate) fn new(prefix: &str) -> Self {
        Self::among(&MultiProgress::new(), prefix)
    }

    /// One of several simultaneous displays.
    pub(crate) fn among(bars: &MultiProgress, prefix: &str) -> Self {
        if is_quiet() || !std::io::stderr().is_terminal() {
            return Self::Lines(prefix.into());
        }
        let bar = bars.add(ProgressBar::new(0).with_prefix(prefix.to_owned()));
        Self::Bar(match ProgressStyle::with_template(TEMPLATE) {
            Ok(style) => bar.with_style(style),
            // Only an invalid template leads here; the plain bar shows the same.
            Err(_) => bar,
        })
    }

    /// The progress hook of a run.
    pub(crate) fn hook(&self) -> ProgressHook<'static> {
        match self {
            Self::Bar(bar) => {
                let bar = bar.clone();
                let mut first = None;
                Box::new(move |progress| {
                    if first.is_none() {
                        // A resumed run has not computed its first steps in this time.
                        first = Some(progress.done);
                        bar.set_position(progress.done);
                        bar.reset_eta();
                    }
                    if is_tick(&progress) {
                        bar.set_length(progress.planned);
                        bar.set_message(format!("t = {:.3} s", progress.time));
                        bar.set_position(progress.done);
                    }
                })
            }
            Self::Lines(prefix) => {
                let prefix = prefix.clone();
                let mut first = None;
                Box::new(move |progress| {
                    let (done, timer) =
                        first.get_or_insert_with(|| (progress.done, LineTimer::start()));
                    let own = progress.done - *done;
                    if own > 0 && is_tick(&progress) && !is_quiet() && timer.is_due() {
                        let rate = own as f64 / timer.started.elapsed().as_secs_f64();
                        warn_aside!("{}", line(&prefix, &progress, rate));
                    }
                })
            }
        }
    }

    /// Removes the bar.
    pub(crate) fn clear(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// Progress of the static solution of a stage on the error stream.
pub(crate) struct StaticDisplay {
    prefix: String,
    bars: MultiProgress,
    /// The bar on a terminal during a stage.
    bar: Option<ProgressBar>,
    timer: LineTimer,
}

impl StaticDisplay {
    /// A display among other bars; the prefix distinguishes parallel cases and may be empty.
    pub(crate) fn among(bars: &MultiProgress, prefix: &str) -> Self {
        Self {
            prefix: prefix.into(),
            bars: bars.clone(),
            bar: None,
            timer: LineTimer::start(),
        }
    }

    /// Updates the display of a stage.
    pub(crate) fn update(&mut self, stage: &str, now: &StaticProgress) {
        if is_quiet() {
            return;
        }
        let text = format!(
            "{}stage '{stage}': {:.1} % of its load, correction {}, residual {:.1e} of the load",
            self.prefix,
            100.0 * now.share,
            now.correction,
            now.residual
        );
        if std::io::stderr().is_terminal() {
            let new = || self.bars.add(ProgressBar::new_spinner());
            let bar = self.bar.get_or_insert_with(new);
            bar.set_message(text);
            bar.tick();
        } else if self.timer.is_due() {
            warn_aside!("{text}");
        }
    }

    /// Removes the bar until the next update.
    pub(crate) fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

impl Drop for StaticDisplay {
    fn drop(&mut self) {
        self.clear();
    }
}

/// Timer of the lines.
struct LineTimer {
    started: Instant,
    next: Duration,
}

impl LineTimer {
    fn start() -> Self {
        Self {
            started: Instant::now(),
            next: BETWEEN_LINES,
        }
    }
    fn is_due(&mut self) -> bool {
        let elapsed = self.started.elapsed();
        let is_due = elapsed >= self.next;
        if is_due {
            self.next = elapsed + BETWEEN_LINES.max(elapsed / SHARE_BETWEEN_LINES);
        }
        is_due
    }
}

fn is_tick(progress: &Progress) -> bool {
    progress.done.is_multiple_of(STEPS_PER_TICK) || progress.done == progress.planned
}

/// A line of progress at a rate (steps/s) of this process.
fn line(prefix: &str, progress: &Progress, rate: f64) -> String {
    let left = (progress.planned - progress.done) as f64 / rate;
    let share = 100.0 * progress.done as f64 / progress.planned as f64;
    format!(
        "{prefix} {share:.0} %, t = {:.3} s, {rate:.0} steps/s, {left:.0} s left",
        progress.time
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of progress has the share that is done, and the time that the steps not yet done take at the rate, whatever the
    /// number of steps.
    #[test]
    fn a_line_has_the_time_that_is_left() {
        for (done, planned, rate, expected) in [
            (
                300,
                1000,
                7.0,
                "a: 30 %, t = 0.125 s, 7 steps/s, 100 s left",
            ),
            (
                960,
                1920,
                120.0,
                "a: 50 %, t = 0.125 s, 120 steps/s, 8 s left",
            ),
            (64, 64, 32.0, "a: 100 %, t = 0.125 s, 32 steps/s, 0 s left"),
        ] {
            let progress = Progress::new(done, planned, 0.125);
            assert_eq!(line("a:", &progress, rate), expected);
        }
    }
}
