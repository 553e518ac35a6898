//! Pairs of nodes across a joint.
//!
//! A joint is a list of node pairs, made by [`pair_nodes`] from the nodes of its two sides, and a
//! condition on their motion. The simplest condition is [`TiedPairs`]: both sides move as one.
//! Which tractions a joint admits is said by a [`ContactLaw`](powerhouse_model::ContactLaw), of
//! which [`Tied`] is the simplest.
//!
//! # Why so
//! *Predict and correct, no penalty.* The engine predicts velocities without the joint; the joint
//! adds the impulses that close it, computed with the effective inverse masses
//! `A^-1 = (M + dt/2 C + dt^2/4 K)^-1` of its nodes. Nothing has to be tuned, the stable step does
//! not fall (bonding only lowers frequencies), and the gap closes to round-off for any ratio of
//! masses. With the bare masses in place of `A` about half of the gap stays wherever a boundary's
//! dashpots act on a pair.
//!
//! *Groups.* Where several pairs share a node (three bodies along one line) one pass over the
//! pairs leaves gaps: each correction opens what the last one closed, and with a light node
//! between heavy ones even a hundred thousand sweeps do not end. Tied nodes therefore form groups
//! that take their common velocity at once.

mod error;
mod law;
mod pairing;
mod tied;

pub use error::ContactError;
pub use law::Tied;
pub use pairing::{Pairing, pair_nodes};
pub use tied::TiedPairs;
