//! Cases side by side.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::locked;
use crate::StudyError;

/// Does the jobs 0 to `count` in their order, so many at once as there are workers; yields what they came
/// to, in the same order.
///
/// # Errors
/// The fault of the first job that has one. Jobs that others are at then are finished, no others begun.
pub(super) fn side_by_side<T: Send>(
    count: usize,
    workers: NonZeroUsize,
    job: impl Fn(usize) -> Result<T, StudyError> + Sync,
) -> Result<Vec<T>, StudyError> {
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let done: Mutex<Vec<(usize, Result<T, StudyError>)>> = Mutex::default();
    let work = || {
        while !failed.load(Ordering::Relaxed) {
            let place = next.fetch_add(1, Ordering::Relaxed);
            if place >= count {
                break;
            }
            let found = job(place);
            if found.is_err() {
                failed.store(true, Ordering::Relaxed);
            }
            locked(&done).push((place, found));
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..workers.get().min(count) {
            scope.spawn(work);
        }
        work();
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, found)| found).collect()
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// Jobs come out in their order, whatever the number of workers, each done once.
    #[test]
    fn jobs_are_done_once_and_come_out_in_order() {
        for workers in [1, 2, 3, 20].map(|workers| NonZeroUsize::new(workers).unwrap()) {
            let done: Vec<AtomicUsize> = (0..10).map(|_| AtomicUsize::new(0)).collect();
            let found = side_by_side(10, workers, |place| {
                done[place].fetch_add(1, Ordering::Relaxed);
                Ok(place * place)
            });
            let squares: Vec<usize> = (0..10).map(|place| place * place).collect();
            assert_eq!(found.unwrap(), squares);
            assert!(done.iter().all(|done| done.load(Ordering::Relaxed) == 1));
        }
        assert!(side_by_side(0, NonZeroUsize::MIN, Ok).unwrap().is_empty());
    }

    /// Two workers are at two jobs at once: each of these waits for the other.
    #[test]
    fn workers_work_side_by_side() {
        let both = std::sync::Barrier::new(2);
        let found = side_by_side(2, NonZeroUsize::new(2).unwrap(), |place| {
            both.wait();
            Ok(place)
        });
        assert_eq!(found.unwrap(), [0, 1]);
    }

    /// After a fault no other job is begun, and the first fault is told.
    #[test]
    fn a_fault_ends_the_work() {
        for workers in [1, 2].map(|workers| NonZeroUsize::new(workers).unwrap()) {
            let begun = AtomicUsize::new(0);
            let found = side_by_side(100, workers, |place| {
                begun.fetch_add(1, Ordering::Relaxed);
                match place {
                    3.. => Err(StudyError::NoResults {
                        folder: PathBuf::from(place.to_string()),
                    }),
                    _ => Ok(place),
                }
            });
            let fault = found.unwrap_err().to_string();
            assert!(fault.starts_with("3 holds"), "{fault}");
            // What the other worker was at is finished.
            assert!(begun.into_inner() <= 3 + workers.get());
        }
    }
}
