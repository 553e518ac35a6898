//! What would make a scene cheaper, and what error that is predicted to bring.
//!
//! # Why so
//! *Savings come from the cost model*: steps times the time of a step. Changes of kernel, number format and
//! damping are made in the scene's file, and the changed scene is asked for its stable step and some of its
//! steps are timed in turns with those of the scene as it stands; changes of the mesh count the elements that
//! are left.
//!
//! *Errors are measured on the scene itself*, over the first part of its run both ways, or say that they are
//! not. They are those of the change alone; several changes together save by the product of their shares. A
//! scene that is not in double precision is measured against itself in double precision.
//!
//! *Only what the scene allows is named*: half a body needs a mesh, parts and waves with a mirror image, a
//! slice a body that is the same all along an axis, faces that come nearer a structure whose scattered waves
//! can be predicted. Loads, supports and bolts are not compared with their images, and the advice says so.

mod shape;
mod variant;
mod window;

use core::f64::consts::TAU;
use core::fmt;
use std::time::Duration;

use powerhouse::Scene;
use powerhouse::engine::{Precision, StableStep};
use powerhouse::model::{Axis, LimitingTerm};

use crate::StudyError;
use crate::advice::Band;
use crate::cost::Clock;
use crate::resolution::Resolution;
use variant::Files;
pub use window::MeasuredError;
use window::{Facts, Growth, Window};

/// So many are named, and none that saves less than this share of the time: turns of a clock tell no less.
const MOST: usize = 3;
const LEAST: f64 = 0.1;
/// Elements worth making larger are at most this share of all, and let the step grow by more than this.
const FEW: f64 = 0.05;
const WORTH: f64 = 1.1;
/// The stable step of assembled elements over the least bound of one alone, at least: 1.28 for cubes, more for
/// distorted ones, less the margin of the step.
const ASSEMBLED: f64 = 1.2 * 0.98;
/// How the time is known of changes that leave steps as they are, or elements.
const BY_COUNT: &str = "not timed, from the count of steps and elements";

/// The largest relative L2 error of a history that number formats are documented to make.
const MIXED_ERROR: f64 = 0.01;
const SINGLE_ERROR: f64 = 0.03;
const NO_FILE: &str = "the scene is a case, or has no file that could be read again";

/// A change of a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Change {
    /// Elements computed in single precision, nodes in double.
    Mixed,
    /// Bricks of one point with hourglass stiffness in place of others.
    OnePoint,
    /// Damping by relaxation mechanisms over the band of the scene's Rayleigh damping, in its place.
    FlatDamping,
    /// The whole of the stable step.
    WholeStep,
    /// Half of the body, cut where it and the waves have a mirror image.
    Half {
        /// The normal of the plane.
        axis: Axis,
        /// Where it lies (m).
        at: f64,
    },
    /// One layer of elements of a body that is the same all along an axis.
    Slice {
        /// The axis.
        axis: Axis,
        /// Where the layer is cut (m).
        at: f64,
    },
    /// Absorbing faces at this share of their distance from the structure.
    NearerFaces {
        /// The share.
        share: f64,
    },
    /// The elements that limit the step made larger.
    LargerElements {
        /// Their set.
        set: String,
        /// The user's number of the worst of them.
        element: u64,
        /// How many are as bad.
        count: usize,
        /// So many times as large they limit it no more.
        times: f64,
    },
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mixed => f.write_str("elements in single precision (`precision = \"mixed\"`)"),
            Self::OnePoint => f.write_str("bricks of one point (`kernel = \"hex8-one-point\"`)"),
            Self::FlatDamping => f.write_str(
                "flat damping over the same band (`damping = { kind = \"flat\", ... }`) in place of Rayleigh's",
            ),
            Self::WholeStep => f.write_str("the whole stable step (`step = \"auto\"`, `safety = 1`)"),
            Self::Half { axis, at } => write!(
                f,
                "half of the body, with `kind = \"symmetry\"` on {} = {at} m, if its loads, supports and bolts have a mirror image there",
                axis.name()
            ),
            Self::Slice { axis, at } => write!(
                f,
                "one layer of elements (`slice = {{ across = \"{}\", at = {at} }}`), if loads and supports are the same all along",
                axis.name()
            ),
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
                "larger elements where '{set}' limits the step ({count} of them, such as {element}, made {times:.2} times as large)"
            ),
        }
    }
}

/// An error, and how it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedError {
    /// Its size, relative; none if it is not known.
    pub share: Option<f64>,
    /// What is known of it where it may grow after the part of the run that was computed: it is at least so
    /// large.
    pub least: Option<f64>,
    /// What it is an error of.
    pub of: String,
    /// The formula or the measurement, or why nothing is known.
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

/// The error of a scene's number format against double precision.
#[derive(Clone, Debug, PartialEq)]
pub struct FormatError {
    /// The format, as scenes name it.
    pub format: &'static str,
    /// The largest relative error of a history that the format is documented to make in lined openings.
    pub documented: f64,
    /// The error in this scene.
    pub error: PredictedError,
}

impl FormatError {
    /// Whether it is unknown, or larger than is documented.
    #[must_use]
    pub fn is_doubtful(&self) -> bool {
        let share = self.error.share;
        share.is_none_or(|share| share > self.documented || share.is_nan())
    }

    /// The format of a scene, if it is not double precision, and its documented error.
    fn documented(scene: &Scene) -> Option<(&'static str, f64)> {
        match scene.precision() {
            Precision::F64 => None,
            Precision::Mixed => Some(("mixed", MIXED_ERROR)),
            Precision::F32 => Some(("f32", SINGLE_ERROR)),
        }
    }

    /// The error of the number format of a scene, from the first part of its run in both formats, which
    /// takes some hundredths of the time of the run; none in double precision.
    ///
    /// # Errors
    /// What would keep the scene from running.
    pub fn of(scene: &Scene) -> Result<Option<Self>, StudyError> {
        let Some((format, documented)) = Self::documented(scene) else {
            return Ok(None);
        };
        let facts = Facts::of(scene);
        let files = Files::of(scene);
        let error = match (facts.obstacle, &files) {
            (Some(obstacle), _) => PredictedError::unknown(obstacle),
            (None, None) => PredictedError::unknown(NO_FILE),
            (None, Some(files)) => match files.own.prepare(files.own.duration) {
                Err(_) => PredictedError::unknown("the scene does not run"),
                Ok(mut simulation) => {
                    let step = simulation.step()?;
                    let of_step = Clock::of(&mut simulation)?.time_of_step()?;
                    drop(simulation);
                    let timing = RunTiming {
                        step,
                        steps: (files.own.duration / step).ceil() as u64 + 1,
                        of_step,
                    };
                    let window = Window::of(files.own.clone(), &facts, &timing, 1);
                    against_double(files, &window)
                }
            },
        };
        Ok(Some(Self {
            format,
            documented,
            error,
        }))
    }
}

fn against_double(files: &Files, window: &Window) -> PredictedError {
    match window.error_against(&files.double, Growth::OfRounding) {
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
    /// The change.
    pub change: Change,
    /// What refuses the changed scene.
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
        write!(f, "{}: refused, {}", self.change, self.reason)
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

/// What a change saves, and at what error.
#[derive(Clone, Debug, PartialEq)]
pub struct Saving {
    /// The change.
    pub change: Change,
    /// Steps over those of the scene as it stands.
    pub steps: f64,
    /// Elements over those of the scene as it stands.
    pub elements: f64,
    /// Wall time of the steps over that of the scene as it stands.
    pub time: f64,
    /// How that is known.
    pub timed: &'static str,
    /// The error that it brings.
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

/// What is known of a scene's changes before it is prepared.
pub(crate) struct Survey {
    of_shape: Vec<Saving>,
    files: Option<Files>,
    facts: Facts,
    /// The scene's number format and its documented error, if it is not double precision.
    format: Option<(&'static str, f64)>,
    elements: usize,
    /// The highest frequency of the motion that comes in (Hz), if waves do.
    highest: Option<f64>,
    /// How long shear waves take through the body (s).
    crossing: f64,
}

impl Survey {
    pub(crate) fn of(scene: &Scene, resolution: &[Resolution]) -> Result<Self, StudyError> {
        let (low, high) = scene.mesh().bounding_box();
        let speeds = resolution.iter().map(|part| part.s_speed);
        // Without waves, or with those that stay away, no frequency says how small an element must be.
        let band = match scene.field() {
            Some(_) => Band::of(scene).ok(),
            None => None,
        };
        Ok(Self {
            of_shape: shape::savings(scene)?,
            files: Files::of(scene),
            facts: Facts::of(scene),
            format: FormatError::documented(scene),
            elements: scene.mesh().element_count(),
            highest: band.map(|band| band.highest),
            crossing: (high - low).norm() / speeds.fold(f64::INFINITY, f64::min),
        })
    }

    /// The changes that save most, those that are refused, and the error of the scene's number format.
    pub(crate) fn best(
        self,
        stable: &StableStep,
        resolution: &[Resolution],
        clock: &mut Clock,
        timing: &RunTiming,
    ) -> Savings {
        let elements = self.elements;
        let (mut savings, mut refused) = (self.of_shape, Vec::new());
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
        if let Some(mut files) = self.files {
            let variants = core::mem::take(&mut files.variants);
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

/// What the whole stable step saves: central differences shorten periods by `(w dt)^2 / 24`, which at the
/// highest frequency shifts waves through the body by so many radians.
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
            of: "motion at the highest frequency after the longest way".into(),
            source: "not measured, the phase error (w dt)^2/24 of central differences".into(),
        },
    })
}

/// What larger elements save where few of them limit the step. Waves through them have the phase error of
/// the longest elements of their set, once those are as much longer.
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
    // Few elements among others share the mass of their nodes: the step is already longer than theirs alone.
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
            source: "not measured, the phase error (k h)^2/24 of lumped bricks".into(),
        },
    })
}
