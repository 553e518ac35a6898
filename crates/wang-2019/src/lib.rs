//! The underground powerhouse of Wang, Chen & Xiao (2019, *Soil Dynamics and Earthquake Engineering* 119), section 4: the
//! mesh of its machine bay, and the comparison of a sweep with the paper.
//!
//! - [`bay`] generates the mesh of a machine bay, which scenes name through [`registry`]:
//!   `mesh = { generator = "bay", file = "bay.toml" }`.
//! - [`conclusions`](fn@conclusions) tests the five conclusions of the paper by the cases of a sweep, and [`Comparison`] is the
//!   section of a report that has them.
//!
//! The crate uses the public interfaces of `powerhouse` and `powerhouse-study` alone: another structure with a mesh
//! generator, a study and a report of its own is added in the same way.

pub mod bay;
mod conclusions;
mod error;
mod figures;
mod names;

pub use conclusions::{Conclusion, Verdict, conclusions};
pub use error::BayError;
pub use figures::Comparison;
pub use names::registry;
