//! What this crate refuses.

use std::path::PathBuf;

use powerhouse_contact::ContactError;
use powerhouse_explicit_core::{StageError, StaticError};
use powerhouse_model::{MeshError, ModelError, ParameterError, RunError};
use thiserror::Error;

use crate::{
    FolderError, Magnitude, MagnitudeOf, MirrorError, NameError, Problem, RegionError, Results,
    SceneFault, StagingError,
};

/// Why a scene cannot be read, composed, run or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A fault of a scene file, with its place.
    #[error(transparent)]
    Scene(Box<SceneFault>),
    /// A case that the scene's file does not have.
    #[error("the scene has no case '{name}', only {}", available.join(", "))]
    NoSuchCase {
        /// The name.
        name: String,
        /// Those that it has.
        available: Vec<String>,
    },
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file that cannot be written.
    #[error(transparent)]
    Write(#[from] powerhouse_io::IoError),
    /// A folder that does not take the files of a run, or lost them.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// Elements that belong to no part, or to several.
    #[error("element {element} belongs to {count} parts, it must belong to one")]
    PartCount {
        /// The user's number of the first such element.
        element: u64,
        /// Parts that it belongs to.
        count: usize,
    },
    /// An element of a kind that no kernel computes.
    #[error("element {element} of part '{set}' is a {kind}, which no kernel computes")]
    NoKernel {
        /// The user's number.
        element: u64,
        /// The part's set.
        set: String,
        /// The element's kind.
        kind: &'static str,
    },
    /// A body at rest in a field that moves already.
    #[error(
        "the body starts at rest at t = {time} s, when '{field}' already stands at {level:.1e} of its peak"
    )]
    NotAtRest {
        /// The field's name.
        field: String,
        /// Displacement or velocity then, over its peak.
        level: f64,
        /// The start (s).
        time: f64,
    },
    /// A free field of one medium in front of another.
    #[error(
        "the medium at node {node} of the absorbing faces is not that of the field '{field}' ({count} such nodes)"
    )]
    ForeignMedium {
        /// The field's name.
        field: String,
        /// The user's number of the first such node.
        node: u64,
        /// How many there are.
        count: usize,
    },
    /// A field that moves nothing.
    #[error("the field '{field}' moves nothing: {reason}")]
    UnusedField {
        /// The field's name.
        field: String,
        /// What is lacking.
        reason: &'static str,
    },
    /// A quantity beyond what is usual of ground and structures, in a scene that does not
    /// [allow](crate::Scene::allow_magnitudes) it.
    #[error("{magnitude}")]
    Magnitude {
        /// The quantity.
        magnitude: Box<Magnitude>,
        /// What it belongs to.
        of: MagnitudeOf,
    },
    /// A name of which no file of results can be named.
    #[error(transparent)]
    Name(#[from] NameError),
    /// A facet that two absorbing faces have, or one that is named twice: it would absorb twice.
    #[error("the absorbing faces '{first}' and '{second}' both have a facet of element {element}")]
    SharedFacet {
        /// The first face.
        first: String,
        /// The second one.
        second: String,
        /// The user's number of the element.
        element: u64,
    },
    /// A facet inside the body among the absorbing ones.
    #[error("the absorbing face '{face}' runs through the body at element {element}")]
    InnerFacet {
        /// The face.
        face: String,
        /// The user's number of the element.
        element: u64,
    },
    /// A region around which the field cannot enter.
    #[error(transparent)]
    Region(#[from] RegionError),
    /// A plane of symmetry at which half of the body does not stand for the whole.
    #[error(transparent)]
    Mirror(#[from] MirrorError),
    /// A kernel that none of its part's elements is for.
    #[error("part '{set}' has no element that the kernel '{kernel}' takes")]
    IdleKernel {
        /// The part's set.
        set: String,
        /// The kernel.
        kernel: String,
    },
    /// Damping in series with a law of which nobody says what part of its strain is elastic.
    #[error(
        "part '{set}': damping cannot stand in series with the law '{law}', whose elastic part is not told"
    )]
    NotInSeries {
        /// The part's set.
        set: String,
        /// The law.
        law: String,
    },
    /// A rim without an element.
    #[error(
        "part '{set}' has a rim, but no element of it touches an absorbing face or is within {width} m of one"
    )]
    IdleRim {
        /// The part's set.
        set: String,
        /// The rim's width (m).
        width: f64,
    },
    /// A joint that cannot start as it is to.
    #[error("joint '{joint}', nodes {first} and {second}: {source}")]
    Joint {
        /// Its name.
        joint: String,
        /// The user's number of the first node of the pair.
        first: u64,
        /// The user's number of the second one.
        second: u64,
        /// What its pair cannot have.
        source: ContactError,
    },
    /// A joint that does not exist.
    #[error("there is no joint '{name}'")]
    NoSuchJoint {
        /// The name.
        name: String,
    },
    /// A zone without a pair of its joint.
    #[error(
        "joint '{joint}' has no pair in {zone}{}",
        distance.map_or(String::new(), |d| format!(": the nearest is {d:.4e} m away"))
    )]
    EmptyZone {
        /// The joint's name.
        joint: String,
        /// The zone.
        zone: String,
        /// The distance of the nearest pair from its point (m), if it has one.
        distance: Option<f64>,
    },
    /// Stages, bolts or an initial stress that cannot be as they are to.
    #[error(
        "{}{source}",
        stage.as_ref().map_or(String::new(), |stage| format!("stage '{stage}': "))
    )]
    Staging {
        /// The stage, if it concerns one.
        stage: Option<String>,
        /// What is wrong.
        source: StagingError,
    },
    /// A stage in which the body does not come to rest.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// A body that cannot be set in motion as its stages left it.
    #[error("handing over to the motion: {source}")]
    HandOver {
        /// Why.
        source: StaticError,
    },
    /// A body at rest that came from the stages of another scene.
    #[error(
        "the body at rest has {found} nodes and {found_absent} absent elements, the scene {expected} and {expected_absent}"
    )]
    ForeignBody {
        /// Its nodes.
        found: usize,
        /// Elements that are not there.
        found_absent: usize,
        /// Nodes of the scene's mesh.
        expected: usize,
        /// Elements that are not there after its stages.
        expected_absent: usize,
    },
    /// A file that holds no whole body at rest, or one of another version.
    #[error("{} holds no whole body at rest that this version reads", path.display())]
    NotABody {
        /// The file.
        path: PathBuf,
    },
    /// A run that was stopped from outside before the body moved.
    #[error("interrupted in the stage '{stage}'")]
    Interrupted {
        /// The stage that has not come to rest.
        stage: String,
    },
    /// A start from the field's motion, and no field.
    #[error("the run is to start from the field's motion, but the scene has no field")]
    NoField,
    /// A step that is not given for a run of a given time.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A mesh that cannot be computed with, or a set that does not exist.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A part of the model refused.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A run refused its step.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A run ended before its time.
    #[error("{error}")]
    Failed {
        /// What ended it.
        error: RunError,
        /// What was recorded until then.
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
    /// What is wrong with a stage, or with the stages of the scene as a whole.
    pub(crate) fn staging(stage: Option<&str>, source: StagingError) -> Self {
        let stage = stage.map(str::to_owned);
        Self::Staging { stage, source }
    }
    /// What is wrong with bolts.
    pub(crate) fn of_bolts(source: StagingError) -> Self {
        Self::staging(None, source)
    }
}

impl From<SceneFault> for Error {
    fn from(fault: SceneFault) -> Self {
        Self::Scene(Box::new(fault))
    }
}
