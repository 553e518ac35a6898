//! What the shelves of tests share: bodies of elastic ground, waves through them, and how far a
//! run is from an exact field.
//!
//! The shelves:
//! * `analytic`: closed forms; the tolerance follows from the mesh.
//! * `convergence`: the slope of the error against the element size.
//! * `invariance`: what must not change the result: threads, lanes, the direction of the axes.
//! * `extremes`: the stable step and what must not lower it.
//! * `regression`: results that were stored once, with a log of why each moved.
//! * `architecture`: the shape of the workspace.
//!
//! Everything here uses the crates as a user would, through their public names. A test that fails
//! to set itself up panics with the reason.

mod ground;
mod misfit;
mod waves;

pub use ground::{Ground, elastic};
pub use misfit::{field_misfit, motion_at};
pub use waves::oblique_waves;
