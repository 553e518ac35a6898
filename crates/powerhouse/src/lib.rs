//! Powerhouse: explicit dynamic finite element analysis of underground structures under obliquely incident seismic
//! waves.
//!
//! This crate re-exports the crates of the workspace under short names and adds the [`Scene`], the complete input of an
//! analysis: mesh, parts, joints, ground motion, boundary, construction stages and output requests, read from a file
//! or composed in Rust.
//!
//! ```no_run
//! use powerhouse::{RunHooks, Scene};
//! let scene = Scene::from_file("data/scenes/cavern_small.toml")?;
//! let mesh = scene.mesh().clone();
//! let results = scene.prepare()?.run(RunHooks::default())?;
//! print!("{}", results.peaks(&mesh));
//! # Ok::<(), powerhouse::Error>(())
//! ```
//!
//! # Conventions
//! SI units, z up, tension positive. Incidence is measured from the vertical; azimuth is the
//! horizontal direction of travel, from +x towards +y. t = 0 of a record is its arrival at the
//! corner of the mesh's box that the wave hits first, unless a reference point is given.
//!
//! # Why so
//! *One type.* A scene file is converted into the same [`Scene`] that is composed in Rust, with the same capabilities.
//!
//! *Open registry.* Laws, kernels and boundaries are found by name in a [`Registry`]; user-defined ones are registered
//! beside the built-in ones and named in scene files like them.
//!
//! *Checks when the model is built.* The surroundings of a body are checked when a scene is prepared, by sampling the
//! free field at the boundary nodes: it must be negligible at the start of a body at rest, have the medium of the mesh,
//! and have no traction on free surfaces. So scenes from files and from Rust, and user-defined fields, have the same
//! checks.
//!
//! *Stages are checked when a scene is prepared, and computed when it is run.* A check needs no static solution: masses,
//! stiffness and stable step of the dynamic model are those of its active elements, whatever their displacement.
//!
//! *Faults with line and column.* Every value of a scene file keeps its byte range, so that every fault, whether found
//! by the parser, with the mesh or by another crate, is reported with its position, before the computation starts.

mod acting;
mod builtin;
mod builtin_joints;
mod builtin_laws;
mod damping;
mod doubt;
mod drive;
mod error;
mod fault;
pub mod format;
mod joint;
mod known;
mod magnitude;
mod output;
mod part;
mod reduction;
mod registry;
mod remark;
mod resolve;
mod scene;
mod scene_doubt;
mod simulation;
mod stage;

pub use powerhouse_boundary as boundary;
pub use powerhouse_contact as contact;
pub use powerhouse_explicit_core as engine;
pub use powerhouse_io as io;
pub use powerhouse_material_damage as material;
pub use powerhouse_model as model;
pub use powerhouse_wavefield as wavefield;

pub use damping::{Damping, DampingCost};
pub use doubt::{Doubt, RunNotes, Topic, together};
pub use drive::{PointPath, PointTest};
pub use error::Error;
pub use fault::{Fault, Problem, SceneFault, SceneText};
pub use joint::{GroundStress, InitialGap, JointZone, Preload, SceneJoint};
pub use magnitude::{Magnitude, MagnitudeOf, Meant};
pub use output::{
    BoltForces, EnergyResidual, EnvelopeRequest, FolderError, FolderLock, HistoryRequest,
    JointRequest, NameError, OutputPlan, RelativeRequest, ResultFolder, Results, SectionRequest,
    SnapshotRequest, StateRequest, StressRequest, file_name,
};
pub use part::{Kernel, Material, Part};
pub use reduction::reduction_layer;
pub use registry::Registry;
pub use remark::Remark;
pub use scene::{
    Boundary, InitialMotion, LawMemory, Mirror, MirrorError, Parity, RegionError, ResidualLimit,
    Scene, TimeStep,
};
pub use scene_doubt::SceneDoubt;
pub use simulation::{ProgressHook, RunHooks, Simulation};
pub use stage::{
    BoltPlace, CompletedStage, EquilibratedBody, InSituError, InSituStress, SceneBolts, SceneStage,
    StageOverview, StageSink, StagingError,
};

/// Verification: accuracy and cost of modelling choices on problems with known solutions.
#[cfg(doc)]
#[doc = include_str!("../../../docs/verification.md")]
pub mod verification {}

/// Compilation test of the program in the project's README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
