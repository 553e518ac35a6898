//! Nodal loads: face pressure, face traction, nodal force.

mod face;
mod nodal;
mod quadrature;

pub use face::{FacePressure, FaceTraction, Profile};
pub use nodal::NodalForce;
