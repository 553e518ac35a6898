//! Errors of this crate.

use std::path::PathBuf;

use powerhouse::CheckpointError;
use powerhouse::model::{MeshError, ModelError, ParameterError};
use powerhouse::wavefield::WaveError;
use thiserror::Error;

/// Error of a study of a scene.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// Error of the scene or of its run, where it concerns no case of a sweep.
    #[error(transparent)]
    Scene(#[from] powerhouse::Error),
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A mesh that cannot be built, or a set that it does not have.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A file that cannot be read, or a folder of a trade study that cannot be created.
    #[error("cannot read {}: {source}", file.display())]
    Read {
        /// Path of the file or folder.
        file: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// A case of a sweep that is invalid or whose run failed; its results until then are in its folder.
    #[error("case '{case}': {source}")]
    Case {
        /// Name of the case.
        case: String,
        /// Cause.
        source: Box<StudyError>,
    },
    /// A scene without cases, given for a sweep.
    #[error("{} has no [[case]]: a sweep needs at least one", file.display())]
    NoCases {
        /// The file.
        file: PathBuf,
    },
    /// A folder without results of a sweep or a run.
    #[error(
        "{} contains the results of neither a sweep nor a run; of a sweep, at least one case must be finished",
        folder.display()
    )]
    NoResults {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// What one rank alone can compute.
    #[error("{what} cannot be used on {ranks} ranks, only on one")]
    OneRankOnly {
        /// What it is.
        what: &'static str,
        /// Number of ranks.
        ranks: usize,
    },
    /// A new run in the folder of one of the same inputs that ended before its time, from whose checkpoint it can go on.
    #[error(
        "a run of this scene ended before its time in {path}: `powerhouse run --resume {path}` goes on {start}; `--restart` begins anew",
        path = folder.display()
    )]
    Unfinished {
        /// Path of the folder.
        folder: PathBuf,
        /// From where it goes on, in words.
        start: String,
    },
    /// A new run in a folder with a checkpoint that cannot be read.
    #[error(
        "{} has a checkpoint, but {source}; `--restart` removes it, --out gives another folder",
        folder.display()
    )]
    UnreadableCheckpoint {
        /// Path of the folder.
        folder: PathBuf,
        /// Cause.
        source: Box<CheckpointError>,
    },
    /// A result folder without a table of histories.
    #[error("{} has no histories: its scene needs at least one [[output.history]]", folder.display())]
    NoHistoryTable {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// A value of a table of histories that is not finite, or a time that does not increase.
    #[error(
        "{}: '{column}' is {value} in row {row}; expected finite values at increasing times",
        file.display()
    )]
    HistoryValue {
        /// Path of the table.
        file: PathBuf,
        /// Name of the column.
        column: String,
        /// Number of the row, from 1 below the header.
        row: usize,
        /// The value.
        value: f64,
    },
    /// A result folder without snapshots, of which pictures are wanted.
    #[error(
        "{} has no snapshots: its scene needs [output.snapshots]; a VTU file in it can be named instead",
        folder.display()
    )]
    NoSnapshots {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// A field that a VTU file does not have, or a part that the field does not have.
    #[error("{}: no field '{name}'; expected one of {}", file.display(), available.join(", "))]
    NoSuchField {
        /// Path of the file.
        file: PathBuf,
        /// Name of the quantity.
        name: String,
        /// Names of the quantities that the file has.
        available: Vec<String>,
    },
    /// A plane that does not cut the body of a picture.
    #[error("the cut at {at} m is outside of the body, which is from {:.6} to {:.6} m along its normal", extent[0], extent[1])]
    CutOutside {
        /// Place of the plane along its normal (m).
        at: f64,
        /// Lower and upper end of the body along the normal (m).
        extent: [f64; 2],
    },
    /// A picture that would show no element.
    #[error("{}: {}", file.display(), nothing(extents))]
    NothingDrawn {
        /// Path of the file.
        file: PathBuf,
        /// Lower and upper corner of what the plane of the picture has cut off completely (m); none without a plane.
        extents: Option<[[f64; 3]; 2]>,
    },
    /// A body that is to be drawn deformed, from a file without displacements.
    #[error(
        "{}: there is no displacement, by which the body could be drawn deformed; snapshots have it if their \
         `quantities` name it",
        file.display()
    )]
    NoDisplacement {
        /// Path of the file.
        file: PathBuf,
    },
    /// A file whose fields take more memory than is available.
    #[error(
        "the fields take {:.1} GB of memory, of which {:.1} are available: request fewer snapshots or quantities",
        *needed as f64 / 1e9,
        *available as f64 / 1e9
    )]
    Memory {
        /// Memory that is needed (bytes).
        needed: u64,
        /// Memory that is available (bytes).
        available: u64,
    },
    /// A line along which no values can be read.
    #[error("{reason}")]
    Line {
        /// Reason in words.
        reason: String,
    },
    /// A plot in the place of the tables of a run.
    #[error("{} would be among the tables of the run; choose another folder", file.display())]
    PlotAmongResults {
        /// Path of the plot.
        file: PathBuf,
    },
    /// A column that the table of histories does not have.
    #[error("no history '{name}'; expected one of {}", first_of(available))]
    NoSuchColumn {
        /// The name.
        name: String,
        /// Names of the columns.
        available: Vec<String>,
    },
    /// Columns of several tables, whose times differ, in one plot.
    #[error("{} are in several tables, whose times differ: draw them one by one", names.join(", "))]
    SeveralTables {
        /// Names of the columns.
        names: Vec<String>,
    },
    /// A history of which no spectrum exists.
    #[error(
        "'{name}' ({unit}) with {samples} samples has no spectrum: it is that of an acceleration (m/s2) with at least two \
         samples; record it with quantities = [\"acceleration\"]"
    )]
    NoAcceleration {
        /// Name of the column.
        name: String,
        /// Its unit.
        unit: String,
        /// Number of its samples.
        samples: usize,
    },
    /// A trade study without histories by which runs are compared: the scene records none, or no quantity is requested.
    #[error(
        "the scene records no history by which runs can be compared: add at least one [[output.history]]"
    )]
    NoHistories,
    /// A quantity that is requested for the comparison of runs
    /// ([`Trade::comparing`](crate::trade::Trade::comparing)) and that the scene does not record.
    #[error("the scene records no history of {quantity}, by which runs should be compared")]
    NotRecorded {
        /// Name of the quantity.
        quantity: &'static str,
    },
    /// A window of a trade study in which all compared histories of the reference are zero, so that errors are undefined.
    #[error("all compared histories are zero within the first {window} s")]
    StillHistories {
        /// Length of the window (s).
        window: f64,
    },
    /// A trade study whose perturbation test excludes all compared histories, since they depend sensitively on the input.
    #[error(
        "all compared histories depend sensitively on the input: waves of 1 + 1e-6 times the amplitude change even {history} by \
         {:.1e} %; shorten the window, compare other quantities, or count every history", 100.0 * change
    )]
    AllHistoriesSensitive {
        /// Name of the history with the least change.
        history: String,
        /// Relative L2 change of this history (1).
        change: f64,
    },
    /// A nodal load that would act on more nodes in a refined mesh, so that the refined scene is not equivalent.
    #[error(
        "in the refined mesh the nodal load on '{set}' would act on {more} nodes instead of {nodes}"
    )]
    MoreLoad {
        /// Node set of the load.
        set: String,
        /// Number of its nodes in the scene's mesh.
        nodes: usize,
        /// Number of its nodes in the refined mesh.
        more: usize,
    },
    /// A mesh of a convergence study whose elements are not smaller than those of the mesh before.
    #[error(
        "the elements of '{mesh}' have a mean size of {size:.3} m, not below the {coarser:.3} m of the mesh before: finer meshes \
         are given from the coarsest to the finest"
    )]
    NotFiner {
        /// Name of its run.
        mesh: String,
        /// Edge of a cube with the mean volume of its elements (m).
        size: f64,
        /// The same of the mesh before (m).
        coarser: f64,
    },
    /// A factor requested of a trade study ([`Trade::only`](crate::trade::Trade::only)) that the scene does not have.
    #[error("the scene has no factor '{name}'; available: {}", available.join(", "))]
    NoSuchFactor {
        /// Requested name.
        name: String,
        /// Names of the factors of the scene.
        available: Vec<&'static str>,
    },
    /// A trade study with the incident field as its reference, of a scene whose motion is not that of its incident field,
    /// or without recorded displacements or velocities.
    #[error("the scene has no closed-form solution: {reason}")]
    NoClosedForm {
        /// Reason in words.
        reason: &'static str,
    },
    /// A scene that cannot be written as TOML.
    #[error("{}: {source}", file.display())]
    Unwritable {
        /// File of the original scene.
        file: PathBuf,
        /// Cause.
        source: Box<toml::ser::Error>,
    },
    /// A scene file that was edited while the cases of a sweep ran; the sweep ends.
    #[error("{} was edited while its cases ran: the finished cases are those of the earlier version", file.display())]
    Changed {
        /// The file.
        file: PathBuf,
    },
    /// A folder in which another process computes cases of another scene, duration or program.
    #[error(
        "{}: another process computes a sweep of another scene, duration or program in this folder; wait for its end or give another folder (--out)",
        folder.display()
    )]
    OtherSweep {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// A result file of a case that is not valid JSON of the expected form.
    #[error("{}: {source}", file.display())]
    Outcome {
        /// Path of the file.
        file: PathBuf,
        /// Cause.
        source: serde_json::Error,
    },
    /// A scene without an absorbing boundary, of which advice is requested.
    #[error("the scene has no absorbing boundary")]
    NoBoundary,
    /// Absorbing faces of which none has a horizontal normal, so that advice on boundary or box is not available.
    #[error(
        "the absorbing faces {} lie only below or above: the prediction models an opening between absorbing sides, which this scene does not have",
        .faces.iter().map(|face| format!("'{face}'")).collect::<Vec<_>>().join(", ")
    )]
    NoSides {
        /// Names of the absorbing faces.
        faces: Vec<String>,
    },
    /// Absorbing faces with several elastic media behind them, so that advice on boundary or box is not available.
    #[error(
        "several media lie behind the absorbing faces: {media}; the prediction is limited to homogeneous ground"
    )]
    SeveralMedia {
        /// Parts with their absorbing faces, medium by medium, as text.
        media: String,
    },
    /// An incident field that is not declared as a sum of plane waves
    /// ([`Scene::with_plane_waves`](powerhouse::Scene::with_plane_waves)), which advice needs.
    #[error("the incident field of the scene is not declared as a sum of plane waves")]
    UnknownField,
    /// A scene without excitation (no incident field, load, weight or prescribed motion), of which advice is requested.
    #[error("the scene has no excitation: no incident field, load, weight or prescribed motion")]
    NoExcitation,
    /// An absorbing face too near to the scatterer for the substitute model.
    #[error(
        "an absorbing face is {distance:.2} m from the centre of the scatterer; the prediction needs at least {least:.2} m"
    )]
    NearFace {
        /// Distance (m) from the centre of the scatterer.
        distance: f64,
        /// Least distance (m) for the substitute model.
        least: f64,
    },
    /// Ground whose P waves are so much faster than its shear waves that the substitute model, which lasts as long as these need,
    /// and whose reference reaches as far as those get, would take too long.
    #[error(
        "the prediction is left out: its substitute model would have about {elements:.0} elements and {steps:.0} steps, since P waves are {ratio:.0} times as fast as shear waves"
    )]
    CostlyPrediction {
        /// Number of elements of the reference.
        elements: f64,
        /// Number of steps.
        steps: f64,
        /// Speed of P waves over that of shear waves.
        ratio: f64,
    },
    /// A face of elements with nodes on their edges, beyond which a mesh cannot be extended ([`grown`](fn@crate::grown)).
    #[error(
        "face '{face}' has elements with nodes on their edges, such as {element}, beyond which a mesh is not extended: use a mesh of first order (`order = 1`)"
    )]
    Midpoints {
        /// Name of the facet set.
        face: String,
        /// Number of an element.
        element: u64,
    },
    /// A facet set that is not plane or is empty, beyond which a mesh should be extended ([`grown`](fn@crate::grown)).
    #[error(
        "the face '{face}' is empty or not plane, so that the mesh cannot be extended beyond it"
    )]
    NotPlane {
        /// Name of the face.
        face: String,
    },
    /// Histories of two runs that were recorded at different instants.
    #[error(
        "the histories of two runs have {} and {} instants, which differ by up to {apart:.3e} s",
        counts[0],
        counts[1]
    )]
    DifferentTimes {
        /// Numbers of instants of both runs, the reference second.
        counts: [usize; 2],
        /// Largest difference of corresponding instants (s), as many as both runs have.
        apart: f64,
    },
    /// A scene without an incident field, for which no free-field check exists.
    #[error("the scene has no incident field to check")]
    NoField,
    /// A field without stress, such as motions at stations, for which no free-field check exists.
    #[error(
        "the free-field check needs the stress of the incident field, for the springs and dashpots of a box without structure: the field '{field}' has motions at stations alone"
    )]
    FieldWithoutStress {
        /// Name of the field.
        field: String,
    },
    /// A side of the mesh's bounding box, other than the top, that neither absorbs nor is supported as a whole, which the
    /// free-field check needs.
    #[error(
        "the free-field check needs a box whose sides absorb or are supported: the {face} of the mesh's box does neither"
    )]
    OpenFace {
        /// Side of the box: `left`, `right` (x), `front`, `back` (y) or `bottom`.
        face: &'static str,
    },
    /// An absorbing face with a facet whose centroid is on no side of the bounding box of the mesh, which the free-field
    /// check needs.
    #[error(
        "the free-field check needs absorbing faces on the sides of a box: '{face}' lies on none of them"
    )]
    ObliqueFace {
        /// Name of the face.
        face: String,
    },
    /// An incident field that does not move the points of the free-field check, or the surface for advice, within the
    /// duration of the run.
    #[error("the incident field does not move the surface and the structure within {duration} s")]
    StillField {
        /// Duration of the run (s).
        duration: f64,
    },
    /// Cancellation of a study from outside by its flag; finished cases or runs are kept.
    #[error("interrupted")]
    Interrupted,
    /// A free-field error above the limit of the scene: the run does not begin.
    #[error(
        "the relative error {error:.4} of the free field with this mesh, step and boundary is above the scene's self_check = {limit}"
    )]
    TooCoarse {
        /// Largest relative L2 error of velocity at the checked points (1).
        error: f64,
        /// Permitted relative error (1).
        limit: f64,
    },
}

impl StudyError {
    /// The error as one of a case of a sweep, unless it concerns the whole sweep.
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

impl From<WaveError> for StudyError {
    fn from(error: WaveError) -> Self {
        powerhouse::Error::from(ModelError::from(error)).into()
    }
}

/// Greatest number of names in a message.
const NAMED: usize = 24;

/// The first of some names, and how many there are besides.
fn first_of(names: &[String]) -> String {
    match names.len().checked_sub(NAMED) {
        None | Some(0) => names.join(", "),
        Some(more) => format!("{} and {more} others", names[..NAMED].join(", ")),
    }
}

/// Why a picture shows nothing.
fn nothing(extents: &Option<[[f64; 3]; 2]>) -> String {
    match extents {
        None => "no element of these sets is active".into(),
        Some([low, high]) => {
            format!("the plane leaves no element of the body, which is from {low:?} to {high:?} m")
        }
    }
}
