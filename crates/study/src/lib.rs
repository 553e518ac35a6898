//! Studies of whole scenes: checks and cost predictions before a run, comparison of absorbing boundaries, the
//! free-field check, parameter sweeps, trade studies of cost against accuracy, and mesh generators.
//!
//! - [`check`] assesses a scene before its run: mesh quality, resolved frequencies, stable step and the element that
//!   limits it, predicted cost of stages and run, and the changes that save most ([`saving`]).
//! - [`FreeFieldCheck`] runs the scene's box without the structure and compares it with the incident field. The
//!   difference is the error of mesh, time step and boundary, a lower bound of the errors of the scene.
//! - [`SceneRun`] runs a scene into a folder, with all that is checked before.
//! - [`mod@sweep`] runs the cases of a scene; `powerhouse-report` writes their results to one HTML page. Of the cases of a set of
//!   records it makes statistics, and [`fragility`] curves.
//! - [`trade`] measures cost and error of a scene's numerical options and finds the Pareto front.
//! - [`convergence`] runs a scene on several meshes and extrapolates its results to vanishing element size.
//! - [`advise_boundary`] recommends an absorbing boundary for a permitted error, [`advise_box`] the extent of the
//!   mesh; [`probe_errors`] and [`grown`](fn@grown) measure the error of a given boundary.
//! - [`OpeningSlice`] and [`ShellOctant`] generate meshes of ground around a circular and a spherical opening.
//!
//! # Why so
//! *The free-field check runs the scene's own components.* The box takes boundary, field and kernel from the scene;
//! only the mesh is its own, since that of the scene has an opening where the structure is.
//!
//! *Its elements are as long as the longest edge behind the absorbing faces.* A mesh is finer near its structure; a
//! box with the mean element size would underestimate the error of the coarse elements.
//!
//! *It runs undamped.* The free field is elastic, so a damped box cannot reproduce it. Where the ground of a scene is
//! damped, the error with this damping is reported separately.

pub mod advice;
mod check;
mod check_text;
mod checkpoints;
pub mod convergence;
mod cost;
mod difference;
mod error;
mod even_samples;
mod excerpt;
mod extent;
pub mod fragility;
mod free_field;
mod grown;
mod joints;
mod json;
mod mark;
mod opening_slice;
mod perturbation;
mod price;
mod ranks;
mod recorded;
mod resolution;
mod rounded;
mod run_summary;
pub mod saving;
mod scene_run;
mod shell_octant;
mod sides;
pub mod starter;
mod static_cost;
mod store;
pub mod sweep;
pub mod text;
pub mod trade;
mod variant;

pub use advice::{BoundaryAdvice, BoxAdvice, advise_boundary, advise_box};
pub use check::{CheckReport, Warning, check, warnings};
pub use checkpoints::CheckpointEvent;
pub use cost::{Cost, OutputSize};
pub use difference::{ProbeError, largest_error, probe_errors};
pub use error::StudyError;
pub use extent::SetExtent;
pub use free_field::{FreeFieldCheck, FreeFieldReport, PointError};
pub use grown::grown;
pub use joints::JointOverview;
pub use opening_slice::OpeningSlice;
pub use price::{ParetoPoint, draw_pareto_front, pareto_front};
pub use scene_run::{RanScene, RunWatch, SceneRun};
pub use shell_octant::ShellOctant;
pub use static_cost::StaticCost;

/// Parts of studies that the crate of reports needs, and programs do not.
#[doc(hidden)]
pub mod internal {
    pub use crate::convergence::read_report;
    pub use crate::even_samples::{Accelerations, even_samples};
    pub use crate::json::read_json;
    pub use crate::rounded::rounded;
    pub use crate::run_summary::FoundSummary;
    pub use crate::store::MARK;
    pub use crate::sweep::{CASES, CaseEntry, OUTCOME, RECORD, STATISTICS, fractile, write_text};
    pub use crate::text::after_first_slip;
}
