//! Changes that reduce the cost of a scene, with the error of each.
//!
//! # Why so
//! *Savings follow from the cost model*: number of steps times wall time of a step. Changes of kernel, number format
//! and damping are made in the scene's file; the stable step of the changed scene is computed, and its steps are timed
//! alternately with those of the unchanged one. Changes of the mesh are rated by the number of remaining elements.
//!
//! *Errors are measured on the scene itself*, over the first part of its run with and without the change, or are
//! declared as not measured. Each is the error of one change alone; the time ratios of several changes multiply. A
//! scene that is not in double precision is compared with itself in double precision.
//!
//! *Only changes that the scene allows are named*: half of a body needs a mesh, parts and waves with a mirror image, a
//! slice needs a constant section along an axis (with delayed sides along y, under waves of one slowness along it), and nearer faces need a scatterer whose waves can be predicted. Loads,
//! supports and bolts are not compared with their mirror images, and the text of the change says so.

mod delayed;
mod shape;
mod variant;
mod window;

use core::f64::consts::TAU;
use core::fmt;
use std::time::Duration;

use powerhouse::engine::{Precision, StableStep};
use powerhouse::io::available_memory;
use powerhouse::model::{Axis, LimitingTerm};
use powerhouse::{FileScene, Resolution, Scene};

use crate::StudyError;
use crate::advice::Band;
use crate::cost::{CostModel, StepTimer};
use shape::NearerFaces;
use variant::Variants;
pub use window::MeasuredError;
use window::{ErrorGrowth, SceneFacts, Window};

/// Greatest number of changes that are named, and least share of the time that each must save: smaller shares are
/// below the resolution of the timing.
const MOST: usize = 3;
const LEAST: f64 = 0.1;
/// Greatest share of elements that are proposed to be enlarged, and least factor by which that increases the step.
const FEW: f64 = 0.05;
const WORTH: f64 = 1.1;
/// Least ratio of the assembled stable step to the least bound of a single element (1.28 for cubes, more for distorted
/// elements), times the safety factor of the step.
const ASSEMBLED: f64 = 1.2 * 0.98;
/// Source of the time ratio of changes of the numbers of steps or elements.
const BY_COUNT: &str = "not timed, from the numbers of steps and elements";

/// Documented largest relative L2 errors of a history for the number formats `mixed` and `f32`.
const MIXED_ERROR: f64 = 0.01;
const SINGLE_ERROR: f64 = 0.03;
const NO_ROOM: &str = "a second model in double precision does not fit into the available memory";
const NO_FILE: &str = "the scene is a case, or has no file that can be read again";

/// Change of a scene that may reduce its cost.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Change {
    /// Number format `mixed`: elements in single precision, nodes in double precision.
    Mixed,
    /// One-point hexahedra with hourglass stiffness in place of fully integrated ones.
    OnePoint,
    /// Frequency-independent damping by relaxation mechanisms in place of Rayleigh damping, over the same band.
    FlatDamping,
    /// Fibres for a step twice as long: added inertia of the motion across thin parts.
    Fibres,
    /// A time step equal to the stable step, without a safety factor.
    WholeStep,
    /// Half of the body, cut at the middle of the mesh, where mesh, element sets, absorbing faces and waves are
    /// symmetric; loads, supports and bolts are not examined and must be symmetric too.
    Half {
        /// Normal of the plane.
        axis: Axis,
        /// Coordinate of the plane along the normal (m).
        at: f64,
    },
    /// One layer of elements of a body with a constant section along an axis, if loads and supports are constant along it
    /// too, which is not examined.
    Slice {
        /// Axis of constant section.
        axis: Axis,
        /// Coordinate of the layer along the axis (m).
        at: f64,
    },
    /// One layer of elements with delayed sides, of a body with a constant section along y under waves that travel along it, if
    /// loads are constant along y too, which is not examined.
    DelayedSlice {
        /// Coordinate of the layer along y (m).
        at: f64,
        /// Whether the body has delayed ends, which become those of the slice.
        has_ends: bool,
    },
    /// Absorbing faces nearer to the structure.
    NearerFaces {
        /// Factor on the distances of the faces from the structure, below 1.
        share: f64,
    },
    /// Enlargement of the few elements that limit the time step.
    LargerElements {
        /// Element set of these elements.
        set: String,
        /// Number of the element with the least bound in the mesh file.
        element: u64,
        /// Number of elements with similar bounds.
        count: usize,
        /// Factor on their size from which on they no longer limit the step.
        times: f64,
    },
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mixed => f.write_str("elements in single precision (`precision = \"mixed\"`)"),
            Self::OnePoint => f.write_str("one-point hexahedra (`kernel = \"hex8-one-point\"`)"),
            Self::FlatDamping => f.write_str(
                "flat damping over the same band (`damping = { kind = \"flat\", ... }`) in place of Rayleigh damping",
            ),
            Self::Fibres => f.write_str("fibres across thin parts (`fibres = 2` in [time])"),
            Self::WholeStep => f.write_str("a step equal to the stable step (`step = \"auto\"`, `safety = 1`)"),
            Self::Half { axis, at } => write!(
                f,
                "half of the body, with `kind = \"symmetry\"` on {} = {at} m, if its loads, supports and bolts are symmetric",
                axis.name()
            ),
            Self::Slice { axis, at } => write!(
                f,
                "one layer of elements (`slice = {{ across = \"{}\", at = {at} }}`), if loads and supports are constant along the axis",
                axis.name()
            ),
            Self::DelayedSlice { at, has_ends } => {
                let ends = if *has_ends {
                    ""
                } else {
                    ", and `[[support]] kind = \"delayed\"` in place of what is at the ends along y"
                };
                write!(
                    f,
                    "one layer of elements under waves along it (`slice = {{ across = \"y\", at = {at} }}`{ends}, with the places of outputs in this layer), if loads are constant along the axis"
                )
            }
            Self::NearerFaces { share } => {
                write!(
                    f,
                    "absorbing faces at {share} of their distance from the structure (`powerhouse advise box`)"
                )
            }
            Self::LargerElements {
                set,
                element,
                count,
                times,
            } => write!(
                f,
                "larger elements where '{set}' limits the step ({count} elements, such as {element}, enlarged by a factor of {times:.2})"
            ),
        }
    }
}

/// Relative L2 error of a change, with its source.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedError {
    /// Relative error (1); `None` if it is unknown or only bounded from below.
    pub share: Option<f64>,
    /// Lower bound of the relative error (1), that of the computed first part of the run, where yielding, cracking or
    /// joints may amplify it later; `None` otherwise.
    pub least: Option<f64>,
    /// Name of the history that has the error, or `histories`.
    pub of: String,
    /// Formula or measurement behind the error, or the reason why it is unknown.
    pub source: String,
}

impl PredictedError {
    fn measured(error: &MeasuredError) -> Self {
        Self {
            share: (!error.amplified).then_some(error.share),
            least: error.amplified.then_some(error.share),
            of: error.history.clone(),
            source: error.source(),
        }
    }
    fn unknown(reason: &str) -> Self {
        Self {
            share: None,
            least: None,
            of: "histories".into(),
            source: reason.into(),
        }
    }
}

impl fmt::Display for PredictedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.share, self.least) {
            (Some(share), _) => write!(f, "error {share:.1e} of {}, {}", self.of, self.source),
            (None, Some(least)) => {
                write!(f, "error above {least:.1e} of {}, {}", self.of, self.source)
            }
            (None, None) => write!(f, "error of {} not measured: {}", self.of, self.source),
        }
    }
}

/// Error of a scene's number format against double precision.
#[derive(Clone, Debug, PartialEq)]
pub struct FormatError {
    /// Name of the number format in scenes: `mixed` or `f32`.
    pub format: &'static str,
    /// Documented largest relative L2 error of a history with this format in lined openings (1).
    pub documented: f64,
    /// Error in this scene, measured over the first part of its run.
    pub error: PredictedError,
}

impl FormatError {
    /// Whether the error of the number format in this scene is unknown, or above its documented error.
    #[must_use]
    pub fn needs_warning(&self) -> bool {
        let share = self.error.share;
        share.is_none_or(|share| share > self.documented || share.is_nan())
    }

    /// The number format of a scene with its documented error; `None` for double precision.
    fn documented(scene: &Scene) -> Option<(&'static str, f64)> {
        match scene.precision() {
            Precision::F64 => None,
            Precision::Mixed => Some(("mixed", MIXED_ERROR)),
            Precision::F32 => Some(("f32", SINGLE_ERROR)),
        }
    }

    /// The documented error of a scene's number format, with the reason why its error in this scene is not measured;
    /// `None` for double precision.
    pub fn not_measured(scene: &Scene, reason: &str) -> Option<Self> {
        let (format, documented) = Self::documented(scene)?;
        let error = PredictedError::unknown(reason);
        Some(Self {
            format,
            documented,
            error,
        })
    }

    /// Whether [`of`](Self::of) computes a part of the run of a scene in double precision, if there is the memory for it.
    pub(crate) fn is_measured(scene: &FileScene) -> bool {
        let has_file = scene.spec().is_some() && scene.case().is_none();
        scene.precision() != Precision::F64 && has_file && window::obstacle(scene).is_none()
    }

    /// Measures the error of a scene's number format over the first part of its run in both formats, in a few per cent
    /// of the time of the run; `None` for double precision. It is not measured if a second model, in double precision,
    /// does not fit into the available memory.
    ///
    /// # Errors
    /// Any error that would prevent the run.
    pub fn of(scene: &FileScene) -> Result<Option<Self>, StudyError> {
        let Some((format, documented)) = Self::documented(scene) else {
            return Ok(None);
        };
        let facts = SceneFacts::of(scene);
        if let Some(obstacle) = facts.obstacle {
            return Ok(Self::not_measured(scene, obstacle));
        }
        let Some(files) = Variants::of(scene) else {
            return Ok(Self::not_measured(scene, NO_FILE));
        };
        let room = SecondModel {
            needed: CostModel::of(scene)?.memory_in_double(),
            available: available_memory(),
        };
        if !room.fits() {
            return Ok(Self::not_measured(scene, NO_ROOM));
        }
        let Ok(mut simulation) = files.own.prepare(files.own.duration) else {
            return Ok(Self::not_measured(scene, "the scene cannot be run"));
        };
        let step = simulation.step()?;
        let of_step = StepTimer::of(&mut simulation)?.time_of_step()?;
        drop(simulation);
        let timing = RunTiming {
            step,
            steps: (files.own.duration / step).ceil() as u64 + 1,
            of_step,
        };
        let window = Window::of(files.own.clone(), &facts, &timing, 1);
        let error = against_double(&files, &window);
        Ok(Some(Self {
            format,
            documented,
            error,
        }))
    }
}

/// Memory of a second model of a scene, with a mesh of its own, beside one that there is already.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SecondModel {
    /// Memory (bytes) in double precision.
    pub(crate) needed: u64,
    /// Memory that the system can give (bytes), if that is known.
    pub(crate) available: Option<u64>,
}

impl SecondModel {
    fn fits(self) -> bool {
        self.available
            .is_none_or(|available| self.needed <= available)
    }
}

fn against_double(files: &Variants, window: &Window) -> PredictedError {
    match window.error_against(&files.double, ErrorGrowth::OfRounding) {
        Ok(error) => PredictedError::measured(&error),
        Err(reason) => PredictedError::unknown(reason),
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { format, error, .. } = self;
        write!(
            f,
            "number format \"{format}\" against double precision: {error}"
        )
    }
}

/// A change that could save much, but with which the scene is refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RefusedChange {
    /// Change of the scene that is refused, or not compared with it.
    pub change: Change,
    /// Message of the error with which the changed scene is refused, or why it is not compared.
    pub reason: String,
}

impl RefusedChange {
    fn new(change: Change, error: &StudyError) -> Self {
        let reason = match error {
            // Lines and columns are those of the changed text, which nobody sees.
            StudyError::Scene(powerhouse::Error::Scene(fault)) => fault.problem().to_string(),
            error => error.to_string(),
        };
        Self { change, reason }
    }
}

impl fmt::Display for RefusedChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = if self.reason == NO_ROOM {
            "not compared"
        } else {
            "refused"
        };
        write!(f, "{}: {what}, {}", self.change, self.reason)
    }
}

/// Steps of a run.
#[derive(Clone, Copy)]
pub(crate) struct RunTiming {
    /// Their length (s).
    pub(crate) step: f64,
    /// Their number.
    pub(crate) steps: u64,
    /// Wall time of one.
    pub(crate) of_step: Duration,
}

/// Changes that save, and the error of the number format.
pub(crate) struct Savings {
    /// Those that save most, the best first.
    pub(crate) best: Vec<Saving>,
    pub(crate) refused: Vec<RefusedChange>,
    pub(crate) format: Option<FormatError>,
}

/// Saving of wall time by a change, with the error of the change.
#[derive(Clone, Debug, PartialEq)]
pub struct Saving {
    /// Change of the scene.
    pub change: Change,
    /// Number of time steps with the change over that without (1).
    pub steps: f64,
    /// Number of elements with the change over that without (1).
    pub elements: f64,
    /// Wall time of all time steps with the change over that without (1); stages are not included.
    pub time: f64,
    /// Source of the time ratio, in words: timed, or from the numbers of steps and elements.
    pub timed: &'static str,
    /// Error of results that the change causes, as predicted or measured.
    pub error: PredictedError,
}

impl fmt::Display for Saving {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: saves {:.0} % of the time ({}; {:.2} of the steps, {:.2} of the elements); {}",
            self.change,
            100.0 * (1.0 - self.time),
            self.timed,
            self.steps,
            self.elements,
            self.error,
        )
    }
}

/// Data for the savings of a scene that are collected before it is prepared.
pub(crate) struct Survey {
    of_shape: Vec<Saving>,
    nearer: Option<NearerFaces>,
    files: Option<Variants>,
    facts: SceneFacts,
    /// Number format of the scene with its documented error, unless it is double precision.
    format: Option<(&'static str, f64)>,
    elements: usize,
    /// Highest frequency of the incident motion (Hz), if there are waves.
    highest: Option<f64>,
    /// Travel time of shear waves through the body (s).
    crossing: f64,
}

impl Survey {
    pub(crate) fn of(scene: &FileScene, resolution: &[Resolution]) -> Result<Self, StudyError> {
        let (low, high) = scene.mesh().bounding_box();
        let speeds = resolution.iter().map(|part| part.s_speed);
        // Without incident motion no frequency limits the size of elements.
        let band = match scene.field() {
            Some(_) => Band::of(scene).ok(),
            None => None,
        };
        Ok(Self {
            of_shape: shape::savings(scene)?,
            nearer: NearerFaces::of(scene),
            files: Variants::of(scene),
            facts: SceneFacts::of(scene),
            format: FormatError::documented(scene),
            elements: scene.mesh().element_count(),
            highest: band.map(|band| band.highest),
            crossing: (high - low).norm() / speeds.fold(f64::INFINITY, f64::min),
        })
    }

    /// The changes that save most, those that are refused, and the error of the scene's number format. Changes that are
    /// computed beside the scene itself are refused, and the error is not measured, if that does not fit into the memory.
    pub(crate) fn best(
        self,
        (stable, resolution): (&StableStep, &[Resolution]),
        (clock, timing): (&mut StepTimer, &RunTiming),
        room: SecondModel,
    ) -> Savings {
        let elements = self.elements;
        let (mut savings, mut refused) = (self.of_shape, Vec::new());
        let work = elements as f64 * timing.steps as f64;
        savings.extend(self.nearer.and_then(|faces| faces.saving(work)));
        if let Some(highest) = self.highest {
            let waves = Passage {
                highest,
                crossing: self.crossing,
            };
            savings.extend(whole_step(stable, timing.step, waves));
            let larger = larger_elements(stable, resolution, waves, elements);
            savings.extend(larger);
        }
        let mut error = PredictedError::unknown(NO_FILE);
        match self.files {
            Some(mut files) if room.fits() => {
                let variants = core::mem::take(&mut files.changed);
                let windows = variants.len() + usize::from(self.format.is_some());
                let window = Window::of(files.own.clone(), &self.facts, timing, windows);
                if self.format.is_some() {
                    error = against_double(&files, &window);
                }
                for variant in variants {
                    match variant.saving(clock, timing, &window) {
                        Ok(saving) => savings.extend(saving),
                        Err(change) => refused.push(change),
                    }
                }
            }
            Some(files) => {
                error = PredictedError::unknown(self.facts.obstacle.unwrap_or(NO_ROOM));
                refused.extend(files.changed.iter().map(|variant| variant.refused(NO_ROOM)));
            }
            None => {}
        }
        let format = self.format.map(|(format, documented)| FormatError {
            format,
            documented,
            error,
        });
        savings.retain(|saving| saving.time <= 1.0 - LEAST);
        savings.sort_by(|a, b| a.time.total_cmp(&b.time));
        savings.truncate(MOST);
        Savings {
            best: savings,
            refused,
            format,
        }
    }
}

/// Waves on their way through the body.
#[derive(Clone, Copy)]
struct Passage {
    /// Highest frequency that counts (Hz).
    highest: f64,
    /// Time of shear waves through the body (s).
    crossing: f64,
}

/// Saving by a step equal to the stable one. Central differences shorten periods by `(w dt)^2 / 24`; the error is the
/// phase shift of waves of the highest frequency through the body.
fn whole_step(stable: &StableStep, step: f64, waves: Passage) -> Option<Saving> {
    let share = step / stable.step;
    let (rate, crossing) = (TAU * waves.highest, waves.crossing);
    (share < 1.0).then(|| Saving {
        change: Change::WholeStep,
        steps: share,
        elements: 1.0,
        time: share,
        timed: BY_COUNT,
        error: PredictedError {
            least: None,
            share: Some(rate * crossing * (rate * stable.step).powi(2) / 24.0),
            of: "motion at the highest frequency after the longest travel path".into(),
            source: "not measured, the phase error (w dt)^2/24 of central differences".into(),
        },
    })
}

/// Saving by larger elements where few of them limit the step. The error is the phase error of the longest elements of
/// their set, enlarged by the same factor.
fn larger_elements(
    stable: &StableStep,
    resolution: &[Resolution],
    waves: Passage,
    elements: usize,
) -> Option<Saving> {
    let times = stable.next_set_bound? / stable.element_bound;
    let few = (stable.similar_elements as f64) <= FEW * elements as f64;
    let by_size = stable.term == LimitingTerm::Stiffness;
    let of_set = resolution.iter().find(|part| part.set == stable.set)?;
    if !(times > WORTH && few && by_size) {
        return None;
    }
    let (rate, crossing) = (TAU * waves.highest, waves.crossing);
    let wave_number = rate / of_set.s_speed;
    // Few small elements share nodal masses with others, so that the step is longer than their own bound.
    let steps = stable.step / (ASSEMBLED * stable.next_set_bound?);
    Some(Saving {
        change: Change::LargerElements {
            set: stable.set.clone(),
            element: stable.element,
            count: stable.similar_elements,
            times,
        },
        steps,
        elements: 1.0,
        time: steps,
        timed: BY_COUNT,
        error: PredictedError {
            least: None,
            share: Some(
                rate * crossing * (wave_number * times * of_set.longest_edge).powi(2) / 24.0,
            ),
            of: "motion at the highest frequency, at most".into(),
            source: "not measured, the phase error (k h)^2/24 of hexahedra with lumped mass".into(),
        },
    })
}
