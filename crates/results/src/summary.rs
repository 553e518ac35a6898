//! Summary file of a run, as it is written and read.

use powerhouse_model::{Ended, Mesh, StageReport};
use powerhouse_observe::{JointOutcome, JointTable, PeakRow, PeakTable};
use serde::{Deserialize, Deserializer, Serialize};

use powerhouse_scene::{BoltForces, Message, Resolution, Results, RunNotes, SectionUse};

pub use crate::fibre_summary::FibreSummary;

/// Content of `summary.json` of a run whose motion has begun.
///
/// A figure that is no finite number, as after a failure, is NaN.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RunSummary {
    /// Title.
    pub title: String,
    /// Name and version of the software.
    pub software: String,
    /// Number of nodes of the mesh.
    pub nodes: usize,
    /// Number of elements of the mesh.
    pub elements: usize,
    /// How the run ended: `completed`, `stopped`, `failed`, `by observer NAME`; `incomplete` while files are missing.
    pub ended: String,
    /// Why it failed or is incomplete.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// What limited the step of a run that failed, and what may help.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub advice: Vec<String>,
    /// Number of time steps.
    pub steps: u64,
    /// Device that took steps beside the host.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device: Option<Device>,
    /// Length of a step (s).
    pub step: f64,
    /// Time at the end (s).
    pub end_time: f64,
    /// Wall time of stages and motion (s).
    pub wall_time: f64,
    /// The stable step and what limits it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stable_step: Option<StableStepSummary>,
    /// Fibres of the run: added inertia of the motion across thin parts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fibres: Option<FibreSummary>,
    /// Construction stages.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<StageSummary>,
    /// Transfer from the last stage to the motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hand_over: Option<HandOver>,
    /// Bolt groups.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bolts: Vec<BoltSummary>,
    /// Peaks of all histories and envelopes.
    pub peaks: Vec<PeakSummary>,
    /// Frequencies up to which the parts carry waves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub resolution: Vec<ResolutionSummary>,
    /// Greatest utilisation of each reinforced section.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub section_uses: Vec<UtilisationSummary>,
    /// Joints and zones of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<JointSummary>,
    /// Energies (J) at the last sample; terms that were ever nonzero.
    pub energies: Vec<EnergySummary>,
    /// Residual of the energy balance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy_residual: Option<ResidualSummary>,
    /// Warnings about the results, to be shown with them.
    pub warnings: Vec<Message>,
    /// Facts about the composition of the scene.
    pub remarks: Vec<String>,
    /// Whether laws or joints have history variables, so that results depend on the load path.
    pub path_dependent: bool,
    /// Tables that may be there while not all files are written.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tables: Vec<String>,
    /// Paths relative to the folder, without the summary.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
}

/// Reads a number, of which JSON has no form if it is not finite: NaN then.
fn real<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct BegunSummary {
    /// Title.
    pub title: String,
    /// Name and version of the software.
    pub software: String,
    /// How the run ended: `stopped`, `failed`; `incomplete` while it goes on.
    pub ended: String,
    /// Why there are no results.
    pub failure: String,
    /// Stages that were completed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<StageSummary>,
    /// Tables that grow while the run goes on; without rows they are not there yet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tables: Vec<String>,
    /// Paths of their files relative to the folder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
}

impl BegunSummary {
    /// Summary of a run of a title that has begun.
    pub(crate) fn new(title: &str) -> Self {
        Self {
            title: title.into(),
            software: software(),
            ended: INCOMPLETE.into(),
            failure: "the run goes on, or was ended from outside; the tables hold what it computed until then".into(),
            stages: Vec::new(),
            tables: Vec::new(),
            files: Vec::new(),
        }
    }

    /// The same with the stages that were completed, and their files.
    pub(crate) fn with_stages(mut self, stages: &[StageReport], files: Vec<String>) -> Self {
        (self.stages, self.files) = (stages.iter().map(StageSummary::new).collect(), files);
        self
    }

    /// Summary of a run of a title that was interrupted in a stage.
    pub(crate) fn stopped(title: &str, stage: &str) -> Self {
        Self {
            ended: STOPPED.into(),
            failure: format!("interrupted in the stage '{stage}', before the motion"),
            ..Self::new(title)
        }
    }

    /// Summary of a run of a title that failed before the motion.
    pub(crate) fn failed(title: &str, error: &str) -> Self {
        Self {
            ended: FAILED.into(),
            failure: error.into(),
            ..Self::new(title)
        }
    }
}

/// Device that took steps beside the host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Device {
    /// Name.
    pub name: String,
    /// Number of its steps.
    pub steps: u64,
}

/// The stable step of a run and what limits it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct StableStepSummary {
    /// Stable step (s).
    pub step: f64,
    /// Stable step of the assembled body (s).
    pub assembled_limit: f64,
    /// Number of the element that limits it.
    pub element: u64,
    /// Set of the element.
    pub set: String,
    /// What limits it.
    pub term: String,
}

/// Changes and solution of a construction stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct StageSummary {
    /// Name.
    pub name: String,
    /// Number of excavated elements.
    pub excavated: usize,
    /// Number of cast elements.
    pub cast: usize,
    /// Number of load increments.
    pub increments: u32,
    /// Number of corrections.
    pub corrections: u32,
    /// Unbalanced force over the load.
    #[serde(deserialize_with = "real")]
    pub residual: f64,
    /// Largest displacement in the stage (m).
    #[serde(deserialize_with = "real")]
    pub largest_displacement: f64,
    /// Number of the node with this displacement.
    pub node: u64,
}

/// Transfer from the last stage to the motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct HandOver {
    /// Norm of the carried forces (N).
    #[serde(deserialize_with = "real")]
    pub standing: f64,
    /// Difference over the internal forces.
    #[serde(deserialize_with = "real")]
    pub difference: f64,
}

/// Forces of a bolt group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct BoltSummary {
    /// Name of the group.
    pub name: String,
    /// Number of bolts.
    pub bolts: usize,
    /// Greatest axial force (N) at the end.
    #[serde(deserialize_with = "real")]
    pub greatest_force: f64,
    /// Number of the bolt with this force, from one.
    pub bolt: usize,
    /// Greatest axial force (N) in the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub greatest_of_run: Option<f64>,
    /// Its time (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Number of the bolt with it, from one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bolt_of_run: Option<usize>,
}

/// Peak of a history or an envelope.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct PeakSummary {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Value with its sign.
    #[serde(deserialize_with = "real")]
    pub value: f64,
    /// Time (s).
    #[serde(deserialize_with = "real")]
    pub time: f64,
    /// Place in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// Whether the value is of the size of rounding errors compared with others of its unit.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub below_rounding: bool,
}

/// Frequencies up to which a part carries waves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ResolutionSummary {
    /// Element set of the part.
    pub set: String,
    /// Highest frequency (Hz) with ten elements per wavelength of S waves.
    #[serde(deserialize_with = "real")]
    pub frequency: f64,
    /// Highest frequency (Hz) of the band of its flat damping.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damped: Option<f64>,
}

impl ResolutionSummary {
    fn new(of: &Resolution) -> Self {
        Self {
            set: of.set.clone(),
            frequency: of.frequency,
            damped: of.damped,
        }
    }
}

/// Greatest utilisation of a reinforced section.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct UtilisationSummary {
    /// Name of the section.
    pub section: String,
    /// Share of the moment borne with the same normal force; none where no moment is borne.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub utilisation: Option<f64>,
    /// Time (s).
    #[serde(deserialize_with = "real")]
    pub time: f64,
    /// Normal force (N/m), tension positive.
    #[serde(deserialize_with = "real")]
    pub axial: f64,
    /// Moment (N m/m).
    #[serde(deserialize_with = "real")]
    pub moment: f64,
    /// Moments (N m/m) borne with that normal force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub borne: Option<[f64; 2]>,
    /// Thickness (m).
    #[serde(deserialize_with = "real")]
    pub thickness: f64,
    /// First time (s) above one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_from: Option<f64>,
}

impl UtilisationSummary {
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

/// Outcome of a joint or a zone of it; shares are those of its area.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct JointSummary {
    /// Name of the joint or the zone.
    pub name: String,
    /// Name of the joint.
    pub joint: String,
    /// Number of node pairs.
    pub pairs: usize,
    /// Area (m2).
    #[serde(deserialize_with = "real")]
    pub area: f64,
    /// Time (s) of the first slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_slip: Option<f64>,
    /// Number of the node on the first side of the pair that slid first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_slip_node: Option<u64>,
    /// Time (s) of the first crack.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_crack: Option<f64>,
    /// Number of the node on the first side of the pair that cracked first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_crack_node: Option<u64>,
    /// Share that slid.
    #[serde(deserialize_with = "real")]
    pub slipped: f64,
    /// Share that opened.
    #[serde(deserialize_with = "real")]
    pub opened: f64,
    /// Share that never was bonded.
    #[serde(deserialize_with = "real")]
    pub never_bonded: f64,
    /// Share whose bond is broken.
    #[serde(deserialize_with = "real")]
    pub broken: f64,
    /// Reference configuration of slip, opening and energies, if not that of zero displacement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counted_from: Option<String>,
    /// Largest slip (m).
    #[serde(deserialize_with = "real")]
    pub slip: f64,
    /// Number of its node.
    pub slip_node: u64,
    /// Largest opening (m).
    #[serde(deserialize_with = "real")]
    pub peak_opening: f64,
    /// Number of its node.
    pub peak_opening_node: u64,
    /// Work of friction (J).
    #[serde(deserialize_with = "real")]
    pub friction: f64,
    /// Work of breaking bonds (J).
    #[serde(deserialize_with = "real")]
    pub bond: f64,
    /// Energy lost in impacts (J).
    #[serde(deserialize_with = "real")]
    pub impact: f64,
    /// Greatest number of sweeps over pairs with common nodes.
    pub most_sweeps: u32,
    /// Change of motion in the last sweep.
    #[serde(deserialize_with = "real")]
    pub worst_residual: f64,
}

/// A term of the energy balance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct EnergySummary {
    /// Name.
    pub name: String,
    /// Energy (J).
    #[serde(deserialize_with = "real")]
    pub value: f64,
}

/// Residual of the energy balance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ResidualSummary {
    /// At the last sample (J).
    #[serde(deserialize_with = "real")]
    pub energy: f64,
    /// Over the input work.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share_of_input: Option<f64>,
    /// Largest of the run, over the largest energy until then.
    #[serde(deserialize_with = "real")]
    pub largest: f64,
}

impl RunSummary {
    /// Marks the summary as incomplete for a reason; returns the previous end state and failure.
    pub(crate) fn interrupt(&mut self, reason: &str) -> (String, Option<String>) {
        let ended = core::mem::replace(&mut self.ended, INCOMPLETE.into());
        (ended, self.failure.replace(reason.into()))
    }

    /// Sets the end state and failure of the run, and its files.
    pub(crate) fn complete(&mut self, ended: (String, Option<String>), files: Vec<String>) {
        (self.ended, self.failure) = ended;
        (self.tables, self.files) = (Vec::new(), files);
    }

    pub(crate) fn new(title: &str, mesh: &Mesh, results: &Results, notes: &RunNotes) -> Self {
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
                term: stable.term.name().into(),
            }),
            fibres: FibreSummary::of(results),
            stages: results.stages.iter().map(StageSummary::new).collect(),
            hand_over: results.hand_over.as_ref().map(|report| HandOver {
                standing: report.carried_forces,
                difference: report.difference,
            }),
            bolts: results.bolts.iter().filter_map(BoltSummary::new).collect(),
            peaks: PeakSummary::all(&results.peaks(mesh)),
            resolution: results
                .resolution
                .iter()
                .map(ResolutionSummary::new)
                .collect(),
            section_uses: (results.section_uses().into_iter())
                .map(UtilisationSummary::new)
                .collect(),
            joints: (results.joint_outcomes.iter())
                .map(|outcome| JointSummary::new(mesh, outcome, &results.joints))
                .collect(),
            energies: results
                .energy_terms()
                .into_iter()
                .map(|(name, value)| EnergySummary {
                    name: name.into(),
                    value,
                })
                .collect(),
            energy_residual: results.energy_residual().map(|residual| ResidualSummary {
                energy: residual.energy,
                share_of_input: residual.share_of_input,
                largest: residual.largest,
            }),
            warnings: notes.all_warnings(&results.warnings(mesh)),
            remarks: notes.facts(),
            path_dependent: results.state.is_some() || !results.joints.is_empty(),
            tables: (results.tables.iter())
                .map(|table| table.form.file())
                .collect(),
            files: Vec::new(),
        }
    }
}

impl StageSummary {
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

impl BoltSummary {
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

impl JointSummary {
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
                .then(|| "where a stage closed the joint anew, see the remarks".into()),
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

impl PeakSummary {
    fn all(peaks: &PeakTable) -> Vec<Self> {
        let peak = |row: &PeakRow| Self {
            name: row.name.clone(),
            unit: row.unit.into(),
            value: row.value,
            time: row.time,
            place: row.place.map(|place| place.to_string()),
            below_rounding: peaks.is_rounding(row),
        };
        peaks.rows.iter().map(peak).collect()
    }
}
