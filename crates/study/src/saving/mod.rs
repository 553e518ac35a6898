//! What would make a scene cheaper, and what error that is predicted to bring.
//!
//! # Why so
//! *Savings come from the cost model*: steps times the time of a step. Changes of kernel, number format and
//! damping are made in the scene's file, and the changed scene is asked for its stable step and some of its
//! steps are timed; changes of the mesh count the elements that are left.
//!
//! *Errors are measured or follow from a formula*, and each names its source. They are those of the change
//! alone; several changes together save by the product of their shares.
//!
//! *Only what the scene allows is named*: half a body needs a mesh, parts and waves with a mirror image, a
//! slice a body that is the same all along an axis, faces that come nearer a structure whose scattered waves
//! can be predicted. Loads, supports and bolts are not compared with their images, and the advice says so.

mod shape;
mod variant;

use core::f64::consts::TAU;
use core::fmt;

use powerhouse::engine::StableStep;
use powerhouse::model::{Axis, LimitingTerm};
use powerhouse::{Scene, Simulation};

use crate::StudyError;
use crate::advice::Band;
use crate::cost::Cost;
use crate::resolution::Resolution;
use variant::Variant;

/// So many are named, and none that saves less than this share of the time.
const MOST: usize = 3;
const LEAST: f64 = 0.05;
/// Elements worth making larger are at most this share of all, and let the step grow by more than this.
const FEW: f64 = 0.05;
const WORTH: f64 = 1.1;
/// The stable step of assembled elements over the least bound of one alone, at least: 1.28 for cubes, more for
/// distorted ones, less the margin of the step.
const ASSEMBLED: f64 = 1.2 * 0.98;

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
    /// Its size, relative.
    pub share: f64,
    /// What it is an error of.
    pub of: &'static str,
    /// The formula or the measurement.
    pub source: &'static str,
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
    /// The error that it brings.
    pub error: PredictedError,
}

impl fmt::Display for Saving {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: saves {:.0} % of the time ({:.2} of the steps, {:.2} of the elements); error {:.1e} of {}, by {}",
            self.change,
            100.0 * (1.0 - self.time),
            self.steps,
            self.elements,
            self.error.share,
            self.error.of,
            self.error.source,
        )
    }
}

/// What is known of a scene's changes before it is prepared.
pub(crate) struct Survey {
    of_shape: Vec<Saving>,
    variants: Vec<Variant>,
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
        let band = match scene.incident_field() {
            Some(_) => Band::of(scene).ok(),
            None => None,
        };
        Ok(Self {
            of_shape: shape::savings(scene)?,
            variants: Variant::all(scene),
            elements: scene.mesh().element_count(),
            highest: band.map(|band| band.highest),
            crossing: (high - low).norm() / speeds.fold(f64::INFINITY, f64::min),
        })
    }

    /// The changes that save most, those that save most first.
    pub(crate) fn best(
        self,
        stable: &StableStep,
        resolution: &[Resolution],
        (cost, simulation): (&Cost, &mut Simulation),
    ) -> Vec<Saving> {
        let (step, elements) = (cost.step, self.elements);
        let mut savings = self.of_shape;
        if let Some(highest) = self.highest {
            savings.extend(whole_step(stable, step, (highest, self.crossing)));
            let larger = larger_elements(stable, resolution, (highest, self.crossing), elements);
            savings.extend(larger);
        }
        let changed = self.variants.into_iter();
        savings.extend(changed.filter_map(|variant| variant.saving(simulation, cost.steps)));
        savings.retain(|saving| saving.time <= 1.0 - LEAST);
        savings.sort_by(|a, b| a.time.total_cmp(&b.time));
        savings.truncate(MOST);
        savings
    }
}

/// What the whole stable step saves: central differences shorten periods by `(w dt)^2 / 24`, which at the
/// highest frequency shifts waves through the body by so many radians.
fn whole_step(stable: &StableStep, step: f64, (highest, crossing): (f64, f64)) -> Option<Saving> {
    let share = step / stable.step;
    let rate = TAU * highest;
    (share < 1.0).then(|| Saving {
        change: Change::WholeStep,
        steps: share,
        elements: 1.0,
        time: share,
        error: PredictedError {
            share: rate * crossing * (rate * stable.step).powi(2) / 24.0,
            of: "motion at the highest frequency after the longest way",
            source: "the phase error (w dt)^2/24 of central differences",
        },
    })
}

/// What larger elements save where few of them limit the step. Waves through them have the phase error of
/// the longest elements of their set, once those are as much longer.
fn larger_elements(
    stable: &StableStep,
    resolution: &[Resolution],
    (highest, crossing): (f64, f64),
    elements: usize,
) -> Option<Saving> {
    let times = stable.next_set_bound? / stable.element_bound;
    let few = (stable.similar_elements as f64) <= FEW * elements as f64;
    let by_size = stable.term == LimitingTerm::Stiffness;
    let of_set = resolution.iter().find(|part| part.set == stable.set)?;
    if !(times > WORTH && few && by_size) {
        return None;
    }
    let rate = TAU * highest;
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
        error: PredictedError {
            share: rate * crossing * (wave_number * times * of_set.longest_edge).powi(2) / 24.0,
            of: "motion at the highest frequency, at most",
            source: "the phase error (k h)^2/24 of lumped bricks",
        },
    })
}
