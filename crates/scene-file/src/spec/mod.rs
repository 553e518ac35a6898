//! Data structures of the scene file, key by key.
//!
//! A scene is a TOML file. Every key is documented here, and the documentation flows into the JSON
//! schema ([`Registry::schema`](crate::Registry::schema)) that editors use. Numbers are in SI units; angles are in degrees. Paths of
//! meshes and records are relative to the scene file.
//!
//! The key `kind` of a table selects one of several variants, such as those of a [`Load`] or a [`Pulse`].
//! Materials, joints and boundaries are open: their `law` and `kind` are looked up in a
//! [`Registry`](crate::Registry), so that scenes can name user-defined types.

mod added_mass;
mod at;
mod case;
mod change;
mod checkpoint;
mod dashpot;
mod decode;
mod fibres;
mod file;
mod former;
mod function;
mod ground;
mod joint;
mod layer;
mod load;
mod material;
mod motion;
mod node;
mod output;
mod parameters;
mod read;
mod record_set;
mod stage;
mod stations;
mod survey;
mod target;
mod time;

use core::num::NonZeroUsize;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use added_mass::AddedMass;
pub use at::At;
pub use case::Case;
pub(crate) use case::OfCase;
pub(crate) use change::NAMED;
pub use checkpoint::Checkpoint;
pub use dashpot::DashpotRatio;
pub(crate) use decode::{decode_materials, decode_tagged};
pub use fibres::{FibreSection, Fibres};
pub use file::SceneFile;
pub(crate) use file::{Registered, read_text};
pub use function::{Function, Pulse};
pub use ground::{
    Baseline, BoundarySection, Channels, Columns, Component, Convention, Count, Ground, Length,
    Record, Region, Space, Units, Wave, WaveAxis, Within,
};
pub use joint::{Gap, JointSection, Preload, Zone};
pub use layer::{EquivalentLinear, Layer, StrainCurves};
pub use load::{Load, Support};
pub(crate) use load::{WATER_BULK_MODULUS, water_density, water_weight};
pub use material::{Damping, Material, Part, PoreWater};
pub use motion::Motion;
pub use output::{
    AccelerationRule, History, JointHistory, JointQuantity, Output, OwnOutput, Quantity,
    Reinforcement, Ring, Section,
};
pub use parameters::Parameters;
pub use powerhouse_elements::BoltEnd;
pub use powerhouse_material_damage::ReferenceFrequency;
pub use powerhouse_model::keys::{
    AmplitudeRatio, Azimuth, Finite, Incidence, NonNegative, PoissonRatio, Positive, Share,
    StepFactor,
};
pub use powerhouse_model::{Axis, Precision};
pub use powerhouse_scene::{InitialMotion, ResidualLimit};
pub use powerhouse_wavefield::WaveKind;
pub use record_set::{FragilityCurve, RecordCase, RecordSet, SetComponents};
pub use stage::{
    Bolt, GroundWater, InSituStress, Stage, StageSupport, StageWater, StaticMethod, StressLayer,
};
pub use stations::{Interpolation, StationAxis, Stations};
pub use target::{Ground8, RecordSpectrum, Site, SpectrumMeans, Target};
pub use time::{Scheme, Step, Time};

/// A scene: mesh, materials, joints, ground motion, boundary, construction stages, time stepping and output of
/// one analysis.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct SceneSpec {
    /// Title of the scene, one line of 1 to 1000 characters.
    pub title: String,
    /// Faults that are reported as warnings in this scene: `["magnitudes"]` accepts quantities outside the
    /// usual range of ground and structures. None by default.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub allow: Vec<At<Allowance>>,
    /// Mesh file and its treatment.
    pub mesh: MeshFile,
    /// Materials: constitutive laws with their parameters, each with a name.
    #[serde(rename = "material")]
    pub materials: Vec<Material>,
    /// Parts: element sets with material, element kernel and damping. Every element belongs to exactly one
    /// part.
    #[serde(rename = "part")]
    pub parts: Vec<Part>,
    /// Joints: pairs of surfaces with a contact law between them.
    #[serde(rename = "joint", default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<JointSection>,
    /// Ground motion records (accelerograms), each with a name.
    #[serde(rename = "record", default, skip_serializing_if = "Vec::is_empty")]
    pub records: Vec<Record>,
    /// Set of records, for each of which the scene gets cases; its first record is among the records of the scene.
    #[serde(rename = "record_set", default, skip_serializing)]
    pub record_sets: Vec<RecordSet>,
    /// Free-field site: the ground without the structure, in which the incident waves travel.
    #[serde(default, skip_serializing_if = "is_default")]
    pub ground: Ground,
    /// Horizontal layers of that site from the uppermost down, the last one the half-space; by default one medium,
    /// that of the elements along the absorbing faces.
    #[serde(rename = "layer", default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<Layer>,
    /// Incident plane waves; their motions are superposed.
    #[serde(rename = "wave", default, skip_serializing_if = "Vec::is_empty")]
    pub waves: Vec<Wave>,
    /// Recorded motions of three components, each split into incident waves, whose motions are superposed too.
    #[serde(rename = "motion", default, skip_serializing_if = "Vec::is_empty")]
    pub motions: Vec<Motion>,
    /// Absorbing boundary on the outer faces of the mesh; none by default.
    pub boundary: Option<BoundarySection>,
    /// Supports: fixed, roller, symmetric, periodic or prescribed displacements of node sets, in all stages and
    /// in the run.
    #[serde(rename = "support", default, skip_serializing_if = "Vec::is_empty")]
    pub supports: Vec<At<Support>>,
    /// Loads: gravity, pressures, water pressures, tractions and nodal forces, in force from the first stage on and in
    /// the run, unless `removed_in` names the stage that removes them.
    #[serde(rename = "load", default, skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<At<Load>>,
    /// Added masses of water beside facet sets, in the run alone; none by default.
    #[serde(rename = "added_mass", default, skip_serializing_if = "Vec::is_empty")]
    pub added_masses: Vec<At<AddedMass>>,
    /// In-situ stress of the ground before the first construction stage; zero by default.
    pub in_situ_stress: Option<At<InSituStress>>,
    /// Rock bolts; a construction stage installs them.
    #[serde(rename = "bolt", default, skip_serializing_if = "Vec::is_empty")]
    pub bolts: Vec<Bolt>,
    /// Construction stages, in order, each ending in static equilibrium, before the dynamic run.
    #[serde(rename = "stage", default, skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<Stage>,
    /// Duration, start, time step and integration scheme of the dynamic run.
    pub time: Time,
    /// Floating-point precision of the computation; double by default.
    #[serde(default, skip_serializing_if = "is_default")]
    pub precision: Precision,
    /// Engine of the dynamic run: `"cpu"`, the processor of the machine (the default), or `"gpu"`, a graphics processor of
    /// NVIDIA beside it, with the same bits. A program must have been compiled with the feature `gpu` for it. Joints, bolts, laws that
    /// are evaluated point by point, the balance of energies and the profile of steps are not computed there.
    pub engine: Option<At<EngineName>>,
    /// Tolerance of the energy balance: the run stops when the residual exceeds this share of the largest
    /// energy stored or put in until then. `"auto"` (1e-7 in double precision, 1e-4 in mixed, 1e-2 in
    /// single; the default), a number above 0 and at most 1, or `"off"`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub energy_residual: ResidualLimit,
    /// Number of computing threads; all of the machine by default. Results do not depend on it.
    pub threads: Option<At<NonZeroUsize>>,
    /// Checkpoints of the run, from which it can be resumed, and states that are kept after it.
    #[serde(default, skip_serializing_if = "is_default")]
    pub checkpoint: Checkpoint,
    /// Output requests: histories, section forces, envelopes, snapshots and their intervals.
    #[serde(default, skip_serializing_if = "is_default")]
    pub output: Output,
    /// Tolerance of the free-field check: largest permitted relative L2 error of velocity, computed against incident
    /// field, at the middle of the top and at the scatterer. Before the scene, `powerhouse run` and sweeps run a box of
    /// the mesh's extent, without structure and damping, and stop above this error. No check by default.
    pub self_check: Option<At<Positive>>,
    /// Cases of a sweep: variants of the scene, each with the keys that it changes. A run of the scene itself
    /// ignores them.
    #[serde(rename = "case", default, skip_serializing)]
    pub cases: Vec<Case>,
    /// The file that the scene was read from.
    #[serde(skip)]
    file: SceneFile,
    /// The case that the scene is, if any.
    #[serde(skip)]
    pub(crate) of_case: Option<OfCase>,
}

impl SceneSpec {
    /// The file that the scene was read from.
    pub fn file(&self) -> &SceneFile {
        &self.file
    }
    /// Name of the case that the scene is, if any.
    pub fn case(&self) -> Option<&str> {
        self.of_case.as_ref().map(|case| case.name.as_str())
    }
    /// Makes the scene a case of a name: its results have a folder of that name in that of the scene. `varies` is a short
    /// description of the one parameter in which it differs from the case that reports compare it with.
    pub fn set_case(&mut self, name: impl Into<String>, varies: Option<String>) {
        let continuous = self.of_case.as_ref().is_some_and(|case| case.continuous);
        self.of_case = Some(OfCase {
            name: name.into(),
            varies,
            continuous,
        });
    }
    /// The keys of the scene and their values, without cases; of keys that were not given those that have a default value.
    ///
    /// # Errors
    /// A number that TOML cannot represent.
    pub fn to_table(&self) -> Result<toml::Table, toml::ser::Error> {
        let mut table = toml::Table::try_from(self)?;
        decode::untag_tables(&mut table);
        Ok(table)
    }
    /// Whether a free field moves the ground: waves, recorded motions or those at stations.
    pub fn has_field(&self) -> bool {
        let stations = self.boundary.as_ref().and_then(|b| b.stations.as_ref());
        !self.waves.is_empty() || !self.motions.is_empty() || stations.is_some()
    }
}

/// Engine of the dynamic run.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum EngineName {
    /// The processor of the machine.
    Cpu,
    /// A graphics processor of NVIDIA beside it.
    Gpu,
}

/// Kind of fault that a scene may downgrade to a warning.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum Allowance {
    /// Quantities outside the usual range of ground and structures.
    Magnitudes,
}

/// Mesh file, and the operations applied to the mesh after it is read.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// Path of a Gmsh file (`.msh`, version 2.2 or 4.1, text or binary), whose physical groups are the named sets, or of an
    /// Abaqus input file (`.inp`), whose node sets, element sets and surfaces are; relative to the scene file. With
    /// `generator`: path of the generator's input file.
    pub file: At<PathBuf>,
    /// Name of a mesh generator of the registry, which builds the mesh from `file`; none by default.
    pub generator: Option<At<String>>,
    /// Factor on the coordinates, above 0, 1 by default; 0.001 for a mesh in millimetres.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub scale: Positive,
    /// Order of the elements: 1 takes the corners alone of all elements of second order in the file, such as `hex20` and
    /// `wedge15`, or `tet10`; 2 gives tetrahedra of four nodes a node at the midpoint of every edge, after all other
    /// operations. By default the file decides: tetrahedra of ten nodes are computed as they are, and other elements of second
    /// order are refused.
    pub order: Option<At<u32>>,
    /// Whether nodes on curved edges of tetrahedra of ten nodes are moved to the midpoints; false by default: a curved edge
    /// is an error.
    pub straighten: Option<At<bool>>,
    /// Number of uniform refinements, 0 to 3, 0 by default. Each halves all edges: a solid becomes eight of its
    /// kind. Applied after `within` and `slice`; the layer of a slice doubles its number of elements across
    /// the thickness each time. The geometry stays that of the mesh: curved walls keep their chords. A child
    /// element has the number of its parent with one digit in front. A `nodal` load acts at all nodes of its
    /// set, of which refinement makes more.
    pub refine: Option<At<u32>>,
    /// Slice: one layer of elements of a mesh that is uniform along an axis, computed in place of the whole
    /// mesh. Supports of the two ends of the mesh act on the two sides of the slice; rollers on both give plane
    /// strain.
    pub slice: Option<At<Slice>>,
    /// Coordinate range of the part of the mesh that is computed: elements whose centroids lie in it. The
    /// outer faces of the mesh move to the new ends. A wave without a `reference` reaches the structure
    /// earlier by the travel time that is cut off.
    pub within: Option<At<MeshBox>>,
}

/// Coordinate range: lowest and highest coordinate (m) per axis, after `scale`; unlimited along an axis that is
/// not given.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct MeshBox {
    /// Lowest and highest x (m), first horizontal axis.
    pub x: Option<[Finite; 2]>,
    /// Lowest and highest y (m), second horizontal axis.
    pub y: Option<[Finite; 2]>,
    /// Lowest and highest z (m), vertical axis, upwards.
    pub z: Option<[Finite; 2]>,
}

/// Plane normal to an axis; the layer of elements that it cuts is computed.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Slice {
    /// Normal of the plane: the axis along which the mesh is uniform.
    pub across: Axis,
    /// Coordinate of the plane along the axis (m), after `scale`.
    pub at: Finite,
}

fn is_one(number: &Positive) -> bool {
    number.get() == 1.0
}

/// Whether a value is the default of its type, which is not written.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn one() -> Positive {
    Positive::new(1.0).expect("one is positive")
}
