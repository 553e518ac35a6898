//! Number of computing threads of a run.

use crate::{Scene, remark};

impl Scene {
    /// Number of computing threads: as requested, at most those of the machine; `None` for all.
    pub(crate) fn threads_taken(&self) -> Option<usize> {
        let available = available_threads();
        self.threads.map(|wanted| wanted.min(available))
    }

    /// Adds a warning about a number of threads above that of the machine.
    pub fn check_threads(&mut self) {
        let available = available_threads();
        if let Some(wanted) = self.threads.filter(|wanted| *wanted > available) {
            self.remark_once(remark::Threads { wanted, available });
        }
    }
}

/// Number of threads of the machine.
fn available_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
