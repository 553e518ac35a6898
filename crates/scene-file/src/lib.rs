//! Scenes in TOML files.
//!
//! A [`SceneFile`] has the tables of a text with the byte range of every value, a [`SceneSpec`] the scene or one of its
//! cases as typed values, and a [`FileScene`] the [`Scene`](powerhouse_scene::Scene) that is made of it together with what only
//! its file knows.
//!
//! # Why so
//! *Schemas belong to scene files.* The registry takes the names of the keys of a boundary from its schema, and its
//! functions ask for `JsonSchema`: this crate alone needs TOML, schemas and the drawing of faults.
//!
//! *A key is declared once.* The structures of parameters of laws, joints and boundaries are read from tables as they are,
//! with unit, range and default of a key on its field (feature `keys` of their crates, [`powerhouse_model::keys`]). Keys of
//! another form than the parameter have structures of their own: of faces across one axis, which have the defaults of all
//! faces, and of softening, which is given by one of two sets of keys.
//!
//! *Names are looked up.* Laws, kernels and boundaries come from a [`Registry`]; a user's own are registered
//! beside those that come with the software and named in scene files like them. A scene keeps the registry that
//! it was read with, so that checks and advice know the same names.
//!
//! *A file is parsed once.* Studies and programs change a [`SceneSpec`] before a scene is made of it. Scene files get new
//! keys, so that the types of [`spec`] are not exhaustive.
//!
//! *A fault has a position.* Every value of a scene file keeps the bytes that it was read from, so that a fault,
//! found by the parser, in the mesh or by another crate, is shown at its line and column before the run.

mod builtin;
mod builtin_joints;
mod builtin_laws;
mod checkpoint_plan;
mod drive;
mod engine;
mod file_scene;
mod inputs;
mod key_change;
pub mod keys;
mod overview;
mod plain;
mod registry;
mod render;
mod resolve;
mod spans;
pub mod spec;

pub use checkpoint_plan::{CheckpointInterval, CheckpointPlan, IntervalError};
pub use drive::{PointError, PointPath, PointTest};
pub use file_scene::{FileScene, SceneChoice};
pub use key_change::KeyChange;
pub use overview::{InputOverview, WaveOverview};
pub use registry::Registry;
pub use render::RenderFault;
pub use resolve::read_mesh;
/// The crate of JSON schemas whose types stand in public signatures, in the version in use.
pub use schemars;
pub use spec::{SceneFile, SceneSpec};
