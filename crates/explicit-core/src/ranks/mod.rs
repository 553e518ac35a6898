//! Models whose blocks are divided among ranks, with the same bits for any number of them.
//!
//! # Why so
//! *Ranks exchange the forces of blocks (slots), not sums of forces.* Each rank that has a node adds all of its slots in
//! the global order of the blocks, as a model on one rank does, and computes the motion of the node to the same bits as
//! the others that have it: one message between two neighbours in a step, and no owner of a motion. Partial sums of ranks
//! would be a fifth shorter, and differ in the last bits for every number of ranks.
//!
//! *Messages travel while blocks are computed*: a rank computes the blocks that have shared nodes first, sends their forces, and
//! waits for those of others when all its blocks are done. One branch of a fork has both, the other has the blocks
//! inside, so that no thread waits between them.
//!
//! *What is computed together is present together.* A rank that has one node of a tie or of connected node pairs has all of
//! them, and computes them as every other such rank does.
//!
//! *Sums over the body are exact* ([`ExactSum`](crate::ExactSum)): added as integers, they depend neither on the number of
//! ranks nor on their order.

mod assembly;
mod communicator;
mod distribution;
mod engine;
mod exchange;
mod fault;
mod fingerprint;
mod forecast;
mod gathered;
mod layout;
mod model;
mod whole;

pub(crate) use assembly::{BlockAssembly, BuiltSolids, Ranked};
pub(crate) use communicator::{Communicator, rank_failure};
pub use distribution::Distribution;
pub use engine::ExplicitOnRanks;
pub(crate) use exchange::Exchange;
pub use exchange::Traffic;
pub(crate) use fault::Decision;
pub(crate) use fingerprint::fingerprint;
pub(crate) use gathered::{Gathered, Wanted};
pub(crate) use layout::ABSENT;
pub use model::RankModel;
pub(crate) use whole::{read, vector, write};
