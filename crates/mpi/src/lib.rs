//! Ranks that are the processes of an MPI computation: `mpirun -n 4 powerhouse run scene.toml`.
//!
//! Without the feature `mpi` the crate knows only whether a program was started as one of several processes
//! ([`processes`]); with it, `with_ranks` gives a program the [`Ranks`](powerhouse_model::Ranks) of its process. The feature
//! needs an MPI library (such as Open MPI or MPICH) with its compiler wrapper `mpicc`, and libclang.
//!
//! # Why so
//! *MPI has the thread that initialised it to itself*, and ranks reach it through channels: communicators cannot be moved
//! between threads, while a model computes on threads of its own. A message costs some microseconds more, and no unsafe
//! code is needed.
//!
//! *Messages are sent from a buffer of the library* (`MPI_Bsend`): a rank must never wait for the receiver of a message,
//! because one that has failed receives no more before all have agreed on the failure. The copy costs little beside the
//! transport.
//!
//! *A failure on which the ranks have not agreed ends all processes*: MPI cannot tell a process that waits that another one
//! has ended. After a failure of its own a process waits some seconds for the others, and then aborts the computation.

mod launch;
#[cfg(feature = "mpi")]
mod process;
#[cfg(feature = "mpi")]
mod ranks;

pub use launch::processes;
#[cfg(feature = "mpi")]
pub use process::{MpiError, with_groups, with_ranks};
#[cfg(feature = "mpi")]
pub use ranks::MpiRanks;
