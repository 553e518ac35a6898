//! Parallel execution of cases.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::locked;
use crate::StudyError;

/// Runs the jobs 0 to `count - 1` in their order on a number of workers; returns their results in the same order.
///
/// # Errors
/// The error of the first failed job. Jobs that are running then are completed; no others are started.
pub(super) fn side_by_side<T: Send>(
    count: usize,
    workers: NonZeroUsize,
    job: impl Fn(usize) -> Result<T, StudyError> + Sync,
) -> Result<Vec<T>, StudyError> {
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let done: Mutex<Vec<(usize, Result<T, StudyError>)>> = Mutex::default();
    let work = || {
        while !failed.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                break;
            }
            let found = job(index);
            if found.is_err() {
                failed.store(true, Ordering::Relaxed);
            }
            locked(&done).push((index, found));
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..workers.get().min(count) {
            scope.spawn(work);
        }
        work();
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, found)| found).collect()
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// Results are in the order of the jobs for any number of workers, and each job runs once.
    #[test]
    fn jobs_run_once_and_return_in_order() {
        for workers in [1, 2, 3, 20].map(|workers| NonZeroUsize::new(workers).unwrap()) {
            let done: Vec<AtomicUsize> = (0..10).map(|_| AtomicUsize::new(0)).collect();
            let found = side_by_side(10, workers, |index| {
                done[index].fetch_add(1, Ordering::Relaxed);
                Ok(index * index)
            });
            let squares: Vec<usize> = (0..10).map(|index| index * index).collect();
            assert_eq!(found.unwrap(), squares);
            assert!(done.iter().all(|done| done.load(Ordering::Relaxed) == 1));
        }
        assert!(side_by_side(0, NonZeroUsize::MIN, Ok).unwrap().is_empty());
    }

    /// Two workers run two jobs simultaneously: each of these waits for the other.
    #[test]
    fn workers_work_side_by_side() {
        let both = std::sync::Barrier::new(2);
        let found = side_by_side(2, NonZeroUsize::new(2).unwrap(), |index| {
            both.wait();
            Ok(index)
        });
        assert_eq!(found.unwrap(), [0, 1]);
    }

    /// After an error no further job is started, and the first error is returned.
    #[test]
    fn an_error_ends_the_work() {
        for workers in [1, 2].map(|workers| NonZeroUsize::new(workers).unwrap()) {
            let begun = AtomicUsize::new(0);
            let found = side_by_side(100, workers, |index| {
                begun.fetch_add(1, Ordering::Relaxed);
                match index {
                    3.. => Err(StudyError::NoResults {
                        folder: PathBuf::from(index.to_string()),
                    }),
                    _ => Ok(index),
                }
            });
            let fault = found.unwrap_err().to_string();
            assert!(fault.starts_with("3 contains"), "{fault}");
            // The job of the other worker is completed.
            assert!(begun.into_inner() <= 3 + workers.get());
        }
    }
}
