//! Nodal loads: face pressure, face traction, nodal force; added mass of water beside faces.

mod face;
mod mass;
mod nodal;
mod quadrature;

pub use face::{FacePressure, FaceTraction, Profile};
pub use mass::{FaceMass, WaterMass};
pub use nodal::NodalForce;
