//! Waiting for work on another thread, without the interpreter's lock.

use std::panic::resume_unwind;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// Wall time between two looks at signals and progress.
const EVERY: Duration = Duration::from_millis(50);

/// The outcome of work on another thread, and the first exception of a signal, such as Ctrl-C, or of `look` meanwhile.
/// `look` is called now and then with the interpreter's lock; `stop` once, after the exception.
pub(crate) fn wait_with<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
    mut look: impl FnMut(Python<'_>) -> PyResult<()> + Send,
    stop: impl Fn() + Send + Sync,
) -> (T, Option<PyErr>) {
    py.detach(|| {
        thread::scope(|scope| {
            let (sender, receiver) = channel();
            let worker = scope.spawn(move || {
                let done = work();
                // Nobody waits any more only if the thread that waits has panicked.
                let _ = sender.send(());
                done
            });
            let mut raised = None;
            while let Err(RecvTimeoutError::Timeout) = receiver.recv_timeout(EVERY) {
                let looked = Python::attach(|py| {
                    py.check_signals()?;
                    match raised {
                        None => look(py),
                        Some(_) => Ok(()),
                    }
                });
                if let Err(error) = looked {
                    stop();
                    raised.get_or_insert(error);
                }
            }
            match worker.join() {
                Ok(done) => (done, raised),
                Err(panic) => resume_unwind(panic),
            }
        })
    })
}

/// The outcome of work on another thread that cannot be stopped.
///
/// # Errors
/// The exception of a signal meanwhile, after the work.
pub(crate) fn wait_for<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    match wait_with(py, work, |_| Ok(()), || {}) {
        (done, None) => Ok(done),
        (_, Some(error)) => Err(error),
    }
}
