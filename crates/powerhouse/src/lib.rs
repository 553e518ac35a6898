//! Powerhouse: explicit dynamic finite element analysis of underground structures under obliquely incident seismic
//! waves.
//!
//! This crate re-exports the crates of the workspace under short names and adds the [`Scene`], the complete input of an
//! analysis: mesh, parts, joints, ground motion, boundary, construction stages and output requests, read from a file
//! or composed in Rust.
//!
//! ```no_run
//! use powerhouse::{FileScene, RunHooks};
//! let scene = FileScene::from_file("data/scenes/cavern_small.toml")?;
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
//! *The facade composes crates and has nothing of its own.* Scenes are `powerhouse-scene`, their files
//! `powerhouse-scene-file`, results on disk `powerhouse-results`: a program that needs one of them alone depends on it.
//!
//! *One type.* A scene file is turned into the same [`Scene`] that programs compose: neither can do what the
//! other cannot. A [`FileScene`] has it together with what only the file knows.
//!
//! serde alone is always there, for `summary.json`.

pub mod engine;
pub mod prelude;
#[cfg(feature = "scene-files")]
mod run_inputs;

pub use powerhouse_boundary as boundary;
pub use powerhouse_contact as contact;
/// Reading and writing of files; with the feature `records` also of accelerograms.
pub mod io {
    pub use powerhouse_io::*;
    #[cfg(feature = "records")]
    pub use powerhouse_records::*;
}
pub use powerhouse_material_damage as material;
pub use powerhouse_model as model;
pub use powerhouse_mpi as mpi;
pub use powerhouse_program as program;
pub use powerhouse_wavefield as wavefield;

/// The crate of linear algebra whose types stand in public signatures, in the version in use.
pub use powerhouse_model::nalgebra;

pub use powerhouse_laws::{Damping, DampingCost, Material};
pub use powerhouse_results::*;
pub use powerhouse_scene::*;
#[cfg(feature = "scene-files")]
pub use powerhouse_scene_file::*;
#[cfg(feature = "scene-files")]
pub use run_inputs::run_inputs;

/// Verification: accuracy and cost of modelling choices on problems with known solutions.
#[cfg(doc)]
#[doc = include_str!("../../../docs/verification.md")]
pub mod verification {}

/// Compilation test of the program in the project's README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
