//! What is built on whole scenes: checks, predictions, advice, the free-field self-check, sweeps, reports,
//! the mesh of a machine bay, and meshes of sites with known answers.
//!
//! [`check`] looks at a scene without running it: mesh quality, the frequencies that its elements
//! carry, the stable step and who limits it, what its stages and its run will cost, and which changes
//! would save most ([`saving`]). [`FreeFieldCheck`] computes
//! the scene's box without the structure and compares it with the field that comes in: what is left
//! is the error of mesh, step and boundary, on which no result of the scene can improve. [`mod@sweep`]
//! runs the cases of a scene, [`trade`] finds what accuracy costs it, [`write_report`] tells of them on one page, and [`bay`] makes the mesh of
//! a machine bay, which scenes name through [`registry`].
//!
//! [`advise_boundary`] names the absorbing boundary that a scene needs for a stated error;
//! [`probe_errors`] and [`grown`](fn@grown) measure what a scene's own boundary does to it.
//!
//! [`OpeningSlice`] and [`ShellOctant`] are meshes of ground around a round opening, for studies of
//! what an opening does to waves and of what a boundary does to their results.
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

pub mod advice;
pub mod bay;
mod check;
mod conclusions;
mod cost;
mod difference;
mod error;
mod excerpt;
mod free_field;
mod grown;
mod joints;
mod mark;
mod names;
mod opening_slice;
mod price;
mod recorded;
mod report;
mod resolution;
mod rounded;
pub mod saving;
mod sensitivity;
mod shell_octant;
mod sides;
mod static_cost;
pub mod sweep;
pub mod trade;

pub use advice::{BoundaryAdvice, BoxAdvice, advise_boundary, advise_box};
pub use check::{CheckReport, Warning, check, warnings};
pub use conclusions::{Conclusion, Verdict, conclusions};
pub use cost::{Cost, OutputSize};
pub use difference::{ProbeError, largest_error, probe_errors};
pub use error::StudyError;
pub use free_field::{FreeFieldCheck, FreeFieldReport, PointError};
pub use grown::grown;
pub use joints::JointOverview;
pub use names::registry;
pub use opening_slice::OpeningSlice;
pub use price::{Price, draw_prices, price_front};
pub use report::{read_outcomes, report_gaps, write_report};
pub use resolution::Resolution;
pub use sensitivity::{Variation, VariedFigure, sensitivity};
pub use shell_octant::ShellOctant;
pub use static_cost::StaticCost;
