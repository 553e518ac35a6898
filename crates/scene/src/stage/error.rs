//! Errors of construction stages, bolts and in-situ stress.

use powerhouse_model::{EngineError, ParameterError};
use thiserror::Error;

/// Error of the construction stages of a scene, its bolts or its in-situ stress.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StagingError {
    /// Two stages have the same name.
    #[error("another stage has the same name")]
    SameName,
    /// Element set that does not exist.
    #[error("there is no element set '{set}' to {}", match *what { "water" => "give a water level", other => other })]
    NoSuchSet {
        /// Name of the element set.
        set: String,
        /// Operation: `excavate`, `cast` or `water`.
        what: &'static str,
    },
    /// Element of an excavated set that is not active: excavated by an earlier stage and not cast since.
    #[error("element {element} of set '{set}' cannot be excavated: it is not active")]
    NotActive {
        /// Element set.
        set: String,
        /// Number of the element in the mesh file.
        element: u64,
    },
    /// Element of a cast set that is active already: cast by an earlier stage and not excavated since.
    #[error("element {element} of set '{set}' cannot be cast: it is active already")]
    AlreadyActive {
        /// Element set.
        set: String,
        /// Number of the element in the mesh file.
        element: u64,
    },
    /// Temporary material of an element set that is not that of a part of the scene.
    #[error("there is no part '{set}'")]
    NoSuchPart {
        /// Element set.
        set: String,
    },
    /// Temporary material of a part of which no element is active after the changes of the stage.
    #[error(
        "no element of part '{set}' is active in this stage, so that it cannot have another material; elements that are cast later have the material of their part"
    )]
    InactivePart {
        /// Element set.
        set: String,
    },
    /// Bolt group that a stage installs and the scene does not have.
    #[error("there are no bolts '{name}'")]
    NoSuchBolts {
        /// Name.
        name: String,
    },
    /// Bolt group that an earlier stage installed already.
    #[error("the bolts '{name}' are installed already")]
    AlreadyInstalled {
        /// Name.
        name: String,
    },
    /// Bolt group of the scene that no stage installs.
    #[error("no stage installs the bolts '{name}'")]
    UnusedBolts {
        /// Name.
        name: String,
    },
    /// Two bolt groups of the scene with the same name.
    #[error("two bolt groups have the name '{name}'")]
    SameBolts {
        /// Name.
        name: String,
    },
    /// Bolt pattern without facets on the surface of the body when it is installed.
    #[error(
        "the pattern of the bolts '{name}' has no facet on the surface of the body when it is installed"
    )]
    NoFreeFacet {
        /// Name.
        name: String,
    },
    /// Bolt group that cannot be embedded in the elements that are active when it is installed.
    #[error("bolts '{name}': {source}")]
    Bolts {
        /// Name.
        name: String,
        /// Cause.
        source: EngineError,
    },
    /// Excavated element that bolts installed earlier cross.
    #[error("element {element} of set '{set}' cannot be excavated: the bolts '{name}' cross it")]
    Bolted {
        /// Element set.
        set: String,
        /// Number of the element in the mesh file.
        element: u64,
        /// Name of the bolt group.
        name: String,
    },
    /// Joint that a stage ties or grouts and the scene does not have.
    #[error("there is no joint '{name}'")]
    NoSuchJoint {
        /// Name.
        name: String,
    },
    /// Stage that a temporary load names for its removal and that does not exist.
    #[error("there is no stage '{name}' that could remove the load")]
    NoSuchStage {
        /// Name.
        name: String,
    },
    /// Load that would be removed before it acts.
    #[error(
        "stage '{name}' cannot remove the load: it acts from stage '{first}' on, which must be an earlier one"
    )]
    RemovedEarly {
        /// Stage that is to remove the load.
        name: String,
        /// First stage in which the load acts.
        first: String,
    },
    /// Water level of an element set without present elements that have water in their pores and without joints with water beside it.
    #[error(
        "no element of set '{set}' is active in this stage and has water in its pores, and no joint beside it has `water`: give its material `pore_water`"
    )]
    NoWater {
        /// Element set.
        set: String,
    },
    /// Element with two water levels in one stage.
    #[error("element {element} of set '{set}' has another water level in the same stage already")]
    TwoLevels {
        /// Element set of the second level.
        set: String,
        /// Number of the element in the mesh file.
        element: u64,
    },
    /// Two water levels of one stage that are of no element set.
    #[error("two water levels of the stage name no set: one of them may be for all other ground")]
    TwoGeneralLevels,
    /// Water level of an element that the same stage casts.
    #[error(
        "element {element} of set '{set}' is cast in this stage, with pores without pressure: give it a water level in a later stage"
    )]
    LevelOfCast {
        /// Element set.
        set: String,
        /// Number of the element in the mesh file.
        element: u64,
    },
    /// Element of which the height is not in the table of pressures of a stage.
    #[error(
        "element {element} has its centre at z = {height} m, and the table of pressures reaches from {} to {} m", range[0], range[1]
    )]
    BeyondTable {
        /// Element set of the table; empty for all ground.
        set: String,
        /// Number of the element in the mesh file.
        element: u64,
        /// Height z of its centre (m).
        height: f64,
        /// Lowest and highest height of the table (m).
        range: [f64; 2],
    },
    /// Node pair of a joint that is beside two sets with different water levels in one stage.
    #[error(
        "joint '{joint}' has node pairs beside set '{set}' that have another water level in the same stage already, as beside another set"
    )]
    TwoLevelsOfJoint {
        /// Name of the joint.
        joint: String,
        /// Element set of the second level.
        set: String,
    },
    /// Node pair of a joint with water whose height is not in a table of pressures.
    #[error(
        "joint '{joint}' has a node pair at z = {height} m, and the table of pressures reaches from {} to {} m", range[0], range[1]
    )]
    JointBeyondTable {
        /// Name of the joint.
        joint: String,
        /// Height z of the pair (m).
        height: f64,
        /// Lowest and highest height of the table (m).
        range: [f64; 2],
    },
    /// Water level in an undrained stage.
    #[error(
        "a water level in an undrained stage: where no water flows the level cannot change; let a drained stage come before"
    )]
    UndrainedLevel,
    /// Undrained stage, or a water level, of a body without water in its pores.
    #[error("{what} in a body without water in pores or joints: give a material `pore_water`")]
    Dry {
        /// Key that concerns water: `undrained` or `water`.
        key: &'static str,
        /// Subject: `an undrained stage` or `a water level`.
        what: &'static str,
    },
    /// Option of the static analysis outside its permitted range.
    #[error(transparent)]
    Options(#[from] ParameterError),
    /// Preload of a joint in a scene with stages, which compute its traction.
    #[error(
        "the traction of joint '{joint}' follows from the stages: a preload would be counted twice"
    )]
    Preload {
        /// Name of the joint.
        joint: String,
    },
    /// In-situ stress by elements whose number of entries is not that of the elements of the mesh.
    #[error("the in-situ stress has {found} entries, the mesh {expected} elements")]
    StressCount {
        /// Number of entries.
        found: usize,
        /// Number of elements of the mesh.
        expected: usize,
    },
    /// Initial motion of the free field in a scene with stages.
    #[error("a scene with stages starts at rest: the initial motion cannot be that of the field")]
    InMotion,
    /// User-defined constraint, which cannot be built anew for every stage.
    #[error("the constraint '{name}' cannot be used in a scene with stages")]
    Constraint {
        /// Name of the constraint.
        name: String,
    },
    /// In-situ stress, bolts, or a joint with water and without a preload in a scene without stages.
    #[error(
        "{what} can be used only in a scene with stages: add a stage, in which the body reaches static equilibrium"
    )]
    NoStage {
        /// Subject: `an in-situ stress`, `bolts` or `a joint with water and without a preload`.
        what: &'static str,
    },
}

impl StagingError {
    /// Key of a scene file that the error concerns, and its value.
    pub fn item(&self) -> (&'static str, &str) {
        match self {
            Self::NoSuchSet { set, what } => (what, set),
            Self::NotActive { set, .. } | Self::Bolted { set, .. } => ("excavate", set),
            Self::AlreadyActive { set, .. } => ("cast", set),
            Self::NoSuchPart { set } | Self::InactivePart { set } => ("part", set),
            Self::NoSuchBolts { name } | Self::AlreadyInstalled { name } => ("bolts", name),
            Self::UnusedBolts { name } | Self::SameBolts { name } | Self::NoFreeFacet { name } => {
                ("bolt", name)
            }
            Self::Bolts { name, .. } => ("bolt", name),
            Self::NoWater { set }
            | Self::TwoLevels { set, .. }
            | Self::LevelOfCast { set, .. }
            | Self::BeyondTable { set, .. }
            | Self::TwoLevelsOfJoint { set, .. } => ("water", set),
            Self::JointBeyondTable { joint, .. } => ("joint", joint),
            Self::TwoGeneralLevels | Self::UndrainedLevel => ("water", ""),
            Self::Dry { key, .. } => (key, ""),
            Self::NoSuchJoint { name } => ("joint", name),
            Self::NoSuchStage { name } | Self::RemovedEarly { name, .. } => ("removed_in", name),
            Self::Preload { joint } => ("preload", joint),
            Self::Options(error) => ("options", error.name),
            Self::NoStage { .. } => ("stage", ""),
            Self::InMotion => ("initial", ""),
            Self::SameName | Self::StressCount { .. } | Self::Constraint { .. } => ("", ""),
        }
    }
}
