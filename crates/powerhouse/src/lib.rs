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
//! A program begins with [`prelude`]. Methods that set a value of a [`Scene`], a [`Part`] or an [`OutputPlan`]
//! are called `with_x`, those that return it `x`; methods named by a singular noun add one item to a list.
//!
//! # Conventions
//! SI units, z up, tension positive. Incidence is measured from the vertical; azimuth is the
//! horizontal direction of travel, from +x towards +y. t = 0 of a record is its arrival at the
//! corner of the mesh's box that the wave hits first, unless a reference point is given.
//!
//! # Features
//! `scene-files` and `pictures` are on by default. Without them (`default-features = false`) a program composes scenes
//! in Rust, runs them, and writes tables, VTU files and summaries.
//!
//! | feature | what it adds |
//! |---|---|
//! | none | |
//! | `gmsh` | Gmsh meshes, [`io::read_gmsh`] |
//! | `inp` | meshes of Abaqus input files, [`io::read_inp`] |
//! | `packed` | packed meshes, [`io::read_packed_mesh`] |
//! | `records` | accelerograms, [`io::read_record`] |
//! | `pictures` | plots (SVG) and pictures (PNG) in a [`ResultFolder`] |
//! | `scene-files` | scenes from files, [`Registry`] with its JSON schema, [`keys`], single-point tests from files; with `gmsh`, `inp`, `packed` and `records` |
//! | `direct` | a direct solver for static equilibrium |
//! | `gpu` | steps on a graphics processor of NVIDIA, `engine = "gpu"` |
//! | `h5drm` | motions of stations in H5DRM files, [`io::read_station_motions`] |
//! | `programs` | programs of the elements in CUDA C and WGSL, [`Simulation::program_sources`]; the laws and kernels are compiled once more |
//! | `vtkhdf` | all snapshots of a run in one file, `io::VtkHdf` |
//!
//! A program that needs one part, such as a law or a boundary, depends on the crate of the part, which is smaller still.
//!
//! # Why so
//! *Schemas belong to scene files.* The registry takes the names of the keys of a boundary from its schema, and its
//! functions ask for `JsonSchema`: a feature that removed this bound would change what other crates compile with.
//! serde alone is always there, for `summary.json`.
//!
//! *One type.* A scene file is turned into the same [`Scene`] that programs compose: neither can do what the
//! other cannot.
//!
//! *Names are looked up.* Laws, kernels and boundaries come from a [`Registry`]; a user's own are registered
//! beside those that come with the software and named in scene files like them. A scene keeps the registry that
//! it was read with, so that checks and advice know the same names.
//!
//! *A file is parsed once.* A [`SceneFile`] has the tables of the text with the byte range of every value; a
//! [`SceneSpec`] has the scene or one of its cases as typed values, which studies and programs change before a [`Scene`] is
//! made of it. Scene files get new keys, so that the types of [`spec`] are not exhaustive.
//!
//! *The surroundings of a body are checked when a scene is prepared*, by sampling the incident field at the nodes
//! through which it enters: the body must start with the field's motion, the ground must be of one medium, free
//! surfaces must be without traction. So scenes from files and from programs, and fields of a user's own, are
//! checked alike.
//!
//! *Construction stages are checked when a scene is prepared and computed when it is run.* A check needs no
//! static solution: masses, stiffness and the stable step are those of the elements that are present in the
//! motion, wherever they have moved until then.
//!
//! *A fault has a position.* Every value of a scene file keeps the bytes that it was read from, so that a fault,
//! found by the parser, in the mesh or by another crate, is shown at its line and column before the run.

#![cfg_attr(
    not(feature = "scene-files"),
    allow(
        dead_code,
        unused_imports,
        reason = "usual ranges, hints and places of keys that files alone have"
    )
)]

mod acting;
#[cfg(feature = "scene-files")]
mod builtin;
#[cfg(feature = "scene-files")]
mod builtin_joints;
#[cfg(feature = "scene-files")]
mod builtin_laws;
mod checkpoint;
#[cfg(feature = "scene-files")]
mod drive;
pub mod engine;
mod error;
mod fault;
mod in_use;
mod joint;
#[cfg(feature = "scene-files")]
mod key_change;
#[cfg(feature = "scene-files")]
pub mod keys;
mod magnitude;
mod message;
mod output;
mod part;
pub mod prelude;
mod program_sources;
mod reduction;
#[cfg(feature = "scene-files")]
mod registry;
mod remark;
#[cfg(feature = "scene-files")]
mod resolve;
mod scene;
mod scene_remark;
mod simulation;
#[cfg(feature = "scene-files")]
pub mod spec;
mod stage;

pub use powerhouse_boundary as boundary;
pub use powerhouse_contact as contact;
pub use powerhouse_io as io;
pub use powerhouse_material_damage as material;
pub use powerhouse_model as model;
pub use powerhouse_mpi as mpi;
pub use powerhouse_program as program;
pub use powerhouse_wavefield as wavefield;

/// The crate of linear algebra whose types stand in public signatures, in the version in use.
pub use powerhouse_model::nalgebra;
/// The crate of JSON schemas whose types stand in public signatures, in the version in use.
#[cfg(feature = "scene-files")]
pub use schemars;

pub use checkpoint::{
    CheckpointError, CheckpointFiles, CheckpointInterval, CheckpointPlan, CheckpointWriter,
    IntervalError, KeptState, ResumedRun, RunInputs,
};
#[cfg(feature = "scene-files")]
pub use drive::{PointPath, PointTest};
pub use error::Error;
pub use fault::{Fault, Problem, SceneFault, SceneText};
pub use joint::{GroundStress, InitialGap, JointZone, Preload, SceneJoint};
#[cfg(feature = "scene-files")]
pub use key_change::{KeyChange, KeyChangeError};
pub use magnitude::{Magnitude, MagnitudeOf, ProbableUnit};
pub use message::{Message, RunNotes, Topic, merge_messages};
pub use output::summary;
pub use output::{
    BendingError, BoltForces, EnergyResidual, EnvelopeRequest, FolderError, FolderLock,
    HistoryRequest, JointRequest, NameError, OutputPlan, RelativeRequest, ResultFolder, Results,
    RingRequest, RunningTables, SampledRequest, SectionRequest, SectionUse, SnapshotRequest,
    StateRequest, StressRequest, file_name,
};
pub use part::{Kernel, Part};
pub use powerhouse_laws::{Damping, DampingCost, Material};
pub use program_sources::{ProgramSource, ProgramSources};
pub use reduction::reduction_layer;
#[cfg(feature = "scene-files")]
pub use registry::Registry;
pub use remark::{EquivalentLayer, Remark};
#[cfg(feature = "scene-files")]
pub use resolve::read_mesh;
#[cfg(feature = "scene-files")]
pub use scene::SceneChoice;
pub use scene::{
    Boundary, InitialMotion, InputOverview, LawMemory, LayerError, Mirror, MirrorError, Parity,
    RegionError, ResidualLimit, Scene, ThroughError, TimeStep, WaveOverview,
};
pub use scene_remark::SceneRemark;
pub use simulation::{ProgressHook, RunHooks, Simulation};
#[cfg(feature = "scene-files")]
pub use spec::{SceneFile, SceneSpec};
pub use stage::{
    BoltLayout, CompletedStage, EquilibratedBody, InSituError, InSituStress, SceneBolts,
    SceneStage, StageCheckpointSink, StageHook, StageOverview, StageSink, StageSolution,
    StagingError, WeightLayer,
};

/// Verification: accuracy and cost of modelling choices on problems with known solutions.
#[cfg(doc)]
#[doc = include_str!("../../../docs/verification.md")]
pub mod verification {}

/// Compilation test of the program in the project's README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
