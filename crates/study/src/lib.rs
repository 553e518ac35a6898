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
//! *Its bricks are as long as the longest edge behind the absorbing faces.* A mesh is finer near its
//! structure; the mean of its elements would promise what its coarse end cannot keep.
//!
//! *It runs undamped.* The free field is elastic, so a damped box cannot reproduce it. Where the
//! ground of a scene is damped, the error with that damping is told beside.

mod check;
mod cost;
mod error;
mod free_field;
mod joints;
mod resolution;
mod sides;

pub use check::{CheckReport, Warning, check, warnings};
pub use cost::Cost;
pub use error::StudyError;
pub use free_field::{FreeFieldCheck, FreeFieldReport, PointError};
pub use joints::JointOverview;
pub use resolution::Resolution;
