//! What stands where the mesh ends.
//!
//! Waves that the structure scatters must leave the model, and the waves of the earthquake must
//! come in through the same faces. Both boundaries here put springs and dashpots on the faces'
//! nodes and bring the site's own motion in as nodal forces:
//!
//! `f = K u + C v + sum over faces of (area) sigma n`
//!
//! with displacement `u`, velocity `v` and stress `sigma` of the motion without the structure
//! (Wang, Chen & Xiao, 2019, Eq. 3). Where the model moves exactly like the free field, springs
//! and dashpots then carry nothing, whatever their coefficients: only the scattered part feels
//! them.
//!
//! ```
//! use powerhouse_boundary::{AxisParameters, Spreading, ViscousSpring};
//! let mut boundary = ViscousSpring::default();
//! assert_eq!(boundary.axes[2], AxisParameters::new(0.8, 1.1, None)?);
//! // A long cavern along y: its slice spreads cylindrically.
//! boundary.spreading = Spreading::Cylindrical;
//! # Ok::<(), powerhouse_model::ParameterError>(())
//! ```
//!
//! # Why so
//! *The full free field on every face* is the default. The paper puts only the incident wave on
//! the bottom (Eqs. 6-7), although the wave that the free surface reflects passes through the
//! bottom too and is not a scattered wave. On the paper's own example 1 (15 degrees, a pulse of
//! 0.8 s) the motion of the surface then errs by 0.10 (P) and 0.05 (SV) of its norm instead of
//! 0.0025 and 0.013, at the same cost, and by more for longer waves (the example `free_field`
//! prints these figures). [`InputMode::IncidentOnly`] keeps the paper's choice for comparison.
//!
//! *The distance r is that from the scatterer*, perpendicular to the face, not from the epicentre
//! as the paper has it: the spring represents the rock that the *scattered* wave still has to
//! spread through. Taken perpendicular, it is one number per face, and it stays right for curved
//! faces (it is the radius of a sphere around the scatterer). Where the structure runs through a
//! face there is no such distance; [`BoundaryError::Distance`] says so instead of making a spring
//! without bound.
//!
//! *Slices take half the springs*: a cylindrical wave decays with the root of the distance, a
//! spherical one with the distance, and the spring that balances the decay is half as stiff.
//!
//! *The boundary applies nothing itself.* Its dashpots stand in the velocity solve of their node,
//! so that they cost no time step; explicit dashpots would more than halve it.
//!
//! *Matrices only where needed.* On faces along the axes springs and dashpots are diagonal, and
//! the input loads use that; oblique faces take the full 3 x 3 products.

mod coefficients;
mod error;
mod input;
pub mod reflection;
mod viscous;
mod viscous_spring;

pub use coefficients::FaceCoefficients;
pub use error::BoundaryError;
pub use input::{InputMode, foreign_nodes};
pub use viscous::Viscous;
pub use viscous_spring::{AxisParameters, Spreading, ViscousSpring};
