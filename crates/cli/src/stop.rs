//! Cancellation by Ctrl-C and termination signals.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::INTERRUPTED;
use crate::terminal::warn_aside;

/// The cancellation flag, which the first signal sets so that a run ends in order; the second signal ends the program
/// at once.
///
/// # Errors
/// A signal handler that cannot be installed.
pub(crate) fn flag() -> Result<Arc<AtomicBool>, ctrlc::Error> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = flag.clone();
    ctrlc::set_handler(move || {
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
        warn_aside!("stopping the run and writing its results; press again to end at once");
    })?;
    Ok(flag)
}
