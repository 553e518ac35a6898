//! The progress bar.

use indicatif::{ProgressBar, ProgressStyle};
use powerhouse::ProgressHook;

/// The bar is drawn anew after so many steps.
const STEPS_PER_TICK: u64 = 32;
const TEMPLATE: &str = "{prefix} {bar:32} {percent:>3} %  {msg}  {per_sec}  {eta} left";

/// A bar with rate and remaining time.
pub(crate) fn bar(prefix: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(0).with_prefix(prefix);
    match ProgressStyle::with_template(TEMPLATE) {
        Ok(style) => bar.with_style(style),
        // Only a fault of the template itself leads here; the plain bar tells the same.
        Err(_) => bar,
    }
}

/// Moves a bar with a run.
pub(crate) fn hook(bar: &ProgressBar) -> ProgressHook<'_> {
    Box::new(move |progress| {
        if progress.done.is_multiple_of(STEPS_PER_TICK) || progress.done == progress.planned {
            bar.set_length(progress.planned);
            bar.set_message(format!("t = {:.3} s", progress.time));
            bar.set_position(progress.done);
        }
    })
}
