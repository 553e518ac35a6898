//! Ranks: parts of one computation with memory of their own, which exchange messages.

mod forecast;
mod single;
mod threads;

use thiserror::Error;

pub use forecast::RankForecast;
pub use single::SingleRank;
pub use threads::ThreadRanks;

/// A message between two ranks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Message {
    /// The other rank: the receiver of a message that is sent, the sender of one that is received.
    pub rank: usize,
    /// Content, in a form on which both ranks agree.
    pub bytes: Vec<u8>,
}

impl Message {
    /// An empty message to or from a rank.
    pub fn new(rank: usize) -> Self {
        Self {
            rank,
            bytes: Vec::new(),
        }
    }
}

/// Communication of one rank with the others of its computation: processes or threads that each hold a part of the body.
///
/// An exchange has two halves, so that a rank can compute between them: [`start`](Self::start) sends messages and does
/// not wait, [`finish`](Self::finish) waits for those of other ranks. Messages between two ranks arrive in the order in
/// which they were sent. All other operations are collective: every rank calls the same ones in the same order, and each
/// returns when all ranks have called it. None of them rounds, so that results do not depend on the number of ranks or
/// the order of their arrival.
///
/// ```
/// use powerhouse_model::{Message, Ranks, ThreadRanks};
/// // Each of three ranks sends its number to the next one.
/// let received = ThreadRanks::run(3, |mut ranks| {
///     let (rank, count) = (ranks.rank(), ranks.count());
///     let mut out = [Message::new((rank + 1) % count)];
///     out[0].bytes.push(rank as u8);
///     ranks.start(&mut out)?;
///     let mut into = [Message::new((rank + count - 1) % count)];
///     ranks.finish(&mut into)?;
///     let mut sum = [rank as i64];
///     ranks.sum(&mut sum)?;
///     Ok((into[0].bytes.clone(), sum[0]))
/// });
/// let expected = [(vec![2], 3), (vec![0], 3), (vec![1], 3)].map(Ok);
/// assert_eq!(received, expected);
/// ```
pub trait Ranks: Send {
    /// Number of this rank, from 0.
    fn rank(&self) -> usize;
    /// Number of ranks, at least 1.
    fn count(&self) -> usize;
    /// Sends messages, one to each of some ranks, and returns without waiting for their receivers. Their bytes are taken.
    ///
    /// # Errors
    /// A receiver that does not exist.
    fn start(&mut self, out: &mut [Message]) -> Result<(), RankError>;
    /// Receives the next message of each of some ranks, whose bytes replace those of `into`; waits for them.
    ///
    /// # Errors
    /// A sender that does not exist, or that has ended without sending.
    fn finish(&mut self, into: &mut [Message]) -> Result<(), RankError>;
    /// Replaces each number by the sum over all ranks; sums beyond the range of the type wrap around.
    ///
    /// # Errors
    /// A rank that has ended, or that calls another operation or with another number of numbers.
    fn sum(&mut self, numbers: &mut [i64]) -> Result<(), RankError>;
    /// Replaces each number by the least one over all ranks.
    ///
    /// # Errors
    /// As [`sum`](Self::sum).
    fn least(&mut self, numbers: &mut [u64]) -> Result<(), RankError>;
    /// Returns the bytes of all ranks in their order on rank 0, and nothing on the others.
    ///
    /// # Errors
    /// A rank that has ended or calls another operation.
    fn gather(&mut self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, RankError>;
    /// Replaces the bytes on all ranks by those of the rank `from`.
    ///
    /// # Errors
    /// As [`gather`](Self::gather), and a rank `from` that does not exist.
    fn broadcast(&mut self, from: usize, bytes: &mut Vec<u8>) -> Result<(), RankError>;
}

/// A failure of the communication between ranks.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RankError {
    /// A rank that has ended while others wait for it.
    #[error("rank {rank} has ended before the others")]
    Lost {
        /// Number of the rank.
        rank: usize,
    },
    /// A rank that has not been heard of for the longest permitted time.
    #[error("rank {rank} has sent nothing for {seconds} s")]
    Silent {
        /// Number of the rank.
        rank: usize,
        /// Longest permitted time (s).
        seconds: f64,
    },
    /// Ranks that call different operations, or the same one with different lengths.
    #[error("rank {rank} calls '{found}' where rank 0 calls '{expected}'")]
    Mismatch {
        /// Number of the rank.
        rank: usize,
        /// Its operation.
        found: String,
        /// Operation of rank 0.
        expected: String,
    },
    /// A message of another length than both ranks should have agreed on.
    #[error("a message from rank {rank} has {found} bytes instead of {expected}")]
    Length {
        /// Number of the sender.
        rank: usize,
        /// Length received (bytes).
        found: usize,
        /// Length expected (bytes).
        expected: usize,
    },
    /// A rank that does not exist, or a message of a rank to itself.
    #[error("there is no other rank {rank} among {count}")]
    Unknown {
        /// Number given.
        rank: usize,
        /// Number of ranks.
        count: usize,
    },
    /// A failure that the library in use reports.
    #[error("rank {rank}: {reason}")]
    Failed {
        /// Number of the rank.
        rank: usize,
        /// Message of the library.
        reason: String,
    },
}
