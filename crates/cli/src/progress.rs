//! How far a run is: a bar on a terminal, a line now and then elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use crate::terminal::warn_aside;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use powerhouse::ProgressHook;
use powerhouse::engine::{Progress, StaticProgress};

/// The bar is drawn anew after so many steps, and the clock looked at.
const STEPS_PER_TICK: u64 = 32;
/// Least time between lines where there is no terminal, and what it is of the time since the start: a run of
/// hours has some hundred lines.
const BETWEEN_LINES: Duration = Duration::from_secs(5);
const SHARE_BETWEEN_LINES: u32 = 20;
const TEMPLATE: &str = "{prefix} {bar:32} {percent:>3} %  {msg}  {per_sec}  {eta} left";

/// Shows on the error stream how far a run is, with its rate and the time that is left.
pub(crate) enum Display {
    Bar(ProgressBar),
    Lines(String),
}

impl Display {
    pub(crate) fn new(prefix: &str) -> Self {
        Self::among(&MultiProgress::new(), prefix)
    }

    /// One of several at a time.
    pub(crate) fn among(bars: &MultiProgress, prefix: &str) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self::Lines(prefix.into());
        }
        let bar = bars.add(ProgressBar::new(0).with_prefix(prefix.to_owned()));
        Self::Bar(match ProgressStyle::with_template(TEMPLATE) {
            Ok(style) => bar.with_style(style),
            // Only a fault of the template itself leads here; the plain bar tells the same.
            Err(_) => bar,
        })
    }

    /// Moves with a run.
    pub(crate) fn hook(&self) -> ProgressHook<'static> {
        match self {
            Self::Bar(bar) => {
                let bar = bar.clone();
                Box::new(move |progress| {
                    if is_tick(&progress) {
                        bar.set_length(progress.planned);
                        bar.set_message(format!("t = {:.3} s", progress.time));
                        bar.set_position(progress.done);
                    }
                })
            }
            Self::Lines(prefix) => {
                let (prefix, mut beat) = (prefix.clone(), Beat::start());
                Box::new(move |progress| {
                    if is_tick(&progress) && beat.is_due() {
                        warn_aside!("{}", line(&prefix, &progress, beat.started.elapsed()));
                    }
                })
            }
        }
    }

    /// Takes the bar away.
    pub(crate) fn clear(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// Shows on the error stream how far the static solution of a stage is.
pub(crate) struct Resting {
    prefix: String,
    bars: MultiProgress,
    /// On a terminal, while a stage goes on.
    bar: Option<ProgressBar>,
    beat: Beat,
}

impl Resting {
    /// One among other bars; the prefix tells cases side by side apart, and may be empty.
    pub(crate) fn among(bars: &MultiProgress, prefix: &str) -> Self {
        Self {
            prefix: prefix.into(),
            bars: bars.clone(),
            bar: None,
            beat: Beat::start(),
        }
    }

    /// Tells how far a stage is.
    pub(crate) fn tell(&mut self, stage: &str, now: &StaticProgress) {
        let text = format!(
            "{}stage '{stage}': {:.1} % of its load, iteration {}, {:.1e} out of balance",
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
        } else if self.beat.is_due() {
            warn_aside!("{text}");
        }
    }

    /// Takes the bar away until another stage tells.
    pub(crate) fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Resting {
    fn drop(&mut self) {
        self.clear();
    }
}

/// Says when the next line is due.
struct Beat {
    started: Instant,
    next: Duration,
}

impl Beat {
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

fn line(prefix: &str, progress: &Progress, elapsed: Duration) -> String {
    let rate = progress.done as f64 / elapsed.as_secs_f64();
    let left = (progress.planned - progress.done) as f64 / rate;
    let share = 100.0 * progress.done as f64 / progress.planned as f64;
    format!(
        "{prefix} {share:.0} %, t = {:.3} s, {rate:.0} steps/s, {left:.0} s left",
        progress.time
    )
}
