//! Assessment of a scene before its run.

use core::fmt;

use powerhouse::engine::StableStep;
use powerhouse::engine::observe::SectionGeometry;
use powerhouse::io::available_memory;
use powerhouse::model::{ElementKind, QualityReport, Vec3};
use powerhouse::{
    Error, FibreChoice, FibreOptions, FileScene, Message, Remark, Resolution, ResultFolder,
    Results, Scene, Simulation, StageOverview, Topic,
};

use crate::StudyError;
use crate::cost::{self, Cost, StepTimer};
use crate::extent::{SetExtent, separate_parts};
use crate::free_field::FreeFieldCheck;
use crate::joints::{self, JointOverview};
use crate::resolution;
use crate::saving::{FormatError, RefusedChange, RunTiming, Saving, Savings, SecondModel, Survey};
use crate::static_cost::{self, StagePlans};

/// Rate of growth of short waves in flow over the speed of S waves from which on a warning is due: a compressed slab makes noise of some
/// thousand m/s2 at 0.31 and of 40 to 100 at 0.13.
const GROWS: f64 = 0.1;
/// Aspect ratio above which the wave speeds along and across an element differ noticeably.
const LARGEST_ASPECT: f64 = 10.0;
/// Scaled Jacobian below which an element is badly distorted.
const LEAST_JACOBIAN: f64 = 0.2;

/// Warning about a scene: a condition that reduces the accuracy of its results.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// A [remark](powerhouse::Remark) of the scene's preparation that is a warning.
    Remark(Remark),
    /// A mesh with an element of an aspect ratio above 10.
    Aspect {
        /// Largest aspect ratio of an element of the mesh: longest over shortest edge.
        ratio: f64,
    },
    /// A mesh with a badly distorted element: scaled Jacobian below 0.2.
    Distorted {
        /// Number of the most distorted element in the mesh file.
        element: u64,
        /// Least scaled Jacobian of the element.
        scaled_jacobian: f64,
    },
    /// A mesh of more pieces without common nodes than the joints of the scene explain, each of which may divide it once.
    Disconnected {
        /// Number of pieces.
        parts: usize,
        /// Number of elements and element sets of each of them, the largest first.
        sets: Vec<(usize, Vec<String>)>,
    },
    /// A results folder that cannot be created, or in which files cannot be written.
    Folder {
        /// Reason, with the path of the folder.
        reason: String,
    },
    /// A run that takes more memory than the system can give; found by [`check()`] alone.
    Memory {
        /// Predicted peak memory of the stages or of the run (bytes), within a third.
        needed: u64,
        /// Memory that the system can give (bytes).
        available: u64,
    },
    /// An in-situ stress that is not in equilibrium with the loads and supports of the first stage.
    Unbalanced {
        /// Name of the first stage.
        stage: String,
        /// Unbalanced force at the start of the stage over the load.
        share: f64,
    },
    /// A part with four-node tetrahedra, which are too stiff in bending and lock in isochoric flow.
    Tetrahedra {
        /// Element set of the part.
        set: String,
    },
    /// A part whose plastic flow is so far from associated that short waves grow while it flows, and whose high frequencies nothing
    /// damps.
    IllPosed {
        /// Element set of the part.
        set: String,
        /// Rate of growth of a wave over its wave number (m/s), [`Material::growth_of_flow`](powerhouse::Material::growth_of_flow).
        growth: f64,
        /// Speed of S waves (m/s).
        s_speed: f64,
        /// Whether the body takes damping of high frequencies; one with delayed ends does not.
        takes_high: bool,
    },
    /// A part of tetrahedra with midpoints along the absorbing faces: it carries the waves, and its lumped masses ring.
    Ringing {
        /// Element set of the part.
        set: String,
        /// Number of its tetrahedra.
        tetrahedra: usize,
        /// Number of its elements.
        elements: usize,
    },
    /// A motion with more than 1 % of the energy of its acceleration at frequencies that a part does not resolve.
    Unresolved {
        /// Description of the motion: the incident motion at the surface, or, without a field, each record.
        motion: String,
        /// Element set of the part.
        set: String,
        /// Share of the energy of acceleration at the resolved frequency and above, 0.01 to 1.
        share: f64,
        /// Highest frequency (Hz) that the part resolves ([`Resolution`]).
        frequency: f64,
    },
    /// A joint whose worst node pair is farther apart than 5 % of the shortest edge of its facets; other pairs may exceed
    /// this too.
    Mismatch {
        /// Name of the joint.
        joint: String,
        /// Largest distance between the nodes of a pair (m).
        distance: f64,
        /// Numbers of the nodes of this pair in the mesh file.
        nodes: [u64; 2],
        /// Shortest edge of the facets of the joint (m).
        edge: f64,
    },
    /// A joint, other than a tie, with node pairs on absorbing faces; the free field has no joint there.
    JointAtBoundary {
        /// Name of the joint.
        joint: String,
        /// Number of its node pairs with a node on an absorbing face.
        pairs: usize,
    },
    /// An incident field that does not move the surface within the duration of the run.
    StillField {
        /// Duration of the run (s).
        duration: f64,
    },
    /// A number format whose error in this scene is unknown or above its documented value; found by [`check()`] alone.
    Format(FormatError),
    /// A scene without excitation: no incident field, load, weight or prescribed motion.
    NoExcitation,
}

impl Warning {
    /// The warning of a run that needs more memory (bytes) than the system can give, if it does and that is known.
    fn of_memory(needed: u64, available: Option<u64>) -> Option<Self> {
        let available = available.filter(|&available| needed > available)?;
        Some(Self::Memory { needed, available })
    }

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
            Self::Disconnected { parts, sets } => {
                write!(f, "the mesh has {parts} parts that share no nodes")?;
                for (number, (elements, names)) in sets.iter().take(SHOWN_PARTS).enumerate() {
                    let separator = if number == 0 { ": " } else { "; " };
                    let names: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
                    write!(f, "{separator}{elements} elements of {}", names.join(", "))?;
                }
                if let more @ 1.. = sets.len().saturating_sub(SHOWN_PARTS) {
                    write!(f, "; {more} more")?;
                }
                f.write_str(" (a [[joint]] connects them: of law `tied` as if they were one)")
            }
            Self::Folder { reason } => f.write_str(reason),
            Self::Memory { needed, available } => write!(
                f,
                "the run takes about {:.2} GB of memory, and {:.2} GB are available: the system may end it. Record fewer histories or less often, or give a coarser mesh or another machine",
                *needed as f64 / 1e9,
                *available as f64 / 1e9
            ),
            Self::Unbalanced { stage, share } => write!(
                f,
                "the in-situ stress leaves an unbalanced force of {:.1} % of the load at the start of stage '{stage}': stress, density, gravity, surface loads and supports are inconsistent, and the body moves until they agree (in a mesh that is hollow from the start the force is that of its opening)",
                100.0 * share
            ),
            Self::Tetrahedra { set } => write!(
                f,
                "'{set}' has four-node tetrahedra: too stiff in bending, and they lock in plastic flow; `order = 2` of [mesh] gives them nodes on their edges, with which they do neither"
            ),
            Self::IllPosed {
                set,
                growth,
                s_speed,
                takes_high,
            } => write!(
                f,
                "part '{set}' flows with a dilation far below its friction, and nothing damps its high frequencies: in compression waves of wave number k then grow as exp(k t {growth:.0} m/s), {:.2} of the speed of S waves, the shorter the faster. Accelerations of what flows are noise of the mesh, at any time step. Ways out: {}a `dilation` of two thirds of the friction or more, or law = \"drucker-prager\", which change strength and volume where flow is confined",
                growth / s_speed,
                if *takes_high {
                    "`damping = { kind = \"high\", ratio = 0.05 }`, or `high = 0.05` in flat damping, which takes 5 % of the stable step; "
                } else {
                    ""
                }
            ),
            Self::Ringing {
                set,
                tetrahedra,
                elements,
            } => write!(
                f,
                "{tetrahedra} of the {elements} elements of '{set}', which carries the waves from the absorbing faces, are tetrahedra with nodes on their edges, whose uneven masses ring: a P pulse as long as 28 nodes leaves 8 % of its amplitude in the ground, in equal bricks 1.4 % and in irregular ones 4 %. Mesh with bricks or wedges, or halve the size of the tetrahedra"
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

/// Requested factors on the step for which a check lists what fibres would do, and least gain that it lists.
const FACTORS: [f64; 3] = [1.5, 2.0, 3.0];
const LEAST_GAIN: f64 = 1.05;
/// Number of parts of a disconnected mesh that a warning names.
const SHOWN_PARTS: usize = 5;

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
    /// Length of the list of nodes of all elements.
    pub element_nodes: usize,
    /// Lower and upper corner of the box of the mesh (m).
    pub extent: (Vec3, Vec3),
    /// Boxes of the sets of elements, facets and nodes.
    pub sets: Vec<SetExtent>,
    /// Quality of the elements.
    pub quality: QualityReport,
    /// Highest frequency that each part resolves.
    pub resolution: Vec<Resolution>,
    /// Geometry and law of each joint.
    pub joints: Vec<JointOverview>,
    /// Sections whose forces are recorded: areas, extents and pieces.
    pub sections: Vec<SectionGeometry>,
    /// Construction stages before the run.
    pub stages: Vec<StageOverview>,
    /// Stable time step of the dynamic model and the element that limits it.
    pub stable: StableStep,
    /// Predicted cost of the run, its stages and its free-field check.
    pub cost: Cost,
    /// All remarks of the scene's preparation, facts and warnings.
    pub remarks: Vec<Remark>,
    /// Warnings about the accuracy of the results, including the remarks that are warnings.
    pub warnings: Vec<Warning>,
    /// Error of the scene's number format against double precision; `None` for double precision.
    pub format: Option<FormatError>,
    /// The at most three changes that save most wall time, a tenth at least each, the best first.
    pub savings: Vec<Saving>,
    /// What fibres would do to the step for each of some requested factors, and by how much they lower frequencies; empty
    /// where they hardly help or cannot be had.
    pub fibres: Vec<FibreChoice>,
    /// Changes of kernel, number format or damping with which the scene is refused, and why; how much they would save is
    /// unknown.
    pub refused: Vec<RefusedChange>,
}

/// Checks a scene before its run: mesh quality, resolved frequencies, stable step, and predicted cost of its stages
/// and its run. Some steps, and the first corrections of the stages, are computed and timed.
///
/// # Errors
/// Any error that would prevent the run; a stage that does not reach static equilibrium within the timed
/// corrections.
pub fn check(scene: impl Into<FileScene>) -> Result<CheckReport, StudyError> {
    check_within(scene.into(), available_memory)
}

/// The check with a source of the memory that the system can give (bytes).
fn check_within(
    scene: FileScene,
    available: impl Fn() -> Option<u64>,
) -> Result<CheckReport, StudyError> {
    let mesh = scene.mesh().clone();
    let quality = mesh.check().map_err(Error::from)?;
    let resolution = scene.resolution()?;
    let joints = JointOverview::all(&scene);
    let stages = scene.stage_overviews()?;
    let mut warnings = warnings_of(&scene, &quality, &resolution)?;
    let (model, plans) = (cost::CostModel::of(&scene)?, StagePlans::of(&scene)?);
    let survey = Survey::of(&scene, &resolution)?;
    let free_field = match scene.self_check() {
        Some(_) => Some(FreeFieldCheck::of(&scene)?),
        None => None,
    };
    if let Err(error) = ResultFolder::new(scene.result_folder()).check_writable() {
        let reason = error.to_string();
        warnings.push(Warning::Folder { reason });
    }
    let measures_format = FormatError::is_measured(&scene);
    let has_stress = scene.in_situ_stress().is_some();
    let options = scene.fibres().cloned();
    let may_help = options.is_some() || scene.has_thin_limits();
    let scene = if may_help {
        scene.map(|scene| scene.with_price_of_fibres())
    } else {
        scene
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
    let fibres = if may_help {
        prices_of_fibres(&mut simulation, options)
    } else {
        Vec::new()
    };
    let self_check = match free_field {
        Some(check) => Some(check.wall_time(step)?),
        None => None,
    };
    let of_stages = static_cost::of(&simulation, &plans, model.memory_of_stages())?;
    let unbalanced = of_stages.as_ref().and_then(|cost| cost.unbalanced);
    if let (Some(share), Some(stage), true) = (unbalanced, stages.first(), has_stress) {
        let changes = stage.excavated + stage.cast > 0;
        if !changes && share > Results::BALANCED {
            let stage = stage.name.clone();
            warnings.push(Warning::Unbalanced { stage, share });
        }
    }
    let title = simulation.title().to_owned();
    let sections = simulation.section_geometry().to_vec();
    let mut clock = StepTimer::of(&mut simulation)?;
    let of_step = clock.time_of_step()?;
    let profile = clock.profile(of_step)?;
    let cost = Cost {
        steps,
        step,
        wall_time: of_step.mul_f64(steps as f64),
        profile,
        iterates: model.iterates(),
        stages: of_stages,
        self_check,
        memory: model.memory(steps),
        memory_of_mesh: model.memory_of_mesh(),
        memory_of_format: measures_format.then(|| model.memory_beside_mesh()),
        output: model.output(steps),
    };
    let of_stages = cost.stages.as_ref().map_or(0, |stages| stages.memory);
    let needed = cost.memory.max(of_stages);
    warnings.extend(Warning::of_memory(needed, available()));
    let room = SecondModel {
        needed: model.memory_in_double(),
        available: available(),
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
    } = survey.best((&stable, &resolution), (&mut clock, &timing), room);
    let severe = format.iter().filter(|format| format.needs_warning());
    warnings.extend(severe.cloned().map(Warning::Format));
    Ok(CheckReport {
        title,
        nodes: mesh.node_count(),
        elements: mesh.element_count(),
        element_nodes: cost::element_nodes(&mesh),
        extent: mesh.bounding_box(),
        sets: SetExtent::all(&mesh),
        quality,
        resolution,
        joints,
        sections,
        stages,
        stable,
        cost,
        remarks,
        warnings,
        format,
        savings,
        fibres,
        refused,
    })
}

/// What fibres would do for the factors of [`FACTORS`], in the sets of the scene's own or in all thin parts, without
/// those that hardly make the step longer.
fn prices_of_fibres(simulation: &mut Simulation, own: Option<FibreOptions>) -> Vec<FibreChoice> {
    let choices = FACTORS.map(|factor| {
        let options = FibreOptions {
            factor,
            ..own.clone().unwrap_or_else(|| FibreOptions::new(factor))
        };
        // Engines, ranks and devices that compute without fibres have no price.
        simulation.choose_fibres(&options).ok()
    });
    let choices = choices.into_iter().flatten();
    choices
        .filter(|choice| choice.gain() > LEAST_GAIN)
        .collect()
}

/// Warnings about a scene that follow from its description alone: quality of elements, unresolved motion, joints,
/// missing excitation. Those found when the scene is prepared are in [`powerhouse::Simulation::remarks`].
///
/// # Errors
/// An invalid mesh or set.
pub fn warnings(scene: &Scene) -> Result<Vec<Warning>, StudyError> {
    let quality = scene.mesh().check().map_err(Error::from)?;
    warnings_of(scene, &quality, &scene.resolution()?)
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
            sets: separate_parts(scene.mesh()),
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
    for part in scene.parts() {
        let medium = part.material.medium();
        let is_damped = part.high > 0.0 || part.damping.rayleigh().stiffness > 0.0;
        let growth = if is_damped {
            None
        } else {
            part.material.growth_of_flow()
        };
        if let Some(growth) = growth.filter(|growth| *growth > GROWS * medium.s_speed()) {
            warnings.push(Warning::IllPosed {
                set: part.set.clone(),
                growth,
                s_speed: medium.s_speed(),
                takes_high: scene.delayed_sides().is_none(),
            });
        }
    }
    for index in scene.parts_behind_boundary()? {
        let set = &scene.parts()[index].set;
        let elements = scene.mesh().element_set(set).map_err(Error::from)?;
        let kinds = elements.iter().map(|&e| scene.mesh().kind(e));
        let tetrahedra = kinds.filter(|kind| *kind == ElementKind::Tet10).count();
        if tetrahedra > 0 {
            warnings.push(Warning::Ringing {
                set: set.clone(),
                tetrahedra,
                elements: elements.len(),
            });
        }
    }
    Ok(warnings)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use powerhouse::Registry;

    use super::*;

    /// Without memory for a second model a check compares with none: changes are refused, and the error of the number
    /// format is not measured.
    #[test]
    fn a_check_takes_the_memory_that_there_is() {
        let text = include_str!("../../../data/scenes/cavern_small.toml");
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/cavern_small.toml");
        let text = format!("precision = \"mixed\"\n{text}");
        let scene = || FileScene::from_toml(&text, &file, &Registry::default()).unwrap();
        let poor = check_within(scene(), || Some(1000)).unwrap();
        assert!(!poor.refused.is_empty());
        for change in &poor.refused {
            assert!(change.reason.contains("does not fit into"), "{change}");
        }
        let format = poor.format.unwrap();
        assert!(format.error.share.is_none() && format.needs_warning());
        assert!(poor.cost.memory_of_format.is_some());
        let rich = check_within(scene(), || None).unwrap();
        assert!(rich.refused.is_empty(), "{:?}", rich.refused);
        assert!(rich.format.unwrap().error.share.is_some());
    }

    /// A run that needs more memory than there is has a warning with both figures and what may help; one that needs less,
    /// or of a system that does not report it, has none.
    #[test]
    fn a_lack_of_memory_is_predicted() {
        let warning = Warning::of_memory(7_500_000_001, Some(7_500_000_000)).unwrap();
        let text = warning.to_string();
        assert!(
            text.contains("about 7.50 GB of memory, and 7.50 GB are available"),
            "{text}"
        );
        assert!(text.contains("Record fewer histories"), "{text}");
        assert!(Warning::of_memory(7_500_000_000, Some(7_500_000_000)).is_none());
        assert!(Warning::of_memory(u64::MAX, None).is_none());
    }
}
