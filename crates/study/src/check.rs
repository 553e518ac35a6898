//! Assessment of a scene before its run.

use core::fmt;

use powerhouse::engine::StableStep;
use powerhouse::model::{ElementKind, QualityReport};
use powerhouse::{Error, Message, Remark, Scene, StageOverview, Topic};

use crate::StudyError;
use crate::cost::{self, Cost, StepTimer};
use crate::free_field::FreeFieldCheck;
use crate::joints::{self, JointOverview};
use crate::resolution::{self, Resolution};
use crate::saving::{FormatError, RefusedChange, RunTiming, Saving, Savings, Survey};
use crate::static_cost::{self, StagePlans};

/// Aspect ratio above which the wave speeds along and across an element differ noticeably.
const LARGEST_ASPECT: f64 = 10.0;
/// Scaled Jacobian below which an element is badly distorted.
const LEAST_JACOBIAN: f64 = 0.2;

/// Warning about a scene: a condition that reduces the accuracy of its results.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// A remark with the rank of a warning, from the composition of the scene.
    Remark(Remark),
    /// An element with an aspect ratio above 10.
    Aspect {
        /// Largest aspect ratio of an element: longest over shortest edge.
        ratio: f64,
    },
    /// A badly distorted element: scaled Jacobian below 0.2.
    Distorted {
        /// User number of the element.
        element: u64,
        /// Least scaled Jacobian of the element.
        scaled_jacobian: f64,
    },
    /// A mesh of several parts that share no nodes.
    Disconnected {
        /// Number of parts.
        parts: usize,
    },
    /// Four-node tetrahedra, which are too stiff in bending and lock in isochoric flow.
    Tetrahedra {
        /// Element set of the part.
        set: String,
    },
    /// A motion with more than 1 % of its energy above the frequency that a part resolves.
    Unresolved {
        /// Description of the motion: the incident field, or a record if there is no field.
        motion: String,
        /// Element set of the part.
        set: String,
        /// Share of the energy of acceleration above the resolved frequency.
        share: f64,
        /// Highest frequency (Hz) that the part resolves.
        frequency: f64,
    },
    /// A node pair of a joint with a distance above 5 % of the shortest edge.
    Mismatch {
        /// Name of the joint.
        joint: String,
        /// Distance between the nodes of the pair (m).
        distance: f64,
        /// User numbers of the two nodes.
        nodes: [u64; 2],
        /// Shortest edge of the facets of the joint (m).
        edge: f64,
    },
    /// A joint with node pairs on absorbing faces; the free field has no joint there.
    JointAtBoundary {
        /// Name of the joint.
        joint: String,
        /// Number of its node pairs on absorbing faces.
        pairs: usize,
    },
    /// An incident field that does not move the surface within the duration of the run.
    StillField {
        /// Duration of the run (s).
        duration: f64,
    },
    /// A number format whose error is unknown or above its documented value.
    Format(FormatError),
    /// A scene without excitation: no incident field, load, weight or prescribed motion.
    NoExcitation,
}

impl Warning {
    /// Converts the warning to the form that result files contain: its text with the affected kind of results.
    pub fn message(&self) -> Message {
        let about = match self {
            Self::Remark(remark) => remark.topic(),
            Self::Unresolved { .. } | Self::Format(_) => Topic::Histories,
            Self::Mismatch { .. } | Self::JointAtBoundary { .. } => Topic::Joints,
            Self::StillField { .. } => Topic::Input,
            _ => Topic::Run,
        };
        let text = self.to_string();
        Message { about, text }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Remark(remark) => remark.fmt(f),
            Self::Aspect { ratio } => write!(
                f,
                "the largest aspect ratio of an element is {ratio:.1} (recommended: at most {LARGEST_ASPECT})"
            ),
            Self::Distorted {
                element,
                scaled_jacobian,
            } => write!(
                f,
                "element {element} is badly distorted: scaled Jacobian {scaled_jacobian:.3} (recommended: at least {LEAST_JACOBIAN})"
            ),
            Self::Disconnected { parts } => {
                write!(f, "the mesh has {parts} parts that share no nodes")
            }
            Self::Tetrahedra { set } => write!(
                f,
                "'{set}' has four-node tetrahedra: too stiff in bending, and they lock in plastic flow"
            ),
            Self::Mismatch {
                joint,
                distance,
                nodes: [first, second],
                edge,
            } => write!(
                f,
                "the paired nodes {first} and {second} of joint '{joint}' are {distance:.3e} m apart; its shortest edge is {edge:.3e} m long"
            ),
            Self::JointAtBoundary { joint, pairs } => write!(
                f,
                "{pairs} node pairs of joint '{joint}' lie on absorbing faces, behind which the free field has no joint"
            ),
            Self::StillField { duration } => write!(
                f,
                "the incident field does not move the surface within the {duration} s of the run"
            ),
            Self::Format(format) => write!(
                f,
                "{format}; its documented relative error of a history is at most {}; `precision = \"f64\"` avoids this error",
                format.documented
            ),
            Self::NoExcitation => f.write_str(
                "the scene has no excitation: no incident field, load, weight or prescribed motion",
            ),
            Self::Unresolved {
                motion,
                set,
                share,
                frequency,
            } => write!(
                f,
                "{:.1} % of the energy of {motion} lies above {frequency:.1} Hz, the highest frequency that '{set}' resolves",
                100.0 * share
            ),
        }
    }
}

/// Report on a scene before its run: mesh quality, resolution, stable step, predicted cost and warnings.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CheckReport {
    /// Title of the scene.
    pub title: String,
    /// Number of nodes of the mesh.
    pub nodes: usize,
    /// Number of elements of the mesh.
    pub elements: usize,
    /// Quality of the elements.
    pub quality: QualityReport,
    /// Highest frequency that each part resolves.
    pub resolution: Vec<Resolution>,
    /// Geometry and law of each joint.
    pub joints: Vec<JointOverview>,
    /// Construction stages before the run.
    pub stages: Vec<StageOverview>,
    /// Stable time step and the element that limits it.
    pub stable: StableStep,
    /// Predicted cost of a run: steps, wall time, memory and size of its files.
    pub cost: Cost,
    /// Remarks of the composition of the scene.
    pub remarks: Vec<Remark>,
    /// Warnings about the accuracy of the results.
    pub warnings: Vec<Warning>,
    /// Error of the scene's number format against double precision; `None` for double precision.
    pub format: Option<FormatError>,
    /// The at most three changes that save most wall time, the best first.
    pub savings: Vec<Saving>,
    /// Changes with which the scene is refused, and why.
    pub refused: Vec<RefusedChange>,
}

/// Checks a scene before its run: mesh quality, resolved frequencies, stable step, and predicted cost of its stages
/// and its run. Some steps, and the first corrections of the stages, are computed and timed.
///
/// # Errors
/// Any error that would prevent the run; a stage that does not reach static equilibrium within the timed
/// corrections.
pub fn check(scene: Scene) -> Result<CheckReport, StudyError> {
    let mesh = scene.mesh().clone();
    let quality = mesh.check().map_err(Error::from)?;
    let resolution = resolution::resolution(&scene)?;
    let joints = JointOverview::all(&scene);
    let stages = scene.stage_overviews()?;
    let mut warnings = warnings_of(&scene, &quality, &resolution)?;
    let (model, plans) = (cost::CostModel::of(&scene)?, StagePlans::of(&scene)?);
    let survey = Survey::of(&scene, &resolution)?;
    let free_field = match scene.self_check() {
        Some(_) => Some(FreeFieldCheck::of(&scene)?),
        None => None,
    };
    let mut simulation = scene.prepare()?;
    // Some remarks are made only when the step is known.
    simulation.step()?;
    let remarks = simulation.remarks().to_vec();
    let severe = remarks.iter().filter(|remark| remark.is_warning());
    warnings.extend(severe.cloned().map(Warning::Remark));
    let stable = simulation.stable_step()?;
    let step = simulation.step()?;
    let steps = (simulation.duration() / step).ceil() as u64 + 1;
    let self_check = match free_field {
        Some(check) => Some(check.wall_time(step)?),
        None => None,
    };
    let of_stages = static_cost::of(&simulation, &plans, model.memory_of_stages())?;
    let title = simulation.title().to_owned();
    let mut clock = StepTimer::of(&mut simulation)?;
    let of_step = clock.time_of_step()?;
    let cost = Cost {
        steps,
        step,
        wall_time: of_step.mul_f64(steps as f64),
        stages: of_stages,
        self_check,
        memory: model.memory(steps),
        output: model.output(steps),
    };
    let timing = RunTiming {
        step,
        steps,
        of_step,
    };
    let Savings {
        best: savings,
        refused,
        format,
    } = survey.best(&stable, &resolution, &mut clock, &timing);
    let severe = format.iter().filter(|format| format.needs_warning());
    warnings.extend(severe.cloned().map(Warning::Format));
    Ok(CheckReport {
        title,
        nodes: mesh.node_count(),
        elements: mesh.element_count(),
        quality,
        resolution,
        joints,
        stages,
        stable,
        cost,
        remarks,
        warnings,
        format,
        savings,
        refused,
    })
}

/// Warnings about a scene that follow from its description alone: quality of elements, unresolved motion, joints,
/// missing excitation. Those found when the scene is prepared are in [`powerhouse::Simulation::remarks`].
///
/// # Errors
/// An invalid mesh or set.
pub fn warnings(scene: &Scene) -> Result<Vec<Warning>, StudyError> {
    let quality = scene.mesh().check().map_err(Error::from)?;
    warnings_of(scene, &quality, &resolution::resolution(scene)?)
}

fn warnings_of(
    scene: &Scene,
    quality: &QualityReport,
    resolution: &[Resolution],
) -> Result<Vec<Warning>, StudyError> {
    let mut warnings = shape_warnings(scene, quality)?;
    if !scene.is_driven() {
        warnings.push(Warning::NoExcitation);
    }
    warnings.extend(resolution::warnings(scene, resolution)?);
    warnings.extend(joints::warnings(scene)?);
    Ok(warnings)
}

fn shape_warnings(scene: &Scene, quality: &QualityReport) -> Result<Vec<Warning>, StudyError> {
    let mut warnings = Vec::new();
    if quality.largest_aspect > LARGEST_ASPECT {
        warnings.push(Warning::Aspect {
            ratio: quality.largest_aspect,
        });
    }
    if quality.least_scaled_jacobian < LEAST_JACOBIAN {
        warnings.push(Warning::Distorted {
            element: quality.worst_element,
            scaled_jacobian: quality.least_scaled_jacobian,
        });
    }
    // A joint may split the mesh into parts.
    if quality.parts > 1 + scene.joints().count() {
        warnings.push(Warning::Disconnected {
            parts: quality.parts,
        });
    }
    for part in scene.parts() {
        let elements = scene.mesh().element_set(&part.set).map_err(Error::from)?;
        if elements
            .iter()
            .any(|&e| scene.mesh().kind(e) == ElementKind::Tet4)
        {
            warnings.push(Warning::Tetrahedra {
                set: part.set.clone(),
            });
        }
    }
    Ok(warnings)
}
