//! The laws of the crate, one point at a time.

mod drucker_prager;
mod lanes;
mod mohr_coulomb;
mod packs;
mod principal;
mod random;
