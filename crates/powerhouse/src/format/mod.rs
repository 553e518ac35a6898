//! The scene file: what a user writes.
//!
//! A scene is a TOML file. Every key is documented here, and the documentation flows into the JSON
//! schema ([`Registry::schema`](crate::Registry::schema)) that editors use. Numbers are in SI units; angles are in degrees. Paths of
//! meshes and records are relative to the scene file.
//!
//! Tables with a key `kind` are one of several shapes, such as a [`Load`] or a [`Pulse`]. Materials
//! and boundaries are open: their `law` and `kind` are looked up in a
//! [`Registry`](crate::Registry), so that types of one's own can be named in scenes.

mod at;
#[expect(
    dead_code,
    reason = "keys of tables that a case changes are applied to the parsed text; here they are for the schema"
)]
mod case;
mod change;
mod dashpot;
mod decode;
mod function;
mod ground;
mod joint;
mod load;
mod material;
mod output;
mod parameters;
mod quantity;
mod reference;
mod residual;
mod stage;
mod strict;
mod survey;
mod time;

use core::num::NonZeroUsize;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

pub use at::At;
pub use case::Case;
pub use dashpot::DashpotRatio;
pub use decode::{decode, decode_case};
pub(crate) use decode::{decode_materials, decode_tagged};
pub use function::{Function, Pulse};
pub use ground::{
    Baseline, BoundarySection, Component, Convention, Count, Ground, Length, Record, Region, Space,
    Units, Wave, WaveAxis, WaveKind,
};
pub use joint::{Gap, JointSection, Preload, Zone};
pub(crate) use load::{GRAVITY, WATER_DENSITY};
pub use load::{Load, Support};
pub use material::{Damping, Material, Part};
pub use output::{History, JointHistory, JointQuantity, Output, Quantity, Section};
pub use parameters::Parameters;
pub use quantity::{
    AmplitudeRatio, Azimuth, Finite, Incidence, NonNegative, PoissonRatio, Positive, Share,
};
pub use reference::Reference;
pub use residual::Residual;
pub use stage::{Bolt, BoltEnd, InSituStress, Stage, StageSupport, StaticMethod};
pub(crate) use survey::survey;
pub use time::{InitialMotion, Precision, Scheme, Step, Time};

/// A scene: a mesh, its materials, the ground motion and what is wanted of the run.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// What the scene is, in one line.
    pub title: String,
    /// Faults that are warnings in this scene: `["magnitudes"]` lets quantities pass that lie beyond what
    /// is usual of ground and structures. None by default.
    #[serde(default)]
    pub allow: Vec<At<Allowance>>,
    /// The mesh.
    pub mesh: MeshFile,
    /// Materials, by name.
    #[serde(rename = "material")]
    pub materials: Vec<Material>,
    /// Element sets and what they are made of; every element belongs to exactly one part.
    #[serde(rename = "part")]
    pub parts: Vec<Part>,
    /// Joints between parts.
    #[serde(rename = "joint", default)]
    pub joints: Vec<JointSection>,
    /// Ground motion records, by name.
    #[serde(rename = "record", default)]
    pub records: Vec<Record>,
    /// The ground without the structure, through which the waves come.
    #[serde(default)]
    pub ground: Ground,
    /// Incoming waves; they add up.
    #[serde(rename = "wave", default)]
    pub waves: Vec<Wave>,
    /// Where the mesh ends and the ground goes on.
    pub boundary: Option<BoundarySection>,
    /// Supports.
    #[serde(rename = "support", default)]
    pub supports: Vec<At<Support>>,
    /// Loads.
    #[serde(rename = "load", default)]
    pub loads: Vec<At<Load>>,
    /// The stress of the ground before the first stage; none by default.
    pub in_situ_stress: Option<At<InSituStress>>,
    /// Rock bolts; a stage installs them.
    #[serde(rename = "bolt", default)]
    pub bolts: Vec<Bolt>,
    /// Stages through which the body goes, one after the other, before it moves.
    #[serde(rename = "stage", default)]
    pub stages: Vec<Stage>,
    /// Duration and time step.
    pub time: Time,
    /// Number format of the computation.
    #[serde(default)]
    pub precision: Precision,
    /// The residual of the energy balance at which the run stops, over the largest energy held or
    /// put in until then: `"auto"` (1e-7 in double precision, 1e-4 in mixed, 1e-2 in single), a
    /// number, or `"off"`.
    #[serde(default)]
    pub energy_residual: Residual,
    /// Threads that compute, all by default. Results do not depend on them.
    pub threads: Option<At<NonZeroUsize>>,
    /// What is written.
    #[serde(default)]
    pub output: Output,
    /// The largest permitted error of the free field (relative L2 error of velocity). If given, a run first computes
    /// the scene's box without the structure and refuses to go on above this error.
    pub self_check: Option<At<Positive>>,
    /// Cases of a sweep: what each of them changes of the scene. A run of the scene itself passes them
    /// over.
    #[serde(rename = "case", default)]
    pub cases: Vec<Case>,
}

/// A fault that a scene may allow.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Allowance {
    /// Quantities beyond what is usual of ground and structures.
    Magnitudes,
}

/// The mesh file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// A Gmsh file (`.msh`, version 2.2 or 4.1, text or binary), relative to the scene file. Its
    /// physical groups are the named sets. With a generator: the file from which that makes the mesh.
    pub file: At<PathBuf>,
    /// What makes the mesh, by its name in the registry.
    pub generator: Option<At<String>>,
    /// Multiplies the coordinates, 0.001 for a mesh in millimetres.
    #[serde(default = "one")]
    pub scale: Positive,
    /// How often every element is cut at the middles of its edges, a solid into eight of its kind: 0 to 3
    /// times, after `within` and `slice`, of which the layer gets twice as many elements thick each time. The
    /// body stays as it is: round walls do not get rounder. Parts of an element have its number behind a digit
    /// of their own; a `nodal` load acts at all nodes of its set, of which there are more.
    pub refine: Option<At<u32>>,
    /// One layer of elements of a mesh that is the same all along an axis, in place of the whole: what
    /// holds the ends of the mesh holds the slice. With both on rollers it is in plane strain.
    pub slice: Option<At<Slice>>,
    /// Only the elements whose centroids lie between these coordinates, in place of the whole: the faces of
    /// the mesh stand where it then ends, so that less ground is computed. A wave without a `reference`
    /// reaches the structure sooner by the way that it is spared.
    pub within: Option<At<MeshBox>>,
}

/// Least and greatest coordinates (m), after `scale`; everything along an axis that is not named.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshBox {
    /// Along the first horizontal axis.
    pub x: Option<[Finite; 2]>,
    /// Along the second horizontal axis.
    pub y: Option<[Finite; 2]>,
    /// Upwards.
    pub z: Option<[Finite; 2]>,
}

/// A plane across an axis, which cuts the layer that is computed.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Slice {
    /// The axis along which the mesh is the same everywhere.
    pub across: SliceAxis,
    /// Where the plane is (m), after `scale`.
    pub at: Finite,
}

/// Axes of slices.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum SliceAxis {
    /// The first horizontal axis.
    X,
    /// The second horizontal axis.
    Y,
    /// Upwards.
    Z,
}

fn one() -> Positive {
    Positive::new(1.0).expect("one is positive")
}
