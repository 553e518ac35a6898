//! The engine: element kernels, blocks of lanes, explicit integrators, stable step, energy ledger.

mod applied;
mod assembly;
mod block;
mod damping;
mod error;
mod gather;
mod groups;
mod integrator;
mod kernels;
mod lanes;
mod ledger;
mod loads;
mod model;
mod nodes;
mod numbering;
pub mod observe;
mod partition;
mod run;
mod spectrum;
mod stable_step;
mod support;
mod view;

pub use assembly::{BlockFactory, BlockOptions, BlockPart, LaneWidth, Precision, Rayleigh};
pub use block::{BlockError, solid};
pub use error::EngineError;
pub use integrator::{Leapfrog, OneSided};
pub use kernels::{Hex8BBar, Hex8Full, Hex8OnePoint, SolidKernel, Tet4, Wedge6};
pub use loads::{FacePressure, FaceTraction, NodalForce, Profile};
pub use model::{ElementChoice, Model, ModelBuilder};
pub use run::{Ended, EnergyCheck, Length, Progress, RunOptions, RunReport, StepChoice, run};
pub use stable_step::StableStep;
pub use support::{PeriodicPairs, Prescribed, Support};
