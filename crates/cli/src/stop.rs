//! Ctrl-C and the signals that ask a program to end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::INTERRUPTED;
use crate::terminal::warn_aside;

/// A flag that the first signal raises, so that what runs can end in order; the second signal ends
/// the program at once.
///
/// # Errors
/// If signals cannot be listened to.
pub(crate) fn flag() -> Result<Arc<AtomicBool>, ctrlc::Error> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = flag.clone();
    ctrlc::set_handler(move || {
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
        warn_aside!("ending in order; once more to end at once");
    })?;
    Ok(flag)
}
