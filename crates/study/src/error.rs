//! What this crate refuses.

use std::path::PathBuf;

use powerhouse::model::{MeshError, ParameterError};
use thiserror::Error;

/// Why a study of a scene cannot be done.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The scene itself is at fault.
    #[error(transparent)]
    Scene(#[from] powerhouse::Error),
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A mesh that cannot be made.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file of a bay that says what no bay has.
    #[error("{}: {source}", file.display())]
    BayFile {
        /// The file.
        file: PathBuf,
        /// What and where.
        source: Box<toml::de::Error>,
    },
    /// A case of a sweep that is refused or failed on its way; what it came to until then is in its folder.
    #[error("case '{case}': {source}")]
    Case {
        /// Its name.
        case: String,
        /// Why.
        source: Box<StudyError>,
    },
    /// A scene without cases, which is no sweep.
    #[error("{} has no [[case]]: a sweep needs some", file.display())]
    NoCases {
        /// The file.
        file: PathBuf,
    },
    /// A folder that holds the results of neither a sweep nor a run.
    #[error("{} holds neither a sweep nor a run", folder.display())]
    NoResults {
        /// The folder.
        folder: PathBuf,
    },
    /// A scene that records nothing by which runs could be compared.
    #[error("the scene records no history to compare runs by: name some under [[output.history]]")]
    NoHistories,
    /// A quantity to compare runs by that the scene does not record.
    #[error("the scene records no history of {quantity} to compare runs by")]
    NotRecorded {
        /// The quantity.
        quantity: &'static str,
    },
    /// A window in which nothing that is compared moves: no run would err.
    #[error("nothing that is compared moves within the first {window} s")]
    StillHistories {
        /// Its length (s).
        window: f64,
    },
    /// A scene of which nothing that is compared repeats.
    #[error(
        "nothing that is compared repeats: waves larger by a millionth change even {history} by {:.1e} %; a \
         shorter window or other quantities may, or every history is to count", 100.0 * change
    )]
    NothingRepeats {
        /// The history that changes least.
        history: String,
        /// Its relative change.
        change: f64,
    },
    /// A scene that would not be the same on smaller elements.
    #[error(
        "on smaller elements the nodal load on '{set}' would act at {more} nodes instead of {nodes}"
    )]
    MoreLoad {
        /// The load's set.
        set: String,
        /// Its nodes.
        nodes: usize,
        /// Those on smaller elements.
        more: usize,
    },
    /// A factor that a scene does not leave to choose.
    #[error("the scene leaves no '{name}' to choose, but {}", available.join(", "))]
    NoSuchFactor {
        /// The name.
        name: String,
        /// Names that there are.
        available: Vec<&'static str>,
    },
    /// A scene of which the answer is not known.
    #[error("the scene has no closed form: {reason}")]
    NoClosedForm {
        /// Why not.
        reason: &'static str,
    },
    /// A scene that cannot be written as a file.
    #[error("{}: {source}", file.display())]
    Unwritable {
        /// The file that it came from.
        file: PathBuf,
        /// Why.
        source: Box<toml::ser::Error>,
    },
    /// A scene that was edited while its cases ran.
    #[error("{} was edited while its cases ran: what is finished is of the old one", file.display())]
    Changed {
        /// The file.
        file: PathBuf,
    },
    /// The outcome of a case that cannot be understood.
    #[error("{}: {source}", file.display())]
    Outcome {
        /// The file.
        file: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// An odd number of elements across the transformer cavern, whose axis would have no node.
    #[error("the transformer cavern needs an even number of elements across it, not {cells}")]
    OddCells {
        /// The number.
        cells: usize,
    },
    /// A scene without absorbing faces.
    #[error("the scene has no absorbing boundary")]
    NoBoundary,
    /// Absorbing faces at the bottom or the top alone.
    #[error(
        "the absorbing faces {} stand below or above alone: the error is predicted by an opening between absorbing sides, which this scene does not have",
        .faces.iter().map(|face| format!("'{face}'")).collect::<Vec<_>>().join(", ")
    )]
    NoSides {
        /// Their names.
        faces: Vec<String>,
    },
    /// Absorbing faces before several media.
    #[error(
        "the absorbing faces stand before several media: {media}; a prediction knows ground of one"
    )]
    SeveralMedia {
        /// The parts with the faces before them.
        media: String,
    },
    /// A field of which nobody says what waves it is made of.
    #[error("the scene's field is not known to be a sum of plane waves")]
    UnknownField,
    /// A scene in which nothing moves.
    #[error("nothing drives this scene")]
    Undriven,
    /// Faces too near for a prediction.
    #[error(
        "an absorbing face {distance:.2} m from what scatters leaves no room for a prediction: it takes {least:.2} m"
    )]
    NearFace {
        /// The distance from the centre of what scatters (m).
        distance: f64,
        /// The least distance (m).
        least: f64,
    },
    /// A face that is not plane, or empty.
    #[error("the face '{face}' is not plane, so that no ground can be put before it")]
    NotPlane {
        /// The face.
        face: String,
    },
    /// Histories that were recorded at different instants.
    #[error(
        "two runs were recorded {} and {} times, up to {apart:.3e} s apart",
        counts[0],
        counts[1]
    )]
    DifferentTimes {
        /// Instants of both.
        counts: [usize; 2],
        /// The largest difference (s).
        apart: f64,
    },
    /// No field comes in.
    #[error("the scene has no incident field to check")]
    NoField,
    /// A side of the box that neither absorbs nor is held as a whole.
    #[error(
        "the free-field check needs a box whose sides absorb or are held: the {face} of the mesh's box does neither"
    )]
    OpenFace {
        /// The side of the box.
        face: &'static str,
    },
    /// An absorbing face that lies on none of the box's sides.
    #[error(
        "the free-field check needs absorbing faces on the sides of a box: '{face}' lies on none of them"
    )]
    ObliqueFace {
        /// The face's name.
        face: String,
    },
    /// The field does not move the points where it is checked within the time of the run.
    #[error("the field does not move the surface and the structure within {duration} s")]
    StillField {
        /// The run's duration (s).
        duration: f64,
    },
    /// The run of the check was stopped from outside.
    #[error("interrupted")]
    Interrupted,
    /// The error of the free field is above what the scene permits.
    #[error(
        "the free field of this mesh, step and boundary errs by {error:.4}, above the scene's self_check = {limit}"
    )]
    TooCoarse {
        /// The relative L2 error.
        error: f64,
        /// The permitted error.
        limit: f64,
    },
}

impl StudyError {
    /// The same of a case of a sweep, unless it is none of the case's own.
    pub(crate) fn in_case(self, case: &str) -> Self {
        match self {
            Self::Interrupted | Self::Changed { .. } => self,
            error => Self::Case {
                case: case.into(),
                source: Box::new(error),
            },
        }
    }
}
