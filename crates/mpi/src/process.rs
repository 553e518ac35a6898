//! The thread of MPI: it carries out the operations of the ranks, and ends the process together with the others.

use core::num::NonZeroUsize;
use std::time::{Duration, Instant};

use mpi::Threading;
use mpi::collective::SystemOperation;
use mpi::environment::Universe;
use mpi::topology::{Color, SimpleCommunicator};
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Equivalence, Root, Source};
use thiserror::Error;

use crate::ranks::{MpiRanks, Reply, Request, Requests};

/// Tags of messages between two ranks, and of the parts of gathered bytes.
const MESSAGE: i32 = 1;
const GATHERED: i32 = 2;
/// Largest number of bytes of a part of a longer transfer: the library counts with 32 bits.
const PART: usize = 1 << 30;
/// Time for which a process that has failed waits for the others to end as well.
const GRACE: Duration = Duration::from_secs(5);
/// Time between two looks at whether the others have ended.
const INTERVAL: Duration = Duration::from_millis(1);
/// Exit status of an aborted computation.
const ABORTED: i32 = 2;
/// Memory in the buffer of the library that a message needs beside its bytes, generously.
const ENVELOPE: usize = 1024;
/// Number of exchanges whose messages the buffer holds: two can be under way, and two short ones after a failure.
const EXCHANGES: usize = 4;

/// A failure of the MPI library.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MpiError {
    /// A library that is in use already, or that cannot be initialised.
    #[error("MPI could not be initialised, or was initialised before")]
    NotInitialised,
    /// A library that permits no threads beside the one that uses it.
    #[error("the MPI library permits no other threads beside the one that uses it")]
    NoThreads,
    /// Processes that cannot be divided into groups of one size.
    #[error("{processes} processes cannot be divided into groups of {size}")]
    NoGroups {
        /// Number of processes.
        processes: usize,
        /// Size of a group.
        size: usize,
    },
}

/// Initialises MPI, and calls a function with the ranks of this process on a thread of its own; returns its result when the
/// function has returned on all processes.
///
/// A process whose function fails, or panics, waits some seconds for the others of its group to end; if they do not, as after a
/// failure of this process alone, it calls `report` with the error, and aborts all processes of the computation.
///
/// # Errors
/// See [`MpiError`].
pub fn with_ranks<R: Send, E: Send>(
    work: impl FnOnce(MpiRanks) -> Result<R, E> + Send,
    report: impl FnOnce(&E),
) -> Result<Result<R, E>, MpiError> {
    with_groups(None, work, report)
}

/// As [`with_ranks`] with processes in groups of a size, those of successive numbers, whose ranks know of those of their group
/// alone; with all processes in one group if there is no size.
///
/// # Errors
/// [`MpiError::NoGroups`] for a number of processes that is no multiple of the size; others as [`with_ranks`].
pub fn with_groups<R: Send, E: Send>(
    size: Option<NonZeroUsize>,
    work: impl FnOnce(MpiRanks) -> Result<R, E> + Send,
    report: impl FnOnce(&E),
) -> Result<Result<R, E>, MpiError> {
    let initialised = mpi::initialize_with_threading(Threading::Funneled);
    let (mut universe, threading) = initialised.ok_or(MpiError::NotInitialised)?;
    if threading == Threading::Single {
        return Err(MpiError::NoThreads);
    }
    let world = universe.world();
    let group = group_of(&world, size)?;
    let (ranks, requests) = MpiRanks::new(group.rank() as usize, group.size() as usize);
    let joined = std::thread::scope(|scope| {
        let thread = scope.spawn(move || work(ranks));
        Service {
            universe: &mut universe,
            group: &group,
            capacity: 0,
            spare: Vec::new(),
        }
        .serve(requests);
        thread.join()
    });
    match joined {
        Ok(result) => {
            let limit = result.is_err().then_some(GRACE);
            if !all_end(&group, limit) {
                if let Err(error) = &result {
                    report(error);
                }
                world.abort(ABORTED);
            }
            // Other groups go on.
            all_end(&world, None);
            Ok(result)
        }
        // The panic has been reported.
        Err(_) => world.abort(ABORTED),
    }
}

/// The group of this process: all processes, or those that have it in common with it when they are divided into groups of a
/// size.
fn group_of(
    world: &SimpleCommunicator,
    size: Option<NonZeroUsize>,
) -> Result<SimpleCommunicator, MpiError> {
    let (rank, processes) = (world.rank() as usize, world.size() as usize);
    let size = size.map_or(processes, NonZeroUsize::get);
    let refused = MpiError::NoGroups { processes, size };
    if !processes.is_multiple_of(size) {
        return Err(refused);
    }
    let group = Color::with_value((rank / size) as i32);
    world.split_by_color(group).ok_or(refused)
}

/// Waits until all processes of a group have come here; returns whether they did within a time, if there is a limit.
fn all_end(group: &SimpleCommunicator, limit: Option<Duration>) -> bool {
    let started = Instant::now();
    let mut barrier = group.immediate_barrier();
    loop {
        match barrier.test() {
            Ok(_) => return true,
            Err(pending) => barrier = pending,
        }
        if limit.is_some_and(|limit| started.elapsed() > limit) {
            // The computation is aborted: nothing completes the barrier.
            core::mem::forget(barrier);
            return false;
        }
        std::thread::sleep(INTERVAL);
    }
}

/// The operations of the ranks.
struct Service<'a> {
    universe: &'a mut Universe,
    group: &'a SimpleCommunicator,
    /// Size (bytes) of the buffer from which messages are sent.
    capacity: usize,
    /// Memory of messages that have been sent.
    spare: Vec<Vec<u8>>,
}

impl Service<'_> {
    /// Carries out operations until no more can come.
    fn serve(mut self, Requests { requests, replies }: Requests) {
        for request in requests {
            let reply = match request {
                Request::Start(messages) => {
                    self.reserve(messages.iter().map(|message| message.bytes.len()));
                    for message in messages {
                        let to = self.group.process_at_rank(message.rank as i32);
                        to.buffered_send_with_tag(&message.bytes[..], MESSAGE);
                        self.spare.push(message.bytes);
                    }
                    continue;
                }
                Request::Finish(from) => {
                    let received = from.into_iter().map(|rank| self.receive(rank));
                    Reply::Finish(received.collect())
                }
                Request::Sum(own) => {
                    let mut sums = own.clone();
                    let sum = SystemOperation::sum();
                    self.group.all_reduce_into(&own[..], &mut sums[..], sum);
                    Reply::Sum(sums)
                }
                Request::Least(own) => {
                    let mut least = own.clone();
                    let min = SystemOperation::min();
                    self.group.all_reduce_into(&own[..], &mut least[..], min);
                    Reply::Least(least)
                }
                Request::Gather(own) => Reply::Gather(self.gather(own)),
                Request::Broadcast(from, bytes) => Reply::Broadcast(self.broadcast(from, bytes)),
            };
            if replies.send(reply).is_err() {
                return;
            }
        }
    }

    /// Provides a buffer for messages of some lengths (bytes), and for those that may still be under way.
    fn reserve(&mut self, lengths: impl Iterator<Item = usize>) {
        let needed = EXCHANGES * lengths.map(|length| length + ENVELOPE).sum::<usize>();
        if needed > self.capacity {
            self.capacity = needed.max(1 << 20);
            self.universe.set_buffer_size(self.capacity);
        }
    }

    /// The next message of a rank.
    fn receive(&mut self, rank: usize) -> Vec<u8> {
        let from = self.group.process_at_rank(rank as i32);
        let status = from.probe_with_tag(MESSAGE);
        let length = status.count(u8::equivalent_datatype()) as usize;
        let mut bytes = self.spare.pop().unwrap_or_default();
        bytes.resize(length, 0);
        from.receive_into_with_tag(&mut bytes[..], MESSAGE);
        bytes
    }

    /// The bytes of all ranks in their order on rank 0, and nothing on the others.
    fn gather(&self, own: Vec<u8>) -> Vec<Vec<u8>> {
        let root = self.group.process_at_rank(0);
        if self.group.rank() != 0 {
            let length = own.len() as u64;
            root.send_with_tag(&length, GATHERED);
            for part in own.chunks(PART) {
                root.send_with_tag(part, GATHERED);
            }
            return Vec::new();
        }
        let mut all = vec![own];
        for rank in 1..self.group.size() {
            let from = self.group.process_at_rank(rank);
            let (length, _) = from.receive_with_tag::<u64>(GATHERED);
            let mut bytes = vec![0; length as usize];
            for part in bytes.chunks_mut(PART) {
                from.receive_into_with_tag(part, GATHERED);
            }
            all.push(bytes);
        }
        all
    }

    /// The bytes of a rank on all of them.
    fn broadcast(&self, from: usize, mut bytes: Vec<u8>) -> Vec<u8> {
        let root = self.group.process_at_rank(from as i32);
        let mut length = bytes.len() as u64;
        root.broadcast_into(&mut length);
        bytes.resize(length as usize, 0);
        for part in bytes.chunks_mut(PART) {
            root.broadcast_into(part);
        }
        bytes
    }
}
