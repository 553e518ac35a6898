//! Nodal loads: face pressure, face traction, nodal force, weight.

mod face;
mod nodal;

pub use face::{FacePressure, FaceTraction, Profile};
pub use nodal::NodalForce;
pub(crate) use nodal::Weight;
