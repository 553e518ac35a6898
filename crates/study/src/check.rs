//! What can be said of a scene without running it.

use core::fmt;
use std::time::Duration;

use powerhouse::engine::StableStep;
use powerhouse::model::{ElementKind, QualityReport};
use powerhouse::{Error, Remark, Scene};

use crate::StudyError;
use crate::cost::{self, Cost};

/// Elements per wavelength that a mesh should have for waves to travel without visible dispersion.
const PER_WAVELENGTH: f64 = 10.0;
/// Above this ratio of longest to shortest edge waves travel at different speeds along and across.
const LARGEST_ASPECT: f64 = 10.0;
/// Below this scaled Jacobian an element is badly distorted.
const LEAST_JACOBIAN: f64 = 0.2;
/// A warning is due if more than this share of a record's energy lies above what a set carries.
const LOST_SHARE: f64 = 0.01;

/// The highest frequency that a part carries, with ten elements per wavelength of shear waves.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolution {
    /// The part's set.
    pub set: String,
    /// Speed of shear waves (m/s).
    pub s_speed: f64,
    /// Longest edge (m).
    pub longest_edge: f64,
    /// `s_speed / (10 longest_edge)` (Hz).
    pub frequency: f64,
}

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
    /// A record with motion that a part cannot carry.
    Unresolved {
        /// The record's name.
        record: String,
        /// The part's set.
        set: String,
        /// Share of the record's energy (of acceleration) above the part's frequency.
        share: f64,
        /// That frequency (Hz).
        frequency: f64,
    },
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
            Self::Unresolved {
                record,
                set,
                share,
                frequency,
            } => write!(
                f,
                "{:.1} % of the energy of record '{record}' lies above {frequency:.1} Hz, which is all that '{set}' carries",
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
    /// The stable step and who limits it.
    pub stable: StableStep,
    /// What a run will cost.
    pub cost: Cost,
    /// Facts of the scene's composition.
    pub remarks: Vec<Remark>,
    /// Doubts.
    pub warnings: Vec<Warning>,
}

/// Steps taken before the clock starts, and steps that are timed; more until the clock is sure.
const WARM_UP: u64 = 5;
/// The clock runs at least so long.
const LEAST_CLOCK: Duration = Duration::from_millis(500);

/// Looks at a scene: mesh, frequencies, stable step, and what a run will cost. Some steps are
/// computed to see how long they take.
///
/// # Errors
/// What would keep the scene from running.
pub fn check(scene: Scene) -> Result<CheckReport, StudyError> {
    let mesh = scene.mesh().clone();
    let quality = mesh.check().map_err(Error::from)?;
    let resolution = resolution(&scene)?;
    let mut warnings = shape_warnings(&scene, &quality)?;
    warnings.extend(unresolved(&scene, &resolution));
    let output = cost::output(scene.output_plan(), &mesh, scene.run_duration());

    let mut simulation = scene.prepare()?;
    let remarks = simulation.remarks().to_vec();
    let doubts = remarks.iter().filter(|remark| remark.is_warning());
    warnings.extend(doubts.cloned().map(Warning::Remark));
    let stable = simulation.stable_step()?;
    let step = simulation.step()?;
    let steps = (simulation.duration() / step).ceil() as u64 + 1;
    let cost = Cost {
        steps,
        step,
        wall_time: time_of_step(&mut simulation)?.mul_f64(steps as f64),
        memory: cost::memory(&mesh),
        output,
    };
    Ok(CheckReport {
        title: simulation.title().to_owned(),
        nodes: mesh.node_count(),
        elements: mesh.element_count(),
        quality,
        resolution,
        stable,
        cost,
        remarks,
        warnings,
    })
}

fn time_of_step(simulation: &mut powerhouse::Simulation) -> Result<Duration, StudyError> {
    simulation.time_steps(WARM_UP)?;
    let mut count = WARM_UP;
    loop {
        let taken = simulation.time_steps(count)?;
        if taken >= LEAST_CLOCK {
            return Ok(taken.div_f64(count as f64));
        }
        count *= 2;
    }
}

fn resolution(scene: &Scene) -> Result<Vec<Resolution>, StudyError> {
    let mesh = scene.mesh();
    scene
        .parts()
        .iter()
        .map(|part| {
            let elements = mesh.element_set(&part.set).map_err(Error::from)?;
            let longest_edge = elements
                .iter()
                .map(|&e| longest_edge(mesh, e))
                .fold(0.0, f64::max);
            let s_speed = part.material.medium().s_speed();
            Ok(Resolution {
                set: part.set.clone(),
                s_speed,
                longest_edge,
                frequency: s_speed / (PER_WAVELENGTH * longest_edge),
            })
        })
        .collect()
}

/// The longest edge of an element (m).
fn longest_edge(mesh: &powerhouse::model::Mesh, element: u32) -> f64 {
    let nodes = mesh.nodes_of(element);
    let at = |i: u8| mesh.positions()[nodes[i as usize] as usize];
    let sides = mesh.kind(element).sides();
    let edges = sides.iter().flat_map(|side| {
        (0..side.len()).map(|i| (at(side[i]) - at(side[(i + 1) % side.len()])).norm())
    });
    edges.fold(0.0, f64::max)
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
    if quality.parts > 1 {
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

/// Records with more motion above a part's frequency than is permitted.
fn unresolved(scene: &Scene, resolution: &[Resolution]) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (name, history) in scene.records() {
        let spectrum = history.fourier_spectrum();
        let energy = |from: f64| -> f64 {
            let above = spectrum.iter().filter(|line| line.frequency >= from);
            above.map(|line| line.amplitude * line.amplitude).sum()
        };
        for part in resolution {
            let share = energy(part.frequency) / energy(0.0);
            if share > LOST_SHARE {
                warnings.push(Warning::Unresolved {
                    record: name.clone(),
                    set: part.set.clone(),
                    share,
                    frequency: part.frequency,
                });
            }
        }
    }
    warnings
}
