//! Parallel execution of cases.

use std::collections::VecDeque;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use super::locked;
use crate::StudyError;

/// Runs the jobs 0 to `count - 1` in their order on a number of workers; returns their results in the same order.
///
/// A job that returns `None` cannot be run yet: it is passed over, and called again after the others. When a worker has
/// nothing but such jobs left, it calls `waits` with them, which takes some time, before it calls them again.
///
/// # Errors
/// The error of the first failed job, or of `waits`. Jobs that are running then are completed; no others are started.
pub(super) fn side_by_side<T: Send>(
    count: usize,
    workers: NonZeroUsize,
    job: impl Fn(usize) -> Result<Option<T>, StudyError> + Sync,
    waits: impl Fn(&[usize]) -> Result<(), StudyError> + Sync,
) -> Result<Vec<T>, StudyError> {
    let queue: Mutex<VecDeque<usize>> = Mutex::new((0..count).collect());
    let failed = AtomicBool::new(false);
    let done: Mutex<Vec<(usize, Result<T, StudyError>)>> = Mutex::default();
    let end = |index: usize, found: Result<T, StudyError>| {
        if found.is_err() {
            failed.store(true, Ordering::Relaxed);
        }
        locked(&done).push((index, found));
    };
    let work = || {
        // Number of jobs in succession that were passed over.
        let mut passed = 0;
        while !failed.load(Ordering::Relaxed) {
            // Other workers have the jobs that are not in the queue.
            let Some(index) = locked(&queue).pop_front() else {
                break;
            };
            if let Some(found) = job(index).transpose() {
                passed = 0;
                end(index, found);
                continue;
            }
            passed += 1;
            let left: Vec<usize> = {
                let mut queue = locked(&queue);
                queue.push_back(index);
                queue.iter().copied().collect()
            };
            if passed < left.len() {
                continue;
            }
            passed = 0;
            if let Err(error) = waits(&left) {
                end(index, Err(error));
            }
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
    use std::sync::atomic::AtomicUsize;

    use super::*;

    fn no_wait(left: &[usize]) -> Result<(), StudyError> {
        panic!("{left:?} were passed over")
    }

    /// Results are in the order of the jobs for any number of workers, and each job runs once.
    #[test]
    fn jobs_run_once_and_return_in_order() {
        for workers in [1, 2, 3, 20].map(|workers| NonZeroUsize::new(workers).unwrap()) {
            let done: Vec<AtomicUsize> = (0..10).map(|_| AtomicUsize::new(0)).collect();
            let job = |index: usize| {
                done[index].fetch_add(1, Ordering::Relaxed);
                Ok(Some(index * index))
            };
            let found = side_by_side(10, workers, job, no_wait);
            let squares: Vec<usize> = (0..10).map(|index| index * index).collect();
            assert_eq!(found.unwrap(), squares);
            assert!(done.iter().all(|done| done.load(Ordering::Relaxed) == 1));
        }
        let none = side_by_side(0, NonZeroUsize::MIN, |index| Ok(Some(index)), no_wait);
        assert!(none.unwrap().is_empty());
    }

    /// Two workers run two jobs simultaneously: each of these waits for the other.
    #[test]
    fn workers_work_side_by_side() {
        let both = std::sync::Barrier::new(2);
        let job = |index| {
            both.wait();
            Ok(Some(index))
        };
        let found = side_by_side(2, NonZeroUsize::new(2).unwrap(), job, no_wait);
        assert_eq!(found.unwrap(), [0, 1]);
    }

    /// Jobs that cannot be run yet come after the others, and workers wait when nothing else is left.
    #[test]
    fn jobs_that_are_passed_over_come_last() {
        let (begun, rounds) = (Mutex::new(Vec::new()), AtomicUsize::new(0));
        let job = |index| {
            let is_free = ![1, 2].contains(&index) || rounds.load(Ordering::Relaxed) > 1;
            if is_free {
                locked(&begun).push(index);
            }
            Ok(is_free.then_some(index))
        };
        let waits = |left: &[usize]| {
            assert_eq!(left, [1, 2]);
            rounds.fetch_add(1, Ordering::Relaxed);
            Ok(())
        };
        let found = side_by_side(5, NonZeroUsize::MIN, job, waits);
        assert_eq!(found.unwrap(), [0, 1, 2, 3, 4]);
        assert_eq!(*locked(&begun), [0, 3, 4, 1, 2]);
        assert_eq!(rounds.into_inner(), 2);
        // An error while waiting ends the work.
        let waits = |_: &[usize]| Err(StudyError::Interrupted);
        let workers = NonZeroUsize::new(2).unwrap();
        let stopped = side_by_side(5, workers, |index| Ok((index != 3).then_some(index)), waits);
        assert!(matches!(stopped, Err(StudyError::Interrupted)));
    }

    /// After an error no further job is started, and the first error is returned.
    #[test]
    fn an_error_ends_the_work() {
        for workers in [1, 2].map(|workers| NonZeroUsize::new(workers).unwrap()) {
            let begun = AtomicUsize::new(0);
            let job = |index: usize| {
                begun.fetch_add(1, Ordering::Relaxed);
                match index {
                    3.. => Err(StudyError::NoResults {
                        folder: PathBuf::from(index.to_string()),
                    }),
                    _ => Ok(Some(index)),
                }
            };
            let found = side_by_side(100, workers, job, no_wait);
            let fault = found.unwrap_err().to_string();
            assert!(fault.starts_with("3 contains"), "{fault}");
            // The job of the other worker is completed.
            assert!(begun.into_inner() <= 3 + workers.get());
        }
    }
}
