//! Exchange of the forces at nodes that several ranks share.

use core::iter::Peekable;
use core::ops::Range;

use powerhouse_model::{Message, Quad, RankError};

use super::communicator::Communicator;
use crate::nodes::Storage;

/// Messages and bytes of a rank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Traffic {
    /// Number of ranks with which it shares nodes.
    pub neighbours: usize,
    /// Number of nodes that it shares with other ranks.
    pub shared_nodes: usize,
    /// Number of exchanges so far: one per evaluation of forces, one per product with an operator, and one for the masses.
    pub exchanges: u64,
    /// Number of messages sent so far.
    pub messages: u64,
    /// Number of bytes sent so far.
    pub bytes: u64,
}

/// Another rank with shared nodes.
#[derive(Clone, Debug)]
pub(crate) struct Neighbour {
    pub(crate) rank: usize,
    /// Own slots that it receives, in the order in which it stores them, which is a rising one.
    pub(crate) outgoing: Vec<u32>,
    /// Slots that are received from it.
    pub(crate) incoming: Range<usize>,
}

impl Neighbour {
    /// Own slots that it receives, in rising order.
    fn slots(&self) -> Peekable<impl Iterator<Item = usize> + '_> {
        self.outgoing.iter().map(|&slot| slot as usize).peekable()
    }
}

/// First byte of a message: what follows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Forces.
    Forces = 0,
    /// Nothing: the sender has failed and sends no more forces.
    Ended = 1,
    /// Nothing: the last message after a failure.
    Last = 2,
}

/// The shared slots of a rank, with the buffers of their messages.
#[derive(Debug, Default)]
pub(crate) struct Exchange {
    neighbours: Vec<Neighbour>,
    messages: Vec<Message>,
    /// Number of slots with those of other ranks.
    pub(crate) slots: usize,
    /// Whether each block of this rank has shared nodes.
    border: Vec<bool>,
    pub(crate) traffic: Traffic,
    /// Whether the neighbours know that this rank has ended.
    ended: bool,
}

/// Whether each block has slots that some other rank receives, from the numbers of slots of the blocks.
fn border(neighbours: &[Neighbour], lengths: &[usize]) -> Vec<bool> {
    let mut border = vec![false; lengths.len()];
    for neighbour in neighbours {
        let mut slots = neighbour.slots();
        let mut end = 0;
        for (length, is_at_border) in lengths.iter().zip(&mut border) {
            end += length;
            while slots.next_if(|&slot| slot < end).is_some() {
                *is_at_border = true;
            }
        }
    }
    border
}

impl Exchange {
    /// The exchange of a rank with the numbers of slots of its blocks.
    pub(crate) fn new(
        neighbours: Vec<Neighbour>,
        shared_nodes: usize,
        slots: usize,
        lengths: &[usize],
    ) -> Self {
        Self {
            border: border(&neighbours, lengths),
            messages: neighbours.iter().map(|n| Message::new(n.rank)).collect(),
            traffic: Traffic {
                neighbours: neighbours.len(),
                shared_nodes,
                ..Traffic::default()
            },
            slots,
            neighbours,
            ended: false,
        }
    }

    /// Number of shared nodes, of messages in an exchange, and of the slots that they have together.
    pub(crate) fn planned(&self) -> (usize, usize, usize) {
        let slots = self.neighbours.iter().map(|n| n.outgoing.len());
        let Traffic {
            shared_nodes,
            neighbours,
            ..
        } = self.traffic;
        (shared_nodes, neighbours, slots.sum())
    }

    /// Own slots that some other rank receives.
    pub(crate) fn sent_slots(&self) -> impl Iterator<Item = u32> + '_ {
        self.neighbours
            .iter()
            .flat_map(|n| n.outgoing.iter().copied())
    }

    /// Whether a block of this rank has shared nodes.
    pub(crate) fn is_at_border(&self, block: usize) -> bool {
        self.border.get(block) == Some(&true)
    }

    /// Sends the own slots of shared nodes from parts of the force buffers, each with its first slot, in rising order; the
    /// blocks that have shared nodes are among them. The buffers of the messages received last are used again.
    pub(crate) fn send<S: Storage>(&mut self, team: &Communicator, parts: &[(usize, &[Quad<S>])]) {
        self.traffic.exchanges += 1;
        for (message, neighbour) in self.messages.iter_mut().zip(&self.neighbours) {
            let bytes = &mut message.bytes;
            bytes.clear();
            bytes.reserve(1 + neighbour.outgoing.len() * 3 * S::BYTES);
            bytes.push(Kind::Forces as u8);
            let mut slots = neighbour.slots();
            for (first, forces) in parts {
                while let Some(slot) = slots.next_if(|&slot| slot < first + forces.len()) {
                    let [x, y, z, _] = forces[slot - first].values;
                    S::write(&[x, y, z], bytes);
                }
            }
        }
        self.start(team);
    }

    /// Receives the slots of other ranks; returns whether all have sent them. If not, one has failed.
    pub(crate) fn receive<S: Storage>(
        &mut self,
        team: &Communicator,
        forces: &mut [Quad<S>],
    ) -> bool {
        let messages = &mut self.messages;
        if team.attempt(|ranks| ranks.finish(messages)).is_none() {
            return false;
        }
        let mut complete = true;
        for (message, neighbour) in self.messages.iter().zip(&self.neighbours) {
            if message.bytes.first() != Some(&(Kind::Forces as u8)) {
                complete = false;
                continue;
            }
            let slots = &mut forces[neighbour.incoming.clone()];
            let (found, expected) = (message.bytes.len(), 1 + slots.len() * 3 * S::BYTES);
            if found != expected {
                let rank = neighbour.rank;
                let wrong = RankError::Length {
                    rank,
                    found,
                    expected,
                };
                team.attempt(|_| Err::<(), _>(wrong));
                return false;
            }
            let vectors = message.bytes[1..].chunks_exact(3 * S::BYTES);
            for (slot, bytes) in slots.iter_mut().zip(vectors) {
                let [x, y, z] = S::read(bytes);
                *slot = Quad::new(x, y, z);
            }
        }
        complete
    }

    /// Sends and receives the slots of shared nodes.
    pub(crate) fn swap<S: Storage>(&mut self, team: &Communicator, forces: &mut [Quad<S>]) -> bool {
        if team.is_single() {
            return true;
        }
        self.send(team, &[(0, &*forces)]);
        self.receive(team, forces)
    }

    /// Sends to all neighbours, instead of forces, that this rank has ended; once.
    pub(crate) fn end(&mut self, team: &Communicator) {
        if !core::mem::replace(&mut self.ended, true) {
            self.send_all(team, Kind::Ended);
        }
    }

    /// Receives what is still under way after a failure that all ranks know of.
    pub(crate) fn drain(&mut self, team: &Communicator) {
        self.send_all(team, Kind::Last);
        for message in &mut self.messages {
            let one = core::slice::from_mut(message);
            while team.attempt(|ranks| ranks.finish(one)).is_some()
                && one[0].bytes != [Kind::Last as u8]
            {}
        }
        self.ended = false;
    }

    fn send_all(&mut self, team: &Communicator, kind: Kind) {
        for message in &mut self.messages {
            message.bytes.clear();
            message.bytes.push(kind as u8);
        }
        self.start(team);
    }

    fn start(&mut self, team: &Communicator) {
        self.traffic.messages += self.messages.len() as u64;
        let bytes = self.messages.iter().map(|message| message.bytes.len());
        self.traffic.bytes += bytes.sum::<usize>() as u64;
        let messages = &mut self.messages;
        team.attempt(|ranks| ranks.start(messages));
    }
}
