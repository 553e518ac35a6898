//! Errors of scenes, their files and their results: one type, so that a program has one.

mod checkpoint;
mod folder;
mod key_change;

pub use checkpoint::CheckpointError;
pub use folder::FolderError;
pub use key_change::KeyChangeError;

use std::path::PathBuf;

use powerhouse_contact::ContactError;
use powerhouse_model::{
    MeshError, ModelError, ParameterError, RunError, StageError, StateError, StaticError,
};
use thiserror::Error;

use crate::{
    DelayedError, LayerError, Magnitude, MagnitudeOf, MirrorError, NameError, Problem, RegionError,
    Results, SceneFault, StagingError, ThroughError, WaterError,
};

/// Error in reading, composing, running or writing a scene.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// Fault of a scene file, with line and column.
    #[error(transparent)]
    Scene(Box<SceneFault>),
    /// Name of a case that the scene file does not have, requested of
    /// `FileScene::case_from_file_with`.
    #[error("the scene has no case '{name}'; its cases are: {}", available.join(", "))]
    NoSuchCase {
        /// Requested name.
        name: String,
        /// Names of the scene's cases.
        available: Vec<String>,
    },
    /// Change of a key of a scene file that cannot be made, of `FileScene::from_file_as`.
    #[error(transparent)]
    KeyChange(#[from] KeyChangeError),
    /// Input file that cannot be read: scene, loading path, material, or equilibrated body.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// Mesh file that was changed while a run shared its numbers.
    #[error(transparent)]
    MeshInUse(Box<dyn std::error::Error + Send + Sync>),
    /// Result file or equilibrated body that cannot be written.
    #[error(transparent)]
    Write(#[from] powerhouse_io::IoError),
    /// Results folder that cannot hold the files of a run, or lost them.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// Fibres that would lower a frequency of the input by more than permitted.
    #[error(
        "fibres for a step {factor} times as long lower frequencies of the input by an estimated {:.2} %, more than the {:.2} % of `fibre_shift`: take a smaller factor, or permit more",
        100.0 * shift, 100.0 * limit
    )]
    FibreShift {
        /// Requested factor on the step (1).
        factor: f64,
        /// Estimated relative decrease (1).
        shift: f64,
        /// Largest permitted one (1).
        limit: f64,
    },
    /// Solid element that belongs to no part, or element that belongs to several. Bars without a part are left out of the
    /// model and no error.
    #[error(
        "element {element} belongs to {count} parts, but must belong to exactly one; {}",
        crate::fault::owners(*count, sets)
    )]
    PartCount {
        /// Number of the first such element in the mesh file.
        element: u64,
        /// Number of parts to which it belongs: 0, or 2 for several.
        count: usize,
        /// Element sets of these parts; of an element without a part, all element sets that contain it.
        sets: Vec<String>,
    },
    /// Element of a kind for which neither its part nor the software has a kernel, or element of the layer around a
    /// region (domain reduction) of another kind than the others.
    #[error("element {element} of part '{set}' is a {kind}, for which there is no kernel")]
    NoKernel {
        /// Number of the element in the mesh file.
        element: u64,
        /// Element set of the part.
        set: String,
        /// Kind of the element.
        kind: &'static str,
    },
    /// Free field whose displacement or velocity at the start of a body at rest is 2e-4 of its peak or more.
    #[error(
        "the body starts at rest at t = {time} s, but the field '{field}' is at {level:.1e} of its peak then"
    )]
    NotAtRest {
        /// Name of the field.
        field: String,
        /// Displacement or velocity of the field at the start over its peak, the larger one (1).
        level: f64,
        /// Start time (s).
        time: f64,
    },
    /// Elastic medium of the elements at an absorbing face that differs from that of the free field.
    #[error(
        "the medium at node {node} of the absorbing faces differs from that of the field '{field}' ({count} such nodes)"
    )]
    ForeignMedium {
        /// Name of the field.
        field: String,
        /// Number of the first such node in the mesh file.
        node: u64,
        /// Number of such nodes.
        count: usize,
    },
    /// Body that does not fit the layers of its free field.
    #[error(transparent)]
    Layers(#[from] LayerError),
    /// Part that cannot run through absorbing faces.
    #[error(transparent)]
    Through(#[from] ThroughError),
    /// Water beside the body that cannot have an added mass, found by [`Scene::prepare`](crate::Scene::prepare).
    #[error(transparent)]
    Water(#[from] WaterError),
    /// Free field without effect on the model: a scene that starts at rest has no absorbing boundary, or its boundary has
    /// no input.
    #[error("the field '{field}' has no effect: {reason}")]
    UnusedField {
        /// Name of the field.
        field: String,
        /// Reason in words.
        reason: &'static str,
    },
    /// Quantity outside its usual range, found by [`Scene::prepare`](crate::Scene::prepare) in a scene that does not
    /// [allow](crate::Scene::allow_magnitudes) such quantities; in a scene file it is a [`Problem::Magnitude`].
    #[error("{magnitude}")]
    Magnitude {
        /// Quantity, value and range.
        magnitude: Box<Magnitude>,
        /// Object to which it belongs.
        of: MagnitudeOf,
    },
    /// Name that cannot be that of a result file.
    #[error(transparent)]
    Name(#[from] NameError),
    /// Facet that belongs to two absorbing faces, or to one that is listed twice.
    #[error(
        "the absorbing faces '{first}' and '{second}' both contain a facet of element {element}"
    )]
    SharedFacet {
        /// Facet set of the first face.
        first: String,
        /// Facet set of the second face.
        second: String,
        /// Number of the element in the mesh file.
        element: u64,
    },
    /// Absorbing facet inside the body: a side between two elements.
    #[error("the absorbing face '{face}' has a facet inside the body at element {element}")]
    InnerFacet {
        /// Facet set of the face.
        face: String,
        /// Number of the element in the mesh file.
        element: u64,
    },
    /// Region of a domain reduction that is invalid, found by [`Scene::prepare`](crate::Scene::prepare).
    #[error(transparent)]
    Region(#[from] RegionError),
    /// Symmetry plane that is invalid, or about which the model or its waves are not symmetric, found by
    /// [`Scene::prepare`](crate::Scene::prepare).
    #[error(transparent)]
    Mirror(#[from] MirrorError),
    /// Slice with delayed sides that is invalid, or that has something that such slices do not take, found by
    /// [`Scene::prepare`](crate::Scene::prepare).
    #[error(transparent)]
    Delayed(#[from] DelayedError),
    /// Kernel given for a part that has no element of the kernel's kind.
    #[error("the kernel '{kernel}' is not for any element of part '{set}'")]
    UnusedKernel {
        /// Element set of the part.
        set: String,
        /// Name of the kernel.
        kernel: String,
    },
    /// Flat damping of a law without an elastic part, with which it could be in series.
    #[error(
        "part '{set}': flat damping is not available for the law '{law}', which does not define its elastic part"
    )]
    NotInSeries {
        /// Element set of the part.
        set: String,
        /// Name of the law.
        law: String,
    },
    /// Rim without elements: no element of the part is near enough to an absorbing face.
    #[error(
        "part '{set}' has a rim, but no element of it touches an absorbing face or is within {width} m of one"
    )]
    EmptyRim {
        /// Element set of the part.
        set: String,
        /// Width of the rim (m).
        width: f64,
    },
    /// Node pair of a joint with an invalid preload, gap or bond, or geometry.
    #[error("joint '{joint}', nodes {first} and {second}: {source}")]
    Joint {
        /// Name of the joint.
        joint: String,
        /// Number of the first node of the pair in the mesh file.
        first: u64,
        /// Number of the second node of the pair in the mesh file.
        second: u64,
        /// Cause.
        source: ContactError,
    },
    /// Joint of an output request ([`JointRequest`](crate::JointRequest)) that the scene does not have.
    #[error("there is no joint '{name}'")]
    NoSuchJoint {
        /// Requested name.
        name: String,
    },
    /// Zone of a joint that contains no node pair.
    #[error(
        "joint '{joint}' has no node pair in {zone}{}",
        distance.map_or(String::new(), |d| format!(": the nearest is {d:.4e} m away"))
    )]
    EmptyZone {
        /// Name of the joint.
        joint: String,
        /// Description of the zone.
        zone: String,
        /// Distance of the nearest pair from the zone's point (m), if the zone is given by one.
        distance: Option<f64>,
    },
    /// Invalid construction stages, bolts or in-situ stress.
    #[error(
        "{}{source}",
        stage.as_ref().map_or(String::new(), |stage| format!("stage '{stage}': "))
    )]
    Staging {
        /// Name of the stage, if the error concerns one.
        stage: Option<String>,
        /// Cause.
        source: StagingError,
    },
    /// Construction stage in which static equilibrium was not reached.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// Failed transfer of the body from its stages to the dynamic run, before the first time step: the dynamic model has
    /// other internal forces than that of the last stage, or a law would relax the static stress.
    #[error("transfer from the stages to the dynamic run: {source}")]
    HandOver {
        /// Cause.
        source: StaticError,
    },
    /// Equilibrated body that belongs to another scene: it has another number of nodes, or other elements are inactive.
    /// Bodies with equal numbers and other elements inactive are refused too.
    #[error(
        "the equilibrated body has {found} nodes and {found_absent} inactive elements, but the scene has {expected} and {expected_absent}"
    )]
    ForeignBody {
        /// Number of nodes of the body.
        found: usize,
        /// Number of inactive elements of the body.
        found_absent: usize,
        /// Number of nodes of the scene's mesh.
        expected: usize,
        /// Number of inactive elements after the scene's stages.
        expected_absent: usize,
    },
    /// File without a complete equilibrated body, or with one of another version.
    #[error("{} does not contain a complete equilibrated body that this version can read", path.display())]
    UnreadableBody {
        /// Path of the file.
        path: PathBuf,
    },
    /// State that cannot be written to a file.
    #[error("{}: the state of the {part}: {source}", path.display())]
    SavedState {
        /// Path of the file.
        path: PathBuf,
        /// The part whose state it is.
        part: String,
        /// Cause.
        source: StateError,
    },
    /// Checkpoint that cannot be read or belongs to another run.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Stages of a run to be resumed that are not the first ones of the scene.
    #[error("the stages of the checkpoint are {found:?}; those of the scene are {expected:?}")]
    ForeignStages {
        /// Names of the stages of the checkpoint.
        found: Vec<String>,
        /// Names of the stages of the scene.
        expected: Vec<String>,
    },
    /// Run that was cancelled before or during a construction stage; it has no results. A run that is cancelled later
    /// ends without an error.
    #[error("interrupted in stage '{stage}'")]
    Interrupted {
        /// Name of the stage that was not completed.
        stage: String,
    },
    /// Initial motion of the free field in a scene without free field.
    #[error("the run cannot start from the motion of the free field: the scene has no field")]
    NoField,
    /// Parameter of a scene or of one of its components outside its permitted range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Invalid mesh, or name of a set that does not exist.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Component of the model, such as a boundary, field or element block, that refused its input when it was built.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Run that was refused before its first step, such as for an unstable time step or an option out of range; also a
    /// failure while steps are [timed](crate::Simulation::time_steps).
    #[error(transparent)]
    Run(#[from] RunError),
    /// Dynamic run that failed after it had started: divergence, failed element, joint, observer or sink, or an energy
    /// residual above its limit.
    #[error("{error}")]
    Failed {
        /// Cause.
        error: RunError,
        /// Results up to the failure, recorded at the samples until then; stages included.
        results: Box<Results>,
    },
}

impl Error {
    /// The stage in which static equilibrium did not converge, and the reason, if the error is of this kind.
    pub fn equilibrium_failure(&self) -> Option<(&str, &StaticError)> {
        match self {
            Self::Stage(StageError::NotEquilibrated { stage, source }) => Some((stage, source)),
            Self::Scene(fault) => match fault.problem() {
                Problem::Refused(source) => source.downcast_ref::<Self>()?.equilibrium_failure(),
                _ => None,
            },
            _ => None,
        }
    }
    /// Error of a stage, or of the stages as a whole.
    pub(crate) fn staging(stage: Option<&str>, source: StagingError) -> Self {
        let stage = stage.map(str::to_owned);
        Self::Staging { stage, source }
    }
    /// A fault of a scene file as that of a case, if the scene is one; other errors unchanged.
    #[must_use]
    pub fn in_case(self, case: Option<&str>) -> Self {
        match (self, case) {
            (Self::Scene(fault), Some(case)) => fault.in_case(case).into(),
            (error, _) => error,
        }
    }
    /// Error of bolts.
    pub(crate) fn of_bolts(source: StagingError) -> Self {
        Self::staging(None, source)
    }
}

impl From<SceneFault> for Error {
    fn from(fault: SceneFault) -> Self {
        Self::Scene(Box::new(fault))
    }
}
