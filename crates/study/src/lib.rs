//! What is built on whole scenes: checks, predictions and the free-field self-check.
//!
//! [`check`] looks at a scene without running it: mesh quality, the frequencies that its elements
//! carry, the stable step and who limits it, and what a run will cost. [`FreeFieldCheck`] computes
//! the scene's box without the structure and compares it with the field that comes in: what is left
//! is the error of mesh, step and boundary, on which no result of the scene can improve.
//!
//! # Why so
//! *The self-check runs the scene's own parts.* The box takes its boundary, field and kernel from
//! the scene; only the mesh is its own, since that of a scene has a hole where the structure is.
//!
//! *It runs undamped.* The free field is elastic, so a damped box cannot reproduce it.

mod check;
mod cost;
mod error;
mod free_field;

pub use check::{CheckReport, Resolution, Warning, check};
pub use cost::Cost;
pub use error::StudyError;
pub use free_field::{FreeFieldCheck, FreeFieldReport, PointError};
