//! Materials of parts: the constitutive laws of the software, compiled for the lanes of all element kernels, and their damping.
//!
//! A law is a generic function, which is compiled for every number format and lane width: done here once, beside the other
//! crates, and not in the program that composes scenes or uses a law.

mod damping;
mod known;
mod material;

pub use damping::{Damping, DampingCost};
pub use material::Material;
