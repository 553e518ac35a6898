//! Communication of a process with the others, as the rest of the program sees it.

use std::sync::mpsc::{Receiver, Sender, channel};

use powerhouse_model::{Message, RankError, Ranks};

/// A rank that is a process of an MPI computation, see [`with_ranks`](crate::with_ranks).
#[derive(Debug)]
pub struct MpiRanks {
    rank: usize,
    count: usize,
    requests: Sender<Request>,
    replies: Receiver<Reply>,
}

/// An operation that the thread of MPI carries out.
#[derive(Debug)]
pub(crate) enum Request {
    /// Messages to other ranks; there is no reply.
    Start(Vec<Message>),
    /// Ranks of which the next messages are received.
    Finish(Vec<usize>),
    Sum(Vec<i64>),
    Least(Vec<u64>),
    Gather(Vec<u8>),
    Broadcast(usize, Vec<u8>),
}

/// The result of an operation.
#[derive(Debug)]
pub(crate) enum Reply {
    Finish(Vec<Vec<u8>>),
    Sum(Vec<i64>),
    Least(Vec<u64>),
    Gather(Vec<Vec<u8>>),
    Broadcast(Vec<u8>),
}

/// The side of the thread of MPI.
pub(crate) struct Requests {
    pub(crate) requests: Receiver<Request>,
    pub(crate) replies: Sender<Reply>,
}

impl MpiRanks {
    pub(crate) fn new(rank: usize, count: usize) -> (Self, Requests) {
        let (to_mpi, requests) = channel();
        let (replies, from_mpi) = channel();
        let ranks = Self {
            rank,
            count,
            requests: to_mpi,
            replies: from_mpi,
        };
        (ranks, Requests { requests, replies })
    }

    fn check(&self, rank: usize) -> Result<(), RankError> {
        let count = self.count;
        if rank < count && rank != self.rank {
            Ok(())
        } else {
            Err(RankError::Unknown { rank, count })
        }
    }

    fn ended(&self) -> RankError {
        RankError::Failed {
            rank: self.rank,
            reason: "the thread of MPI has ended".into(),
        }
    }

    fn request(&self, request: Request) -> Result<(), RankError> {
        self.requests.send(request).map_err(|_| self.ended())
    }

    /// The reply to a request, of which `expected` takes the right one.
    fn reply<T>(
        &self,
        request: Request,
        expected: impl FnOnce(Reply) -> Option<T>,
    ) -> Result<T, RankError> {
        self.request(request)?;
        let reply = self.replies.recv().ok().and_then(expected);
        reply.ok_or_else(|| self.ended())
    }
}

impl Ranks for MpiRanks {
    fn rank(&self) -> usize {
        self.rank
    }
    fn count(&self) -> usize {
        self.count
    }
    fn start(&mut self, out: &mut [Message]) -> Result<(), RankError> {
        out.iter()
            .try_for_each(|message| self.check(message.rank))?;
        let taken = out.iter_mut().map(|message| {
            let mut taken = Message::new(message.rank);
            taken.bytes = core::mem::take(&mut message.bytes);
            taken
        });
        self.request(Request::Start(taken.collect()))
    }
    fn finish(&mut self, into: &mut [Message]) -> Result<(), RankError> {
        into.iter()
            .try_for_each(|message| self.check(message.rank))?;
        let from = into.iter().map(|message| message.rank).collect();
        let received = self.reply(Request::Finish(from), |reply| match reply {
            Reply::Finish(received) => Some(received),
            _ => None,
        })?;
        for (message, bytes) in into.iter_mut().zip(received) {
            message.bytes = bytes;
        }
        Ok(())
    }
    fn sum(&mut self, numbers: &mut [i64]) -> Result<(), RankError> {
        let sums = self.reply(Request::Sum(numbers.to_vec()), |reply| match reply {
            Reply::Sum(sums) => Some(sums),
            _ => None,
        })?;
        numbers.copy_from_slice(&sums);
        Ok(())
    }
    fn least(&mut self, numbers: &mut [u64]) -> Result<(), RankError> {
        let least = self.reply(Request::Least(numbers.to_vec()), |reply| match reply {
            Reply::Least(least) => Some(least),
            _ => None,
        })?;
        numbers.copy_from_slice(&least);
        Ok(())
    }
    fn gather(&mut self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, RankError> {
        self.reply(Request::Gather(bytes.to_vec()), |reply| match reply {
            Reply::Gather(gathered) => Some(gathered),
            _ => None,
        })
    }
    fn broadcast(&mut self, from: usize, bytes: &mut Vec<u8>) -> Result<(), RankError> {
        if from >= self.count {
            let count = self.count;
            return Err(RankError::Unknown { rank: from, count });
        }
        let own = core::mem::take(bytes);
        *bytes = self.reply(Request::Broadcast(from, own), |reply| match reply {
            Reply::Broadcast(bytes) => Some(bytes),
            _ => None,
        })?;
        Ok(())
    }
}
