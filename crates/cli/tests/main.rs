//! The command `powerhouse`, run as users run it.

mod advice;
mod block;
mod book;
mod command;
mod converge;
mod doors;
mod emit;
#[cfg(unix)]
mod faults;
mod fields;
mod folders;
mod kept;
mod killed;
mod manners;
mod record_study;
mod resume;
#[cfg(unix)]
mod streams;
mod studies;
mod sweep_processes;
mod trade;
