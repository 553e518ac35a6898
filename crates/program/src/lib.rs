//! Programs of laws and elements: recorded from their lanes, replayed, and written as CUDA C and WGSL.
//!
//! Kernels and laws are generic over the [lane](powerhouse_model::Lane). Evaluated once with the lane type [`Traced`], a
//! law leaves behind the list of its operations: a [`Program`](powerhouse_model::Program). So one source, a user's law
//! included, runs in SIMD lanes, in one lane, and on a graphics processor.
//!
//! [`record`] makes the program of any function of lanes, [`law_program`] that of a law; blocks of elements make theirs
//! ([`ProgrammedBlock::program`](powerhouse_model::ProgrammedBlock::program)). [`Replay`] executes a program and is the
//! reference of its translations, [`cuda`] and [`wgsl`].
//!
//! # Why so
//! *All operations are exact by IEEE 754* (sum, product, quotient, fused multiply-add, square root, comparison; exponentials
//! are made of them): a translation that neither contracts nor reorders them has the bits of the law. `nvcc` and NVRTC take
//! `--fmad=false` for it, other compilers `-ffp-contract=off`. WGSL permits rounding of its own and is compared within tolerances.
//!
//! *Numbers branch in three ways alone*: by selection, by [`Lane::any`](powerhouse_model::Lane::any), which may be answered
//! with true in every case since a lane does not depend on others, and by
//! [`Lane::repeat`](powerhouse_model::Lane::repeat). So a recording that runs once sees everything.

mod cuda;
mod law;
mod replay;
mod schedule;
mod traced;
mod translation;
mod wgsl;

pub use cuda::{cuda, cuda_head, cuda_number, cuda_statements};
pub use law::{check_law, component_names, law_program};
pub use replay::Replay;
pub use traced::{Names, Traced, TracedMask, record};
pub use wgsl::wgsl;
