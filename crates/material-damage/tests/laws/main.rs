//! The laws of the crate, one point at a time.

mod lanes;
mod mohr_coulomb;
mod packs;
mod principal;
mod random;
