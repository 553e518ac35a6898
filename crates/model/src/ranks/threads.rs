//! Ranks that are threads of one process.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::{Message, RankError, Ranks};

/// A rank that is a thread of the process: for tests, and where memory is divided among a few parts of one machine.
///
/// A rank that is dropped while others wait for it, as by a panic or an early return, is an error at all of them.
#[derive(Debug)]
pub struct ThreadRanks {
    rank: usize,
    shared: Arc<Shared>,
    /// Number of collective operations so far.
    round: u64,
    patience: Option<Duration>,
}

#[derive(Debug)]
struct Shared {
    board: Mutex<Board>,
    /// One for each rank, which waits on it.
    changed: Vec<Condvar>,
}

/// Everything that the ranks exchange.
#[derive(Debug)]
struct Board {
    /// Messages from each rank to each rank, at `to * count + from`.
    mail: Vec<VecDeque<Vec<u8>>>,
    /// Whether each rank has ended, and because of which one.
    ended: Vec<bool>,
    cause: Vec<usize>,
    /// Number of collective operations completed.
    round: u64,
    /// Contribution of each rank to the present collective operation, with its name.
    arrived: Vec<Option<(String, Vec<u8>)>>,
    /// Outcome of the last one; all ranks have read it when the next one completes.
    outcome: Result<Arc<Vec<Vec<u8>>>, RankError>,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Board> {
        // A panic elsewhere leaves the board as it was: nothing under the lock panics.
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ThreadRanks {
    /// The ranks of a computation, at least one, each to be moved to a thread of its own.
    pub fn all(count: usize) -> Vec<Self> {
        let count = count.max(1);
        let shared = Arc::new(Shared {
            board: Mutex::new(Board {
                mail: vec![VecDeque::new(); count * count],
                ended: vec![false; count],
                cause: (0..count).collect(),
                round: 0,
                arrived: vec![None; count],
                outcome: Ok(Arc::default()),
            }),
            changed: (0..count).map(|_| Condvar::new()).collect(),
        });
        (0..count)
            .map(|rank| Self {
                rank,
                shared: shared.clone(),
                round: 0,
                patience: None,
            })
            .collect()
    }

    /// Calls a function with every rank, each in a thread of its own; returns the results in the order of the ranks. The
    /// result of a rank that panics is [`RankError::Lost`].
    pub fn run<R: Send>(
        count: usize,
        work: impl Fn(Self) -> Result<R, RankError> + Sync,
    ) -> Vec<Result<R, RankError>> {
        let work = &work;
        std::thread::scope(|scope| {
            let threads: Vec<_> = (Self::all(count).into_iter())
                .map(|ranks| scope.spawn(move || work(ranks)))
                .collect();
            let joined = threads.into_iter().map(|thread| thread.join());
            let lost = |rank| Err(RankError::Lost { rank });
            (joined.enumerate())
                .map(|(rank, result)| result.unwrap_or_else(|_| lost(rank)))
                .collect()
        })
    }

    /// Sets the longest time that this rank waits for another one before it fails with [`RankError::Silent`]; without
    /// limit by default, because a rank that computes is silent too.
    #[must_use]
    pub fn with_patience(mut self, longest: Duration) -> Self {
        self.patience = Some(longest);
        self
    }

    fn check(&self, rank: usize) -> Result<(), RankError> {
        let count = self.count();
        if rank < count && rank != self.rank {
            Ok(())
        } else {
            Err(RankError::Unknown { rank, count })
        }
    }

    /// Waits until `take` finds what it needs on the board; `missing` is a rank that has not provided it.
    fn wait<T>(
        &self,
        mut take: impl FnMut(&mut Board) -> Option<T>,
        missing: impl Fn(&Board) -> Option<usize>,
    ) -> Result<T, RankError> {
        let latest = |patience| Instant::now().checked_add(patience);
        let deadline = self.patience.and_then(latest);
        let mut board = self.shared.lock();
        loop {
            if let Some(found) = take(&mut board) {
                return Ok(found);
            }
            if let Some(rank) = missing(&board).filter(|&rank| board.ended[rank]) {
                let rank = board.cause[rank];
                board.cause[self.rank] = rank;
                return Err(RankError::Lost { rank });
            }
            let changed = &self.shared.changed[self.rank];
            let Some(deadline) = deadline else {
                board = changed.wait(board).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                let rank = missing(&board).unwrap_or(self.rank);
                let seconds = self.patience.unwrap_or_default().as_secs_f64();
                board.cause[self.rank] = rank;
                return Err(RankError::Silent { rank, seconds });
            }
            let waited = changed.wait_timeout(board, left);
            board = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// The contributions of all ranks to a collective operation.
    fn collect(
        &mut self,
        operation: String,
        bytes: Vec<u8>,
    ) -> Result<Arc<Vec<Vec<u8>>>, RankError> {
        let own = self.round;
        self.round += 1;
        {
            let mut board = self.shared.lock();
            board.arrived[self.rank] = Some((operation, bytes));
            if board.arrived.iter().all(Option::is_some) {
                let all = board.arrived.iter_mut().filter_map(Option::take);
                let outcome = agreed(all.collect());
                board.outcome = outcome;
                board.round += 1;
                self.shared.changed.iter().for_each(Condvar::notify_one);
            }
        }
        self.wait(
            |board| (board.round > own).then(|| board.outcome.clone()),
            |board| {
                let mut absent = (0..).zip(&board.arrived).filter(|(_, a)| a.is_none());
                let ended = absent.clone().find(|(rank, _)| board.ended[*rank]);
                ended.or_else(|| absent.next()).map(|(rank, _)| rank)
            },
        )?
    }
}

/// The contributions to a collective operation, which all ranks must have called alike.
fn agreed(all: Vec<(String, Vec<u8>)>) -> Result<Arc<Vec<Vec<u8>>>, RankError> {
    let expected = all[0].0.clone();
    let other = (all.iter().enumerate()).find(|(_, (operation, _))| *operation != expected);
    if let Some((rank, (found, _))) = other {
        let found = found.clone();
        return Err(RankError::Mismatch {
            rank,
            found,
            expected,
        });
    }
    Ok(Arc::new(all.into_iter().map(|(_, bytes)| bytes).collect()))
}

/// The numbers of eight bytes each of a contribution.
fn numbers(bytes: &[u8]) -> impl Iterator<Item = [u8; 8]> {
    (bytes.chunks_exact(8)).map(|chunk| core::array::from_fn(|i| chunk[i]))
}

impl Ranks for ThreadRanks {
    fn rank(&self) -> usize {
        self.rank
    }
    fn count(&self) -> usize {
        self.shared.changed.len()
    }
    fn start(&mut self, out: &mut [Message]) -> Result<(), RankError> {
        for message in out {
            self.check(message.rank)?;
            let index = message.rank * self.count() + self.rank;
            let bytes = core::mem::take(&mut message.bytes);
            self.shared.lock().mail[index].push_back(bytes);
            self.shared.changed[message.rank].notify_one();
        }
        Ok(())
    }
    fn finish(&mut self, into: &mut [Message]) -> Result<(), RankError> {
        for message in into {
            let from = message.rank;
            self.check(from)?;
            let index = self.rank * self.count() + from;
            message.bytes = self.wait(|board| board.mail[index].pop_front(), |_| Some(from))?;
        }
        Ok(())
    }
    fn sum(&mut self, terms: &mut [i64]) -> Result<(), RankError> {
        let own = terms.iter().flat_map(|term| term.to_ne_bytes()).collect();
        let all = self.collect(format!("sum of {} numbers", terms.len()), own)?;
        terms.fill(0);
        for bytes in all.iter() {
            for (sum, term) in terms.iter_mut().zip(numbers(bytes)) {
                *sum = sum.wrapping_add(i64::from_ne_bytes(term));
            }
        }
        Ok(())
    }
    fn least(&mut self, candidates: &mut [u64]) -> Result<(), RankError> {
        let own = candidates.iter().flat_map(|n| n.to_ne_bytes()).collect();
        let all = self.collect(format!("least of {} numbers", candidates.len()), own)?;
        for bytes in all.iter() {
            for (least, number) in candidates.iter_mut().zip(numbers(bytes)) {
                *least = (*least).min(u64::from_ne_bytes(number));
            }
        }
        Ok(())
    }
    fn gather(&mut self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, RankError> {
        let all = self.collect("gather".into(), bytes.to_vec())?;
        Ok(match self.rank {
            0 => all.to_vec(),
            _ => Vec::new(),
        })
    }
    fn broadcast(&mut self, from: usize, bytes: &mut Vec<u8>) -> Result<(), RankError> {
        let count = self.count();
        if from >= count {
            return Err(RankError::Unknown { rank: from, count });
        }
        let own = if self.rank == from {
            bytes.clone()
        } else {
            Vec::new()
        };
        let all = self.collect(format!("broadcast from rank {from}"), own)?;
        bytes.clone_from(&all[from]);
        Ok(())
    }
}

impl Drop for ThreadRanks {
    fn drop(&mut self) {
        self.shared.lock().ended[self.rank] = true;
        self.shared.changed.iter().for_each(Condvar::notify_one);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time by which everybody must know of a failure.
    const SOON: Duration = Duration::from_secs(5);

    /// Delays a rank in a different way in every round.
    fn delay(rank: usize, round: u64) {
        let steps = (rank as u64 * 7 + round * 5) % 4;
        std::thread::sleep(Duration::from_micros(300 * steps));
    }

    /// Neighbours receive messages in the order in which they were sent, whichever rank arrives first, and one may be
    /// ahead of the other.
    #[test]
    fn messages_arrive_in_the_order_in_which_they_were_sent() {
        let found = ThreadRanks::run(4, |mut ranks| {
            let own = ranks.rank();
            let others: Vec<usize> = (0..4).filter(|&rank| rank != own).collect();
            let mut into: Vec<Message> = others.iter().map(|&rank| Message::new(rank)).collect();
            for round in 0..40_u8 {
                delay(own, round.into());
                let mut out = into.clone();
                for message in &mut out {
                    message.bytes = vec![own as u8, message.rank as u8, round];
                }
                ranks.start(&mut out)?;
                delay(own, u64::from(round) + 1);
                ranks.finish(&mut into)?;
                for message in &into {
                    assert_eq!(message.bytes, [message.rank as u8, own as u8, round]);
                }
            }
            Ok(into.len())
        });
        assert_eq!(found, vec![Ok(3); 4]);
    }

    /// Collective operations have the same result on every rank, in whatever order the ranks arrive.
    #[test]
    fn collective_operations_agree_in_any_order_of_arrival() {
        let count = 5;
        let found = ThreadRanks::run(count, |mut ranks| {
            let own = ranks.rank();
            for round in 0..30_u64 {
                delay(own, round);
                let mut terms = [own as i64 - 2, i64::MAX, round as i64];
                ranks.sum(&mut terms)?;
                assert_eq!(terms, [0, i64::MAX - 4, 5 * round as i64]);
                let mut least = [100 - own as u64, own as u64 + round, u64::MAX];
                ranks.least(&mut least)?;
                assert_eq!(least, [96, round, u64::MAX]);
                let gathered = ranks.gather(&vec![own as u8; own])?;
                let all: Vec<Vec<u8>> = (0..count).map(|rank| vec![rank as u8; rank]).collect();
                assert_eq!(gathered, if own == 0 { all } else { Vec::new() });
                let from = round as usize % count;
                let mut bytes = vec![own as u8, round as u8];
                ranks.broadcast(from, &mut bytes)?;
                assert_eq!(bytes, [from as u8, round as u8]);
            }
            Ok(())
        });
        assert_eq!(found, vec![Ok(()); count]);
    }

    /// A rank that panics or returns early is reported to all others within seconds, also to those that wait for another
    /// one that waits for it, and to those that wait in a collective operation.
    #[test]
    fn a_rank_that_ends_early_is_reported_to_all_others() {
        let start = Instant::now();
        for panics in [false, true] {
            let found = ThreadRanks::run(4, |mut ranks| {
                let own = ranks.rank();
                match own {
                    2 if panics => std::panic::resume_unwind(Box::new("a failure")),
                    2 => Ok(0),
                    // Rank 0 waits for rank 1, which waits for rank 2.
                    0 | 1 => {
                        ranks.finish(&mut [Message::new(own + 1)])?;
                        Ok(1)
                    }
                    _ => {
                        ranks.sum(&mut [1])?;
                        Ok(1)
                    }
                }
            });
            let lost = Err(RankError::Lost { rank: 2 });
            let own = if panics { lost.clone() } else { Ok(0) };
            assert_eq!(found, [lost.clone(), lost.clone(), own, lost]);
        }
        assert!(start.elapsed() < SOON);
    }

    /// A rank receives what another one sent before it ended.
    #[test]
    fn messages_outlive_their_sender() {
        let found = ThreadRanks::run(2, |mut ranks| {
            if ranks.rank() == 0 {
                ranks.start(&mut [Message {
                    rank: 1,
                    bytes: vec![9],
                }])?;
                return Ok(Vec::new());
            }
            std::thread::sleep(Duration::from_millis(20));
            let mut into = [Message::new(0)];
            ranks.finish(&mut into)?;
            Ok(core::mem::take(&mut into[0].bytes))
        });
        assert_eq!(found, [Ok(Vec::new()), Ok(vec![9])]);
    }

    /// Ranks that call different operations, or wait for longer than they have patience, end with errors that say so.
    #[test]
    fn ranks_that_disagree_end_with_errors() {
        let found = ThreadRanks::run(3, |mut ranks| match ranks.rank() {
            1 => ranks.least(&mut [1, 2]),
            _ => ranks.sum(&mut [1]),
        });
        let expected = RankError::Mismatch {
            rank: 1,
            found: "least of 2 numbers".into(),
            expected: "sum of 1 numbers".into(),
        };
        assert_eq!(found, vec![Err(expected); 3]);

        let start = Instant::now();
        let found = ThreadRanks::run(2, |ranks| {
            let mut ranks = ranks.with_patience(Duration::from_millis(50));
            let other = 1 - ranks.rank();
            ranks.finish(&mut [Message::new(other)])
        });
        let silent = |found: &Result<(), RankError>| {
            let error = found.as_ref().unwrap_err();
            matches!(error, RankError::Silent { seconds, .. } if *seconds == 0.05)
                || matches!(error, RankError::Lost { .. })
        };
        assert!(found.iter().all(silent), "{found:?}");
        let is_silent = |f: &Result<(), RankError>| matches!(f, Err(RankError::Silent { .. }));
        assert!(found.iter().any(is_silent));
        assert!(start.elapsed() < SOON);

        let found = ThreadRanks::run(2, |mut ranks| {
            let own = ranks.rank();
            let to_itself = ranks.start(&mut [Message::new(own)]);
            let beyond = ranks.broadcast(2, &mut Vec::new());
            Ok([to_itself, beyond])
        });
        let unknown = |rank| Err(RankError::Unknown { rank, count: 2 });
        assert_eq!(found[1], Ok([unknown(1), unknown(2)]));
    }
}
