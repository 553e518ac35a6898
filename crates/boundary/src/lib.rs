//! Absorbing boundaries of a finite-element mesh, with input of the free field.
//!
//! Waves that the structure scatters must leave the model, and the waves of the earthquake must
//! come in through the same faces. Viscous and viscous-spring boundaries put springs and dashpots on
//! the faces' nodes and apply the free field, the motion of the site without the structure, as
//! equivalent nodal forces:
//!
//! `f = K u + C v + sum over faces of (area) sigma n`
//!
//! with displacement `u`, velocity `v` and stress `sigma` of the free field
//! (Wang, Chen & Xiao, 2019, Eq. 3). Where the model moves exactly like the free field, springs
//! and dashpots then carry no force, whatever their coefficients: they act on the scattered motion
//! alone.
//!
//! ```
//! use powerhouse_boundary::{AxisParameters, Spreading, ViscousSpring};
//! let mut boundary = ViscousSpring::default();
//! assert_eq!(boundary.axes[2], AxisParameters::new(0.8, 1.0, None)?);
//! // A long cavern along y: its slice spreads cylindrically.
//! boundary.spreading = Spreading::Cylindrical;
//! # Ok::<(), powerhouse_model::ParameterError>(())
//! ```
//!
//! # Accuracy and cost
//! Displacement amplitudes of the reflected P and SV waves per incident amplitude, at an angle of
//! incidence (degrees) from the face's normal; springs with A = 0.8 at `w r/cp` = 5, 2 and 1. Measured
//! in a strip that is periodic along the face, Poisson's ratio 0.25; the closed forms of
//! [`reflection`](mod@reflection) agree within 0.005. Reflection by dashpots does not depend on
//! frequency.
//!
//! | incident | dashpots | springs, B = 1.1: 5 | 2 | 1 | springs, B = 1: 5 | 2 | 1 |
//! |---|---|---|---|---|---|---|---|
//! | P 0 | 0.00 0.00 | 0.07 0.00 | 0.14 0.00 | 0.26 0.00 | 0.06 0.00 | 0.14 0.00 | 0.27 0.00 |
//! | P 15 | 0.01 0.01 | 0.07 0.02 | 0.13 0.05 | 0.24 0.11 | 0.05 0.02 | 0.13 0.06 | 0.25 0.11 |
//! | P 30 | 0.02 0.01 | 0.06 0.07 | 0.11 0.11 | 0.20 0.20 | 0.04 0.04 | 0.10 0.10 | 0.20 0.20 |
//! | P 45 | 0.01 0.07 | 0.02 0.13 | 0.06 0.17 | 0.12 0.26 | 0.03 0.09 | 0.07 0.14 | 0.12 0.25 |
//! | P 60 | 0.13 0.13 | 0.13 0.19 | 0.13 0.21 | 0.13 0.29 | 0.13 0.14 | 0.13 0.18 | 0.13 0.27 |
//! | P 75 | 0.41 0.13 | 0.42 0.16 | 0.42 0.18 | 0.41 0.22 | 0.41 0.14 | 0.41 0.16 | 0.41 0.21 |
//! | SV 0 | 0.00 0.00 | 0.00 0.06 | 0.00 0.09 | 0.00 0.16 | 0.00 0.03 | 0.00 0.08 | 0.00 0.16 |
//! | SV 15 | 0.00 0.05 | 0.03 0.09 | 0.06 0.10 | 0.11 0.13 | 0.02 0.06 | 0.06 0.07 | 0.11 0.12 |
//! | SV 30 | 0.13 0.13 | 0.18 0.13 | 0.21 0.13 | 0.28 0.12 | 0.14 0.13 | 0.18 0.13 | 0.27 0.13 |
//! | SV 45 | 0.42 0.17 | 0.45 0.15 | 0.45 0.10 | 0.46 0.12 | 0.42 0.13 | 0.42 0.07 | 0.44 0.09 |
//! | SV 60 | 0.41 0.34 | 0.41 0.33 | 0.40 0.30 | 0.38 0.29 | 0.40 0.31 | 0.39 0.26 | 0.37 0.25 |
//! | SV 75 | 0.28 0.60 | 0.27 0.60 | 0.27 0.57 | 0.25 0.56 | 0.27 0.57 | 0.27 0.54 | 0.25 0.53 |
//!
//! | | dashpots | springs, B = 1.1 | springs, B = 1 |
//! |---|---|---|---|
//! | cube of 12 m after an impulse: mean surface displacement after a million steps over the peak; double, mixed and single precision | 0.59 | below 1e-39 | below 1e-39 |
//! | its velocity in the last tenth of these steps over the peak: double and mixed; single | 2e-16; 4e-8 | below 1e-39 | below 1e-39 |
//! | static pressure in a spherical cavity: error of the wall's displacement with the boundary at 2, 3, 5 radii | 26, 7, 1.5 % | 10, 3, 0.6 % | the same |
//! | spherical P wave: share reflected at `w R/cp` = 5, 2, 1, 0.5 | 0.04 0.18 0.57 0.94 | 0.07 0.16 0.41 0.84 | 0.03 0.11 0.37 0.84 |
//! | stable step over that without a boundary | 1 | 1 | 1 |
//! | extra elements | none | none | none |
//! | time per node and step, without input, one thread | about 40 ns | the same | the same |
//!
//! B = 1.1 reflects 4.8 % of the amplitude at normal incidence, at any distance; springs with B = 1
//! reflect less from about `w r/cp` = 2 up and support the body statically as well. Neither absorbs
//! waves at grazing incidence: these need distance to the boundary. With springs of `4 G/r` (a
//! `distance` of `(lambda + 2 G) r/(4 G (1 + A))`) the static displacement of a spherical cavity is
//! exact; such springs reflect more of short waves (0.10 0.24 0.45 0.71).
//!
//! [`DomainReduction`] reflects what the boundary outside its layer reflects, and keeps the free field
//! out of everything beyond the layer: with the field of the mesh itself the motion there is 2e-15 of
//! the incident peak, with the wave in closed form 0.13, 0.032 and 0.011 of it in 8, 16 and 32 bricks to
//! 120 m (example `domain_reduction`). It is worth its cost where the mesh is deep and coarse:
//! transients around a cavity under a shear wave err by 2.9 % instead of 8.5 % on the same mesh (example
//! `cavity_scattering`). It costs the memory of its layer's matrices, and results beyond the layer lack
//! the field. Scenes name the region that it surrounds: `region = { set = "near" }` in their
//! `[boundary]`.
//!
//! The command `powerhouse advise boundary SCENE` names the boundary that a scene needs for a stated
//! error; the example `boundary_advice` runs three scenes with that boundary.
//!
//! The figures are measured by `cargo run --release --example boundary_price` and
//! `--example spherical_cavity`; `cargo bench --bench boundary` measures the cost of a field's input.
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
//! as in the paper: the spring represents the rock that the *scattered* wave still has to
//! spread through. Taken perpendicular, it is one number per face, and it stays right for curved
//! faces (it is the radius of a sphere around the scatterer). Where the structure runs through a
//! face there is no such distance, and [`BoundaryError::Distance`] is returned.
//!
//! *B = 1 is the default*, the impedance of plane waves. The paper advises 1.1
//! ([`ViscousSpring::paper`], `speed_ratio = "paper"` in scenes), which reflects 4.8 % of the amplitude at normal
//! incidence and, from about `w r/cp` = 10 up, half as much again of a P wave at 30 degrees. Nearer to
//! the structure the springs reflect most, and the two err alike.
//!
//! *Slices take half the spring stiffness*: a cylindrical wave decays with the root of the distance, a
//! spherical one with the distance, and the spring that balances the decay is half as stiff.
//!
//! *The boundary applies no force itself.* The integrator includes its dashpots in the velocity
//! update of their node, so that they do not reduce the stable step; explicit dashpots would more than
//! halve it.
//!
//! *A layer is given by its stiffness.* [`DomainReduction`] needs the exact nodal forces of the layer's
//! elements under a displacement; it takes the matrices of the engine's own element blocks and keeps
//! the part that couples the two sides of the layer. So it works with every element kernel without
//! depending on one.
//!
//! *Full matrices only where needed.* On faces along the axes springs and dashpots are diagonal, and
//! the input loads use that; oblique faces take the full 3 x 3 products.

mod coefficients;
mod domain_reduction;
mod error;
mod field_load;
mod input;
pub mod reflection;
mod viscous;
mod viscous_spring;

pub use coefficients::FaceCoefficients;
pub use domain_reduction::{DomainReduction, ReductionLayer};
pub use error::BoundaryError;
pub use input::{InputMode, nodes_in_other_media};
pub use viscous::Viscous;
pub use viscous_spring::{AxisParameters, Spreading, ViscousSpring};
