//! Recorded output of a run.

use std::fmt;
use std::sync::LazyLock;
use std::time::Duration;

use powerhouse_contact::JointSurface;
use powerhouse_model::{HandOverReport, JointRecord, Mesh, RunReport, StageReport, Vec3};
use powerhouse_observe::{
    EnvelopeTable, HistoryTable, JointOutcome, JointTable, PeakTable, SectionCapacity,
    SectionGeometry, StateTable,
};

use super::{
    BoltForces, ResultList, ResultTable, RingRequest, SectionUse, bolts, capacity, energies,
    histories, joints, sections,
};
use crate::{FibreChoice, Resolution};

/// Table of what was not recorded.
static NONE: LazyLock<HistoryTable> = LazyLock::new(HistoryTable::default);

/// Recorded output and reports of a run.
///
/// Tables and envelopes are those of the dynamic run, which starts with the body as the construction stages left it:
/// displacements count from there, and the energy balance begins there; stresses, section forces, bolt forces and history
/// variables include what the stages left. What was not requested or does not exist is empty or `None`.
#[derive(Clone)]
#[non_exhaustive]
pub struct Results {
    /// Report of the dynamic run: number and length of steps, how the run ended, energy residual.
    pub run: RunReport,
    /// Wall time of [`Simulation::run`](crate::Simulation::run): with the construction stages, unless the run started
    /// from an equilibrated body, and with the snapshots written during the run.
    pub wall_time: Duration,
    /// Mean wall time of a step of the dynamic run, without stages and without the steps before a
    /// [resumed](crate::RunHooks::resume) run was interrupted; zero without steps.
    pub step_time: Duration,
    /// Tables against time, in the order in which they are written; those of the software by methods such as
    /// [`histories`](Self::histories).
    pub tables: Vec<ResultTable>,
    /// Tables that are not against time: forces of bolts and around linings, interaction diagrams.
    pub lists: Vec<ResultList>,
    /// Geometry of the sections, in the order of their requests: area, centroid, axes.
    pub section_geometry: Vec<SectionGeometry>,
    /// Names and capacities of the sections with a reinforcement.
    pub section_capacities: Vec<(String, SectionCapacity)>,
    /// Sections that go around linings.
    pub section_rings: Vec<RingRequest>,
    /// Envelopes of motions and principal stresses: greatest values over the sampled times.
    pub envelope: Option<EnvelopeTable>,
    /// Envelopes of the laws' history variables, at the end of the run at least; none if no law has any.
    pub state: Option<StateTable>,
    /// Final contact state and peak values of each joint, and of the requested zones of joints; slip, energies and first
    /// times count from the last re-initialisation of the joint, earlier stages included without one.
    pub joint_outcomes: Vec<JointOutcome>,
    /// Node pairs of each joint with their final states and peak values, which count as those of the outcomes.
    pub joints: Vec<JointTable>,
    /// Surfaces of the joints, in the order of [`joints`](Self::joints).
    pub joint_surfaces: Vec<JointSurface>,
    /// Which elements of the mesh are active in the dynamic run, one flag per element; none if all are.
    pub present: Option<Vec<bool>>,
    /// Box (lower and upper corner, m) of the parts that touch no absorbing face, such as a lining, of which pictures are drawn
    /// closer; none without an absorbing boundary or such parts.
    pub structure: Option<[Vec3; 2]>,
    /// Frequencies that the meshes of the parts resolve, and their damping reaches.
    pub resolution: Vec<Resolution>,
    /// Number of snapshots that the receiver has taken.
    pub snapshots: u64,
    /// Reports of the construction stages before the run, in their order; empty without stages.
    pub stages: Vec<StageReport>,
    /// Whether an in-situ stress was given before the first stage.
    pub in_situ_stress: bool,
    /// Report of the transfer from the stages to the dynamic run: reactions and residual forces that are carried on; none
    /// without stages.
    pub hand_over: Option<HandOverReport>,
    /// Axial forces of bolts (N) at the end of the run, and their greatest values over its samples.
    pub bolts: Vec<BoltForces>,
    /// Advice on a run that failed: what limited its time step, and what may help; empty otherwise.
    pub advice: Vec<String>,
    /// The fibres of the run; none without.
    pub fibres: Option<FibreChoice>,
}

/// Shows the report of the run only, so that an error with results is readable.
impl fmt::Debug for Results {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Results")
            .field("run", &self.run)
            .field("wall_time", &self.wall_time)
            .finish_non_exhaustive()
    }
}

impl Results {
    /// Largest unbalanced force over the load of the first stage (1) under a given in-situ stress without a warning.
    pub const BALANCED: f64 = 0.05;
    /// Largest energy that closing cracks give, over that which plastic flow and damage take (1), without a warning.
    pub const LARGE_RECOVERY: f64 = 0.5;
    /// The same of the error of the time integration of laws.
    pub const LARGE_INTEGRATION: f64 = 0.1;
    /// Largest slip or opening over the shortest edge of a joint's facets (1) that counts as small.
    pub const SMALL_SLIP: f64 = 0.1;
    /// [Share](Self::share_of_fibres) of the added inertia of fibres (1) up to which it counts as small.
    pub const LIGHT_FIBRES: f64 = 0.01;

    /// The table of a [name](super::TableForm::name); empty if there is none.
    pub fn table(&self, name: &str) -> &HistoryTable {
        let table = self.tables.iter().find(|table| table.form.name == name);
        table.map_or(&NONE, |table| &table.rows)
    }
    /// Motions, mean element stresses, history variables and relative displacements against time.
    pub fn histories(&self) -> &HistoryTable {
        self.table(histories::HISTORIES)
    }
    /// Accelerations of the histories up to the [band](super::OutputPlan::band), five rows to its period, from which peaks and
    /// spectra are; empty without accelerations, and of instants.
    pub fn accelerations(&self) -> &HistoryTable {
        self.table(histories::ACCELERATIONS)
    }
    /// Section forces, moments, and both per metre of width, against time, each column with its unit.
    pub fn sections(&self) -> &HistoryTable {
        self.table(sections::SECTIONS)
    }
    /// Columns of the energy balance (J) against time.
    pub fn energies(&self) -> &HistoryTable {
        self.table(energies::ENERGIES)
    }
    /// Joint histories: shares of area, greatest slips and openings, tractions and energies against time.
    pub fn joint_histories(&self) -> &HistoryTable {
        self.table(joints::JOINTS)
    }
    /// Greatest axial force (N, tension positive) of each bolt group against time, column `NAME.greatest`; the first row
    /// is the state after the stages.
    pub fn bolt_histories(&self) -> &HistoryTable {
        self.table(bolts::BOLTS)
    }

    /// Name of each joint and its largest accumulated slip or opening over the shortest edge of its facets (1).
    /// Pairs keep their nodes, so that a share above [`Results::SMALL_SLIP`] is no longer small.
    pub fn slip_shares(&self, mesh: &Mesh) -> Vec<(&str, f64)> {
        let largest = |table: &JointTable| {
            let of = |record: &JointRecord| record.state.slip.max(record.peak_opening);
            table.records.iter().map(of).fold(0.0, f64::max)
        };
        let joints = self.joints.iter().zip(&self.joint_surfaces);
        let share = |(table, surface): (&'_ JointTable, &JointSurface)| {
            largest(table) / surface.shortest_edge(mesh)
        };
        joints
            .map(|joint| (joint.0.name.as_str(), share(joint)))
            .collect()
    }
    /// Kinetic energy of the added inertia of fibres over that of their masses, from the largest of each at the readings
    /// of the energy balance (1): twice the relative error of the frequencies of their motion. None without fibres or
    /// readings.
    pub fn share_of_fibres(&self) -> Option<f64> {
        let [added, own] = self.run.fibre_energies;
        (self.fibres.is_some() && own > 0.0).then(|| added / own)
    }
    /// Greatest utilisation of each section with a reinforcement over the run.
    pub fn section_uses(&self) -> Vec<SectionUse> {
        capacity::uses(self.sections(), &self.section_capacities)
    }
    /// Table of the values of largest magnitude of all histories, section forces, bolts, joints (where not zero),
    /// envelopes and history variables.
    pub fn peaks(&self, mesh: &Mesh) -> PeakTable {
        let mut peaks = PeakTable::default();
        for table in &self.tables {
            table.add_peaks(&mut peaks);
        }
        if let Some(envelope) = &self.envelope {
            peaks.add_envelope("envelope", envelope, mesh);
        }
        if let Some(state) = &self.state {
            peaks.add_state(state, mesh);
        }
        peaks
    }
}
