//! How far a run is: a bar on a terminal, a line now and then elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use powerhouse::ProgressHook;
use powerhouse::engine::Progress;

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
                let (prefix, started) = (prefix.clone(), Instant::now());
                let mut next = BETWEEN_LINES;
                Box::new(move |progress| {
                    if is_tick(&progress) && started.elapsed() >= next {
                        let elapsed = started.elapsed();
                        next = elapsed + BETWEEN_LINES.max(elapsed / SHARE_BETWEEN_LINES);
                        eprintln!("{}", line(&prefix, &progress, elapsed));
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
