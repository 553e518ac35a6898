//! Why stages cannot be as they are to.

use powerhouse_explicit_core::EngineError;
use powerhouse_model::ParameterError;
use thiserror::Error;

/// What is wrong with the stages of a scene, its bolts or its in-situ stress.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StagingError {
    /// Two stages of one name.
    #[error("there is another stage of this name")]
    SameName,
    /// A set that does not exist.
    #[error("there is no element set '{set}' to {what}")]
    NoSuchSet {
        /// The set.
        set: String,
        /// `excavate` or `cast`.
        what: &'static str,
    },
    /// An element that is to be taken out, but is gone or not yet there.
    #[error("element {element} of set '{set}' is to be excavated, but is not there")]
    NotThere {
        /// The set.
        set: String,
        /// The user's number of the element.
        element: u64,
    },
    /// An element that is to be put in, but is there.
    #[error("element {element} of set '{set}' is to be cast, but is there already")]
    AlreadyThere {
        /// The set.
        set: String,
        /// The user's number of the element.
        element: u64,
    },
    /// A material for what is no part.
    #[error("there is no part '{set}'")]
    NoSuchPart {
        /// The set.
        set: String,
    },
    /// A material for a part that is not there in the stage.
    #[error(
        "no element of part '{set}' is there in this stage: what is excavated has no material, and what is cast later has that of its part"
    )]
    AbsentPart {
        /// The set.
        set: String,
    },
    /// Bolts that the scene does not have.
    #[error("there are no bolts '{name}'")]
    NoSuchBolts {
        /// The name.
        name: String,
    },
    /// Bolts that an earlier stage installed.
    #[error("the bolts '{name}' are installed already")]
    BoltsTwice {
        /// The name.
        name: String,
    },
    /// Bolts that no stage installs.
    #[error("no stage installs the bolts '{name}'")]
    IdleBolts {
        /// The name.
        name: String,
    },
    /// Two sets of bolts of one name.
    #[error("there are other bolts of the name '{name}'")]
    SameBolts {
        /// The name.
        name: String,
    },
    /// A pattern on facets of which none is on the surface of the body when it is installed.
    #[error("the pattern of the bolts '{name}' finds no place: none of its facets is free")]
    NoPlace {
        /// The name.
        name: String,
    },
    /// Bolts that cannot be embedded.
    #[error("bolts '{name}': {source}")]
    Bolts {
        /// The name.
        name: String,
        /// Why.
        source: EngineError,
    },
    /// An element with bolts in it that is to be taken out.
    #[error("element {element} of set '{set}' is to be excavated, but the bolts '{name}' cross it")]
    Bolted {
        /// The set.
        set: String,
        /// The user's number of the element.
        element: u64,
        /// The bolts.
        name: String,
    },
    /// A joint that the scene does not have.
    #[error("there is no joint '{name}'")]
    NoSuchJoint {
        /// The name.
        name: String,
    },
    /// A load that a stage is to take off which the scene does not have.
    #[error("there is no stage '{name}' that could take the load off")]
    NoSuchStage {
        /// The name.
        name: String,
    },
    /// A load that would be taken off before it ever acted.
    #[error(
        "stage '{name}' cannot take the load off: it acts from stage '{first}' on, which is not before"
    )]
    RemovedEarly {
        /// The stage that is to take it off.
        name: String,
        /// The stage in which it acts first.
        first: String,
    },
    /// An option of the static solution out of range.
    #[error(transparent)]
    Options(#[from] ParameterError),
    /// A preload of a joint, which stages would count a second time.
    #[error("the joint '{joint}' takes its traction from the stages: a preload would count twice")]
    Preload {
        /// The joint.
        joint: String,
    },
    /// An in-situ stress of the wrong length.
    #[error("the in-situ stress has {found} entries, the mesh {expected} elements")]
    StressCount {
        /// Entries.
        found: usize,
        /// Elements.
        expected: usize,
    },
    /// A body that is to start in motion.
    #[error("a body with stages starts at rest, not with the motion of the field")]
    InMotion,
    /// A constraint of one's own, of which there is one for one model.
    #[error("the constraint '{name}' cannot go through stages")]
    Constraint {
        /// Its name.
        name: String,
    },
    /// An in-situ stress or bolts, and no stage in which the body comes to rest with them.
    #[error(
        "{what} can act only in a scene with stages: give a stage in which the body comes to rest"
    )]
    NoStage {
        /// `an in-situ stress` or `bolts`.
        what: &'static str,
    },
}

impl StagingError {
    /// The key of a scene file that it concerns, and which of its values.
    pub(crate) fn item(&self) -> (&'static str, &str) {
        match self {
            Self::NoSuchSet { set, what } => (what, set),
            Self::NotThere { set, .. } | Self::Bolted { set, .. } => ("excavate", set),
            Self::AlreadyThere { set, .. } => ("cast", set),
            Self::NoSuchPart { set } | Self::AbsentPart { set } => ("part", set),
            Self::NoSuchBolts { name } | Self::BoltsTwice { name } => ("bolts", name),
            Self::IdleBolts { name } | Self::SameBolts { name } | Self::NoPlace { name } => {
                ("bolt", name)
            }
            Self::Bolts { name, .. } => ("bolt", name),
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
