//! Solid elements and rock bolts: kernels, blocks computed in lanes, and loads on faces.
//!
//! [`solid`] makes a factory of [element blocks](powerhouse_model::ElementBlock) from any
//! [kernel](powerhouse_model::ElementKernel), such as [`Hex8OnePoint`], and any
//! [law](powerhouse_model::ConstitutiveLaw). A block computes as many elements at once as the SIMD registers hold,
//! with the bits of one element at a time, in double, mixed or single precision. [`BoltSet`] embeds rock bolts in
//! solid elements; [`FacePressure`] and [`FaceTraction`] are consistent nodal loads of faces, [`FaceMass`] is the
//! added mass of water beside them.
//!
//! Engines see a [`BlockFactory`](powerhouse_model::BlockFactory) and its blocks, never this crate.

mod block;
mod bolts;
mod kernels;
mod lanes;
mod loads;

pub use block::{AnyLaw, Drainage, PoreWater, WaterPressure, solid};
pub use bolts::{BoltEnd, BoltLine, BoltParameters, BoltPattern, BoltSegment, BoltSet, Grout};
pub use kernels::{
    Hex8BBar, Hex8Eas, Hex8Full, Hex8Natural, Hex8OnePoint, Pyramid5, SolidKernel, Tet4, Tet10,
    Wedge6,
};
pub use loads::{FaceMass, FacePressure, FaceTraction, NodalForce, Profile, WaterMass};
