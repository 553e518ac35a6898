//! Summary file of a run.

use powerhouse_model::{Ended, Mesh, StageReport};
use powerhouse_observe::{JointOutcome, JointTable, PeakRow, PeakTable};
use serde::Serialize;

use super::{BoltForces, Results, SectionUse};
use crate::message::{Message, RunNotes};

/// Content of `summary.json`.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    title: String,
    software: String,
    nodes: usize,
    elements: usize,
    ended: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<String>,
    /// What limited the step of a run that failed, and what may help
    #[serde(skip_serializing_if = "Vec::is_empty")]
    advice: Vec<String>,
    steps: u64,
    /// Device that took steps beside the host
    #[serde(skip_serializing_if = "Option::is_none")]
    device: Option<Device>,
    /// s
    step: f64,
    /// s
    end_time: f64,
    /// s
    wall_time: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    stable_step: Option<StableStepSummary>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stages: Vec<Stage>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hand_over: Option<HandOver>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    bolts: Vec<Bolts>,
    peaks: Vec<Peak>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    section_uses: Vec<Utilisation>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    joints: Vec<Joint>,
    /// J, at the last sample; terms that were ever nonzero
    energies: Vec<Energy>,
    #[serde(skip_serializing_if = "Option::is_none")]
    energy_residual: Option<Residual>,
    /// Warnings about the results, to be shown with them
    warnings: Vec<Message>,
    /// Facts about the composition of the scene
    remarks: Vec<String>,
    /// Whether laws or joints have history variables, so that results depend on the load path
    path_dependent: bool,
    /// Paths relative to the folder, without the summary
    #[serde(skip_serializing_if = "Vec::is_empty")]
    files: Vec<String>,
}

/// State of a run whose files are not all written.
const INCOMPLETE: &str = "incomplete";
/// State of a run that was interrupted.
const STOPPED: &str = "stopped";
/// State of a run that failed.
const FAILED: &str = "failed";

/// Name and version of this software.
fn software() -> String {
    format!("powerhouse {}", env!("CARGO_PKG_VERSION"))
}

/// Content of `summary.json` while the run goes on, and of one that ended before the motion.
#[derive(Debug, Serialize)]
pub(super) struct Begun {
    title: String,
    software: String,
    ended: &'static str,
    failure: String,
    /// Stages that were completed
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stages: Vec<Stage>,
    /// Paths of their files relative to the folder
    #[serde(skip_serializing_if = "Vec::is_empty")]
    files: Vec<String>,
}

impl Begun {
    /// Summary of a run of a title that has begun.
    pub(super) fn new(title: &str) -> Self {
        Self {
            title: title.into(),
            software: software(),
            ended: INCOMPLETE,
            failure: "the run goes on, or was ended from outside; the tables hold what it computed until then".into(),
            stages: Vec::new(),
            files: Vec::new(),
        }
    }

    /// The same with the stages that were completed, and their files.
    pub(super) fn with_stages(mut self, stages: &[StageReport], files: Vec<String>) -> Self {
        (self.stages, self.files) = (stages.iter().map(Stage::new).collect(), files);
        self
    }

    /// Summary of a run of a title that was interrupted in a stage.
    pub(super) fn stopped(title: &str, stage: &str) -> Self {
        Self {
            ended: STOPPED,
            failure: format!("interrupted in the stage '{stage}', before the motion"),
            ..Self::new(title)
        }
    }

    /// Summary of a run of a title that failed before the motion.
    pub(super) fn failed(title: &str, error: &str) -> Self {
        Self {
            ended: FAILED,
            failure: error.into(),
            ..Self::new(title)
        }
    }
}

/// Device that took steps beside the host.
#[derive(Debug, Serialize)]
struct Device {
    name: String,
    steps: u64,
}

#[derive(Debug, Serialize)]
struct StableStepSummary {
    /// s
    step: f64,
    /// s
    assembled_limit: f64,
    element: u64,
    set: String,
    term: &'static str,
}

/// Changes and solution of a construction stage.
#[derive(Debug, Serialize)]
struct Stage {
    name: String,
    excavated: usize,
    cast: usize,
    increments: u32,
    corrections: u32,
    /// Unbalanced force over the load
    residual: f64,
    /// m
    largest_displacement: f64,
    node: u64,
}

#[derive(Debug, Serialize)]
struct HandOver {
    /// N, norm of the carried forces
    standing: f64,
    /// Over the internal forces
    difference: f64,
}

#[derive(Debug, Serialize)]
struct Bolts {
    name: String,
    bolts: usize,
    /// N, at the end
    greatest_force: f64,
    /// Number of the bolt with this force, from one
    bolt: usize,
    /// N, in the run
    #[serde(skip_serializing_if = "Option::is_none")]
    greatest_of_run: Option<f64>,
    /// s
    #[serde(skip_serializing_if = "Option::is_none")]
    time: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bolt_of_run: Option<usize>,
}

#[derive(Debug, Serialize)]
struct Peak {
    name: String,
    unit: &'static str,
    value: f64,
    /// s
    time: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<String>,
    /// Whether the value is of the size of rounding errors compared with others of its unit
    #[serde(skip_serializing_if = "core::ops::Not::not")]
    below_rounding: bool,
}

/// Greatest utilisation of a reinforced section
#[derive(Debug, Serialize)]
struct Utilisation {
    section: String,
    /// Of the moment borne with the same normal force; none where no moment is borne
    #[serde(skip_serializing_if = "Option::is_none")]
    utilisation: Option<f64>,
    /// s
    time: f64,
    /// N/m, tension positive
    axial: f64,
    /// N m/m
    moment: f64,
    /// N m/m, borne with that normal force
    #[serde(skip_serializing_if = "Option::is_none")]
    borne: Option<[f64; 2]>,
    /// m
    thickness: f64,
    /// s, first time above one
    #[serde(skip_serializing_if = "Option::is_none")]
    beyond_from: Option<f64>,
}

impl Utilisation {
    fn new(of: SectionUse) -> Self {
        Self {
            utilisation: Some(of.utilisation).filter(|share| share.is_finite()),
            time: of.time,
            axial: of.axial,
            moment: of.moment,
            borne: of.capacity.moments(of.axial),
            thickness: of.capacity.thickness(),
            beyond_from: of.beyond_from,
            section: of.section,
        }
    }
}

#[derive(Debug, Serialize)]
struct Joint {
    name: String,
    joint: String,
    pairs: usize,
    /// m2
    area: f64,
    /// s
    #[serde(skip_serializing_if = "Option::is_none")]
    first_slip: Option<f64>,
    /// Number of the pair's node on the first side
    #[serde(skip_serializing_if = "Option::is_none")]
    first_slip_node: Option<u64>,
    /// s
    #[serde(skip_serializing_if = "Option::is_none")]
    first_crack: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    first_crack_node: Option<u64>,
    /// Share of the area
    slipped: f64,
    /// Share of the area
    opened: f64,
    /// Share of the area
    never_bonded: f64,
    /// Share of the area
    broken: f64,
    /// Reference configuration of slip, opening and energies, if not that of zero displacement
    #[serde(skip_serializing_if = "Option::is_none")]
    counted_from: Option<&'static str>,
    /// m
    slip: f64,
    slip_node: u64,
    /// m
    peak_opening: f64,
    peak_opening_node: u64,
    /// J
    friction: f64,
    /// J
    bond: f64,
    /// J
    impact: f64,
    /// Of pairs with common nodes
    most_sweeps: u32,
    /// Change of motion in the last sweep
    worst_residual: f64,
}

#[derive(Debug, Serialize)]
struct Energy {
    name: String,
    value: f64,
}

#[derive(Debug, Serialize)]
struct Residual {
    /// J, at the last sample
    energy: f64,
    /// Over the input work
    #[serde(skip_serializing_if = "Option::is_none")]
    share_of_input: Option<f64>,
    /// Of the run, over the largest energy until then
    largest: f64,
}

impl Summary {
    /// Marks the summary as incomplete for a reason; returns the previous end state and failure.
    pub(super) fn interrupt(&mut self, reason: &str) -> (String, Option<String>) {
        let ended = core::mem::replace(&mut self.ended, INCOMPLETE.into());
        (ended, self.failure.replace(reason.into()))
    }

    /// Sets the end state and failure of the run, and its files.
    pub(super) fn complete(&mut self, ended: (String, Option<String>), files: Vec<String>) {
        (self.ended, self.failure) = ended;
        self.files = files;
    }

    pub(super) fn new(title: &str, mesh: &Mesh, results: &Results, notes: &RunNotes) -> Self {
        let run = &results.run;
        Self {
            title: title.into(),
            software: software(),
            nodes: mesh.node_count(),
            elements: mesh.element_count(),
            ended: match &run.ended {
                Ended::Completed => "completed".into(),
                Ended::Stopped => STOPPED.into(),
                Ended::Observer(name) => format!("by observer {name}"),
                Ended::Failed(_) => FAILED.into(),
            },
            failure: match &run.ended {
                Ended::Failed(error) => Some(error.clone()),
                _ => None,
            },
            advice: results.advice.clone(),
            steps: run.steps,
            device: run.device.as_ref().map(|device| Device {
                name: device.name.clone(),
                steps: device.steps,
            }),
            step: run.step,
            end_time: run.time,
            wall_time: results.wall_time.as_secs_f64(),
            stable_step: run.stable.as_ref().map(|stable| StableStepSummary {
                step: stable.step,
                assembled_limit: stable.assembled_limit,
                element: stable.element,
                set: stable.set.clone(),
                term: stable.term.name(),
            }),
            stages: results.stages.iter().map(Stage::new).collect(),
            hand_over: results.hand_over.as_ref().map(|report| HandOver {
                standing: report.carried_forces,
                difference: report.difference,
            }),
            bolts: results.bolts.iter().filter_map(Bolts::new).collect(),
            peaks: Peak::all(&results.peaks(mesh)),
            section_uses: (results.section_uses().into_iter())
                .map(Utilisation::new)
                .collect(),
            joints: (results.joint_outcomes.iter())
                .map(|outcome| Joint::new(mesh, outcome, &results.joints))
                .collect(),
            energies: results
                .energy_terms()
                .into_iter()
                .map(|(name, value)| Energy {
                    name: name.into(),
                    value,
                })
                .collect(),
            energy_residual: results.energy_residual().map(|residual| Residual {
                energy: residual.energy,
                share_of_input: residual.share_of_input,
                largest: residual.largest,
            }),
            warnings: notes.all_warnings(&results.warnings(mesh)),
            remarks: notes.facts(),
            path_dependent: results.state.is_some() || !results.joints.is_empty(),
            files: Vec::new(),
        }
    }
}

impl Stage {
    fn new(report: &StageReport) -> Self {
        Self {
            name: report.name.clone(),
            excavated: report.excavated,
            cast: report.cast,
            increments: report.solution.increments,
            corrections: report.solution.corrections,
            residual: report.solution.residual,
            largest_displacement: report.largest_displacement.0,
            node: report.largest_displacement.1,
        }
    }
}

impl Bolts {
    fn new(forces: &BoltForces) -> Option<Self> {
        let (bolt, greatest_force) = forces.greatest()?;
        let of_run = forces.greatest_of_run();
        Some(Self {
            greatest_of_run: of_run.map(|(_, force, _)| force),
            time: of_run.map(|(.., time)| time),
            bolt_of_run: of_run.map(|(bolt, ..)| bolt + 1),
            name: forces.name.clone(),
            bolts: forces.bolts.last().map_or(0, |last| last + 1),
            greatest_force,
            bolt: bolt + 1,
        })
    }
}

impl Joint {
    fn new(mesh: &Mesh, outcome: &JointOutcome, joints: &[JointTable]) -> Self {
        let whole = joints.iter().find(|joint| joint.name == outcome.joint);
        let node = |pair: usize| {
            let node = whole
                .and_then(|joint| joint.pairs.get(pair))
                .map(|pair| pair.nodes[0]);
            node.map_or(0, |node| mesh.node_tags()[node as usize])
        };
        Self {
            most_sweeps: whole.map_or(0, |joint| joint.most_sweeps),
            worst_residual: whole.map_or(0.0, |joint| joint.worst_residual),
            name: outcome.name.clone(),
            joint: outcome.joint.clone(),
            pairs: outcome.pairs,
            area: outcome.area,
            first_slip: outcome.first_slip.map(|(time, _)| time),
            first_slip_node: outcome.first_slip.map(|(_, pair)| node(pair)),
            first_crack: outcome.first_crack.map(|(time, _)| time),
            first_crack_node: outcome.first_crack.map(|(_, pair)| node(pair)),
            slipped: outcome.slipped,
            opened: outcome.opened,
            never_bonded: outcome.never_bonded,
            broken: outcome.broken,
            counted_from: (whole.iter())
                .flat_map(|joint| &joint.records)
                .any(|record| record.closed_at.is_some())
                .then_some("where a stage closed the joint anew, see the remarks"),
            slip: outcome.slip.0,
            slip_node: node(outcome.slip.1),
            peak_opening: outcome.peak_opening.0,
            peak_opening_node: node(outcome.peak_opening.1),
            friction: outcome.friction,
            bond: outcome.bond,
            impact: outcome.impact,
        }
    }
}

impl Peak {
    fn all(peaks: &PeakTable) -> Vec<Self> {
        let peak = |row: &PeakRow| Self {
            name: row.name.clone(),
            unit: row.unit,
            value: row.value,
            time: row.time,
            place: row.place.map(|place| place.to_string()),
            below_rounding: peaks.is_rounding(row),
        };
        peaks.rows.iter().map(peak).collect()
    }
}
