//! The engine: element kernels, blocks of lanes, explicit integrators, stable step, energy ledger.

mod applied;
mod assembly;
mod damping;
mod error;
mod gather;
mod groups;
mod integrator;
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
pub use error::EngineError;
pub use integrator::{Leapfrog, OneSided};
pub use loads::{FacePressure, FaceTraction, NodalForce, Profile};
pub use model::{ElementChoice, Model, ModelBuilder};
pub use run::{Ended, Length, Progress, RunOptions, RunReport, StepChoice, run};
pub use stable_step::StableStep;
pub use support::{PeriodicPairs, Prescribed, Support};
