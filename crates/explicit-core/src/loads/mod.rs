//! Loads that need nothing but a mesh.

mod face;
mod nodal;

pub use face::{FacePressure, FaceTraction, Profile};
pub use nodal::NodalForce;
pub(crate) use nodal::Weight;
