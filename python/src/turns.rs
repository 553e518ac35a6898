//! Two threads that take turns: one that runs, one that looks at what it has reached.

use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Whose turn it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Turn {
    /// The run goes on.
    Run = 0,
    /// The run waits at a step.
    Pause = 1,
    /// The run answers a question at its step.
    Answer = 2,
    /// The run stops after its step.
    Stop = 3,
    /// There is no run any more.
    End = 4,
}

impl Turn {
    fn of(value: u8) -> Self {
        match value {
            0 => Self::Run,
            1 => Self::Pause,
            2 => Self::Answer,
            3 => Self::Stop,
            _ => Self::End,
        }
    }
}

/// The turn of two threads, each of which waits for its own.
///
/// A thread that waits first watches in a loop, which takes a tenth of a microsecond to notice, and then sleeps, which
/// takes some microseconds but leaves the processor to others.
pub(crate) struct Turns {
    turn: AtomicU8,
    sleepers: AtomicUsize,
    lock: Mutex<()>,
    bell: Condvar,
    /// Number of looks before a thread sleeps.
    looks: u32,
}

/// Looks in about 20 microseconds, and in some milliseconds.
const FEW_LOOKS: u32 = 2_000;
const MANY_LOOKS: u32 = 200_000;
/// Longest sleep between two looks.
const LONGEST: Duration = Duration::from_millis(50);

impl Turns {
    /// The turn of the run, with `threads` of its own; long watching is for machines with a processor to spare.
    pub(crate) fn new(threads: usize) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            turn: AtomicU8::new(Turn::Run as u8),
            sleepers: AtomicUsize::new(0),
            lock: Mutex::new(()),
            bell: Condvar::new(),
            looks: if processors > threads {
                MANY_LOOKS
            } else {
                FEW_LOOKS
            },
        }
    }

    /// Whose turn it is.
    pub(crate) fn present(&self) -> Turn {
        Turn::of(self.turn.load(Ordering::SeqCst))
    }

    /// Gives the turn, and wakes a thread that sleeps.
    pub(crate) fn give(&self, turn: Turn) {
        self.turn.store(turn as u8, Ordering::SeqCst);
        self.wake();
    }

    /// Gives the turn if it is `from` until then.
    pub(crate) fn change(&self, from: Turn, turn: Turn) -> bool {
        let (from, to) = (from as u8, turn as u8);
        let order = Ordering::SeqCst;
        let changed = self.turn.compare_exchange(from, to, order, order).is_ok();
        self.wake();
        changed
    }

    fn wake(&self) {
        if self.sleepers.load(Ordering::SeqCst) > 0 {
            drop(self.lock.lock().unwrap_or_else(PoisonError::into_inner));
            self.bell.notify_all();
        }
    }

    /// Waits while `goes_on` holds of the turn, or for one sleep at most; returns the turn.
    pub(crate) fn wait(&self, goes_on: impl Fn(Turn) -> bool) -> Turn {
        for _ in 0..self.looks {
            let turn = self.present();
            if !goes_on(turn) {
                return turn;
            }
            core::hint::spin_loop();
        }
        let guard = self.lock.lock().unwrap_or_else(PoisonError::into_inner);
        self.sleepers.fetch_add(1, Ordering::SeqCst);
        let woken = if goes_on(self.present()) {
            self.bell.wait_timeout(guard, LONGEST).map(drop)
        } else {
            Ok(())
        };
        self.sleepers.fetch_sub(1, Ordering::SeqCst);
        drop(woken);
        self.present()
    }
}
