//! What can be said of a scene without running it.

use core::fmt;

use powerhouse::engine::StableStep;
use powerhouse::model::{ElementKind, QualityReport};
use powerhouse::{Doubt, Error, Remark, Scene, StageOverview, Topic};

use crate::StudyError;
use crate::cost::{self, Clock, Cost};
use crate::free_field::FreeFieldCheck;
use crate::joints::{self, JointOverview};
use crate::resolution::{self, Resolution};
use crate::saving::{FormatError, RefusedChange, RunTiming, Saving, Savings, Survey};
use crate::static_cost::{self, Plans};

/// Above this ratio of longest to shortest edge waves travel at different speeds along and across.
const LARGEST_ASPECT: f64 = 10.0;
/// Below this scaled Jacobian an element is badly distorted.
const LEAST_JACOBIAN: f64 = 0.2;
/// A doubt about a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Something that was found when the scene was composed.
    Remark(Remark),
    /// Elements much longer than wide.
    Aspect {
        /// The largest ratio of longest to shortest edge in one element.
        ratio: f64,
    },
    /// A badly distorted element.
    Distorted {
        /// The user's number.
        element: u64,
        /// Its scaled Jacobian.
        scaled_jacobian: f64,
    },
    /// Parts of the mesh that share no nodes.
    Disconnected {
        /// How many.
        parts: usize,
    },
    /// Tetrahedra, which are too stiff in bending and lock where volume is kept.
    Tetrahedra {
        /// The part's set.
        set: String,
    },
    /// A motion that a part cannot carry.
    Unresolved {
        /// What moves: the incoming field, or a record if there is none.
        motion: String,
        /// The part's set.
        set: String,
        /// Share of the motion's energy (of acceleration) above the part's frequency.
        share: f64,
        /// That frequency (Hz).
        frequency: f64,
    },
    /// Nodes of a joint that face each other from afar.
    Mismatch {
        /// The joint's name.
        joint: String,
        /// Their distance (m).
        distance: f64,
        /// Their numbers.
        nodes: [u64; 2],
        /// The shortest edge of the joint's facets (m).
        edge: f64,
    },
    /// A joint that runs into an absorbing face.
    JointAtBoundary {
        /// The joint's name.
        joint: String,
        /// How many of its pairs are there.
        pairs: usize,
    },
    /// A field that does not move the surface in the time of the run.
    StillField {
        /// The run's duration (s).
        duration: f64,
    },
    /// A number format of which the error is unknown, or larger than it is documented to be.
    Format(FormatError),
    /// No field, load, weight or prescribed motion: nothing moves.
    Undriven,
}

impl Warning {
    /// As the files of a run have it, with what of the results it is about.
    pub fn doubt(&self) -> Doubt {
        let about = match self {
            Self::Remark(remark) => remark.topic(),
            Self::Unresolved { .. } | Self::Format(_) => Topic::Histories,
            Self::Mismatch { .. } | Self::JointAtBoundary { .. } => Topic::Joints,
            Self::StillField { .. } => Topic::Input,
            _ => Topic::Run,
        };
        let text = self.to_string();
        Doubt { about, text }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Remark(remark) => remark.fmt(f),
            Self::Aspect { ratio } => write!(
                f,
                "an element is {ratio:.1} times as long as wide (advice: at most {LARGEST_ASPECT})"
            ),
            Self::Distorted {
                element,
                scaled_jacobian,
            } => write!(
                f,
                "element {element} is badly distorted: scaled Jacobian {scaled_jacobian:.3} (advice: at least {LEAST_JACOBIAN})"
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
                "nodes {first} and {second} of joint '{joint}' face each other from {distance:.3e} m, its edges are {edge:.3e} m and longer"
            ),
            Self::JointAtBoundary { joint, pairs } => write!(
                f,
                "{pairs} pairs of joint '{joint}' stand on absorbing faces, behind which the ground has no joint"
            ),
            Self::StillField { duration } => write!(
                f,
                "the field does not move the surface within the {duration} s of the run"
            ),
            Self::Format(format) => write!(
                f,
                "{format}; elsewhere it errs by at most {} of a history: `precision = \"f64\"` does not err so",
                format.documented
            ),
            Self::Undriven => f.write_str("nothing drives this scene"),
            Self::Unresolved {
                motion,
                set,
                share,
                frequency,
            } => write!(
                f,
                "{:.1} % of the energy of {motion} lies above {frequency:.1} Hz, which is all that '{set}' carries",
                100.0 * share
            ),
        }
    }
}

/// What can be said of a scene without running it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CheckReport {
    /// The scene's title.
    pub title: String,
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Elements of the mesh.
    pub elements: usize,
    /// Shapes of the elements.
    pub quality: QualityReport,
    /// Frequencies that the parts carry.
    pub resolution: Vec<Resolution>,
    /// The joints.
    pub joints: Vec<JointOverview>,
    /// The stages before the run.
    pub stages: Vec<StageOverview>,
    /// The stable step and who limits it.
    pub stable: StableStep,
    /// What a run will cost.
    pub cost: Cost,
    /// Facts of the scene's composition.
    pub remarks: Vec<Remark>,
    /// Doubts.
    pub warnings: Vec<Warning>,
    /// The error of the scene's number format, if it is not double precision.
    pub format: Option<FormatError>,
    /// The three changes that would save most, the best first.
    pub savings: Vec<Saving>,
    /// Changes with which the scene is refused, and why.
    pub refused: Vec<RefusedChange>,
}

/// Looks at a scene: mesh, frequencies, stable step, and what its stages and its run will cost. Some steps,
/// and the first corrections of the stages, are computed to see how long they take.
///
/// # Errors
/// What would keep the scene from running; a stage that does not come to rest, as far as was seen.
pub fn check(scene: Scene) -> Result<CheckReport, StudyError> {
    let mesh = scene.mesh().clone();
    let quality = mesh.check().map_err(Error::from)?;
    let resolution = resolution::resolution(&scene)?;
    let joints = JointOverview::all(&scene);
    let stages = scene.stage_overviews()?;
    let mut warnings = warnings_of(&scene, &quality, &resolution)?;
    let (account, plans) = (cost::Account::of(&scene)?, Plans::of(&scene)?);
    let survey = Survey::of(&scene, &resolution)?;
    let free_field = match scene.self_check() {
        Some(_) => Some(FreeFieldCheck::of(&scene)?),
        None => None,
    };
    let mut simulation = scene.prepare()?;
    // Some remarks need the step.
    simulation.step()?;
    let remarks = simulation.remarks().to_vec();
    let doubts = remarks.iter().filter(|remark| remark.is_warning());
    warnings.extend(doubts.cloned().map(Warning::Remark));
    let stable = simulation.stable_step()?;
    let step = simulation.step()?;
    let steps = (simulation.duration() / step).ceil() as u64 + 1;
    let self_check = match free_field {
        Some(check) => Some(check.wall_time(step)?),
        None => None,
    };
    let of_stages = static_cost::of(&simulation, &plans, account.memory_of_stages())?;
    let title = simulation.title().to_owned();
    let mut clock = Clock::of(&mut simulation)?;
    let of_step = clock.time_of_step()?;
    let cost = Cost {
        steps,
        step,
        wall_time: of_step.mul_f64(steps as f64),
        stages: of_stages,
        self_check,
        memory: account.memory(steps),
        output: account.output(steps),
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
    let doubtful = format.iter().filter(|format| format.is_doubtful());
    warnings.extend(doubtful.cloned().map(Warning::Format));
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

/// Doubts about a scene that need no run to be seen: shapes of elements, and what they cannot carry.
/// Those that show when the scene is prepared are in [`powerhouse::Simulation::remarks`].
///
/// # Errors
/// A mesh or a set that is at fault.
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
        warnings.push(Warning::Undriven);
    }
    warnings.extend(resolution::doubts(scene, resolution)?);
    warnings.extend(joints::doubts(scene)?);
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
    // A joint may part the mesh.
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
