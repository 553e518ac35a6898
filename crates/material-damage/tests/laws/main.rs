//! The laws of the crate, one point at a time.

mod driver;
mod drucker_prager;
mod lanes;
mod mazars;
mod mohr_coulomb;
mod packs;
mod plastic_damage;
mod principal;
mod random;
