//! Nodal loads: face pressure, face traction, nodal force.

mod face;
mod nodal;

pub use face::{FacePressure, FaceTraction, Profile};
pub use nodal::NodalForce;
