//! Recorded output of a run.

use std::cell::RefCell;
use std::fmt;
use std::time::Duration;

use powerhouse_contact::JointSurface;
use powerhouse_elements::BoltSet;
use powerhouse_model::{
    Cadence, HandOverReport, JointRecord, Mesh, ModelError, Observer, RunReport, StageReport, Vec3,
};
use powerhouse_observe::{
    BoltHistories, BoltTables, Column, EnergyHistory, Envelope, EnvelopeTable, History,
    HistoryTable, JointHistories, JointOutcome, JointQuantities, JointTable, JointTables,
    JointWatch, Motion, PeakTable, Recording, SectionCapacity, SectionForces, SectionGeometry,
    StateTable, StressPlace,
};

use super::{
    BoltForces, EnergyResidual, JointRequest, OutputPlan, RingRequest, SectionUse, StateVariables,
};
use super::{RunTable, capacity, sections};
use crate::joint::NamedSurface;
use crate::{Error, FibreChoice, Remark, Resolution, remark};

/// Column of the residual in the energy balance.
const RESIDUAL: &str = "residual";
/// Columns of external work in the energy balance.
const INPUTS: [&str; 2] = ["loads", "prescribed motion"];

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
    /// Motions, mean element stresses, history variables and relative displacements against time.
    pub histories: HistoryTable,
    /// Accelerations of the histories up to the [band](OutputPlan::band), five rows to its period, from which peaks and spectra
    /// are; empty without accelerations, and of instants.
    pub accelerations: HistoryTable,
    /// Section forces, moments, and both per metre of width, against time, each column with its unit.
    pub sections: HistoryTable,
    /// Geometry of the sections, in the order of their requests: area, centroid, axes.
    pub section_geometry: Vec<SectionGeometry>,
    /// Names and capacities of the sections with a reinforcement.
    pub section_capacities: Vec<(String, SectionCapacity)>,
    /// Sections that go around linings.
    pub section_rings: Vec<RingRequest>,
    /// Columns of the energy balance (J) against time.
    pub energies: HistoryTable,
    /// Envelopes of motions and principal stresses: greatest values over the sampled times.
    pub envelope: Option<EnvelopeTable>,
    /// Envelopes of the laws' history variables, at the end of the run at least; none if no law has any.
    pub state: Option<StateTable>,
    /// Joint histories: shares of area, greatest slips and openings, tractions and energies against time.
    pub joint_histories: HistoryTable,
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
    /// Greatest axial force (N, tension positive) of each bolt group against time, column `NAME.greatest`; the first row
    /// is the state after the stages.
    pub bolt_histories: HistoryTable,
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

    /// Names and final values (J) of the energies that were ever other than zero, the residual left out; empty if energies
    /// were not recorded.
    pub fn energy_terms(&self) -> Vec<(&str, f64)> {
        let columns = self.energies.columns.iter();
        columns
            .filter(|column| column.name != RESIDUAL && column.values.iter().any(|v| *v != 0.0))
            .filter_map(|column| Some((column.name.as_str(), *column.values.last()?)))
            .collect()
    }
    /// Residual of the energy balance; `None` if energies were not recorded.
    pub fn energy_residual(&self) -> Option<EnergyResidual> {
        let last = |name| self.energies.column(name)?.values.last().copied();
        let energy = last(RESIDUAL)?;
        let input: f64 = INPUTS.iter().filter_map(|name| last(name)).sum();
        let largest = self.run.energy_residual;
        let share = || match largest {
            // The input may be rounding, too.
            0.0 => 0.0,
            _ => (energy / input).abs(),
        };
        Some(EnergyResidual {
            energy,
            share_of_input: (input != 0.0).then(share),
            largest,
        })
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
        capacity::uses(&self.sections, &self.section_capacities)
    }
    /// Table of the values of largest magnitude of all histories, section forces, bolts, joints (where not zero),
    /// envelopes and history variables.
    pub fn peaks(&self, mesh: &Mesh) -> PeakTable {
        let mut peaks = PeakTable::default();
        peaks.add_history(&self.histories);
        // Of accelerations those of the band, whatever the interval of the histories.
        let mut of_band = PeakTable::default();
        of_band.add_history(&self.accelerations);
        for row in of_band.rows {
            if let Some(known) = peaks.rows.iter_mut().find(|known| known.name == row.name) {
                *known = row;
            }
        }
        peaks.add_instants(&self.histories);
        peaks.add_history(&self.sections);
        peaks.add_history(&self.bolt_histories);
        // Zero peaks of joints are left out.
        let mut of_joints = self.joint_histories.clone();
        let moves = |column: &Column| column.values.iter().any(|value| *value != 0.0);
        of_joints.columns.retain(moves);
        peaks.add_history(&of_joints);
        if let Some(envelope) = &self.envelope {
            peaks.add_envelope("envelope", envelope, mesh);
        }
        if let Some(state) = &self.state {
            peaks.add_state(state, mesh);
        }
        peaks
    }
}

/// Recordings of the observers of an output plan.
pub(crate) struct Recordings {
    histories: Option<Recording<HistoryTable>>,
    accelerations: Option<Recording<HistoryTable>>,
    sections: Option<Recording<HistoryTable>>,
    section_geometry: Vec<SectionGeometry>,
    section_capacities: Vec<(String, SectionCapacity)>,
    section_rings: Vec<RingRequest>,
    energies: Option<Recording<HistoryTable>>,
    envelope: Option<Recording<EnvelopeTable>>,
    state: Option<Recording<StateTable>>,
    joints: Option<Recording<JointTables>>,
    joint_surfaces: Vec<NamedSurface>,
    bolts: Option<Recording<BoltTables>>,
    present: Option<Vec<bool>>,
    /// Box of the parts that touch no absorbing face.
    pub(crate) structure: Option<[Vec3; 2]>,
    /// Frequencies that the parts resolve.
    pub(crate) resolution: Vec<Resolution>,
}

/// Reports of a run beside its recordings.
pub(crate) struct FinishedRun {
    pub(crate) run: RunReport,
    pub(crate) wall_time: Duration,
    pub(crate) step_time: Duration,
    /// Number of snapshots that the run's sink took.
    pub(crate) snapshots: u64,
    /// Bolts with their forces at the end.
    pub(crate) bolts: Vec<BoltForces>,
}

impl Recordings {
    /// Recordings and observers of an output plan for the active elements of a body (`None`: all), with accelerations up to a band
    /// (Hz) if there is one.
    pub(crate) fn observe(
        (plan, band): (&OutputPlan, Option<f64>),
        mesh: &Mesh,
        present: Option<&[bool]>,
        state_variables: &StateVariables,
        remarks: &mut Vec<Remark>,
    ) -> Result<(Self, Vec<Box<dyn Observer>>), Error> {
        let mut observers: Vec<Box<dyn Observer>> = Vec::new();
        let mut recordings = Self {
            histories: None,
            accelerations: None,
            sections: None,
            section_geometry: Vec::new(),
            section_capacities: Vec::new(),
            section_rings: plan.rings.clone(),
            energies: None,
            envelope: None,
            state: None,
            joints: None,
            joint_surfaces: Vec::new(),
            bolts: None,
            present: present.map(<[bool]>::to_vec),
            structure: None,
            resolution: Vec::new(),
        };
        let (history, mut without_state) = histories(plan, mesh, present, state_variables)?;
        remarks.append(&mut without_state);
        if !history.is_empty() {
            recordings.histories = Some(history.recording());
            let peaks = history.motion_peaks();
            observers.extend(peaks.map(|peaks| Box::new(peaks) as Box<dyn Observer>));
            let limited = band.map(|band| history.band_limited(band)).transpose();
            if let Some(limited) = limited.map_err(model)?.flatten() {
                recordings.accelerations = Some(limited.recording());
                observers.push(Box::new(limited));
            }
            observers.push(Box::new(history));
        }
        if !plan.cuts.is_empty() {
            let mut forces = SectionForces::new(Cadence::Seconds(plan.every)).map_err(model)?;
            for request in &plan.cuts {
                let is_there = |e: &u32| present.is_none_or(|present| present[*e as usize]);
                let set = mesh.element_set(&request.set)?;
                let set = request.elements.as_deref().unwrap_or(set).iter().copied();
                let elements: Vec<u32> = set.filter(is_there).collect();
                let geometry = forces
                    .add_section(mesh, &request.cut, &elements)
                    .map_err(model)?;
                if let Some(bears) = capacity::of_section(request, geometry).map_err(model)? {
                    let named = (request.cut.name.clone(), bears);
                    recordings.section_capacities.push(named);
                }
                remarks.extend(sections::in_pieces(mesh, request, geometry));
                if !sections::is_of_slice(mesh, geometry) {
                    remarks.extend(sections::hollow(request, geometry));
                }
                remarks.extend(sections::through_end(request, geometry));
                remarks.extend(sections::through_tetrahedra(mesh, request, &elements));
            }
            remarks.extend(plan.rings.iter().filter_map(RingRequest::partial));
            recordings.section_geometry = forces.geometries().cloned().collect();
            recordings.sections = Some(forces.recording());
            observers.push(Box::new(forces));
        }
        if let Some(every) = plan.energies {
            let energies = EnergyHistory::new(Cadence::Seconds(every)).map_err(model)?;
            recordings.energies = Some(energies.recording());
            observers.push(Box::new(energies));
        }
        if let Some(request) = &plan.envelope {
            let mut elements = Vec::new();
            if request.sets.is_empty() {
                elements.extend(0..mesh.element_count() as u32);
            }
            for set in &request.sets {
                elements.extend_from_slice(mesh.element_set(set)?);
            }
            let nodes = mesh.nodes_of_elements(&elements);
            let stressed: &[u32] = if request.stress { &elements } else { &[] };
            let cadence = Cadence::Seconds(request.every);
            let envelope =
                Envelope::new(mesh, &nodes, request.motion, stressed, cadence).map_err(model)?;
            let envelope = envelope.accelerations(plan.accelerations);
            recordings.envelope = Some(envelope.recording());
            observers.push(Box::new(envelope));
        }
        if let Some(peaks) = state_variables.peaks(plan, mesh)? {
            recordings.state = Some(peaks.recording());
            observers.push(Box::new(peaks));
        }
        Ok((recordings, observers))
    }

    /// Adds an observer of joints, whose sides are given by name.
    pub(crate) fn watch_joints(
        &mut self,
        plan: &OutputPlan,
        mesh: &Mesh,
        surfaces: Vec<NamedSurface>,
        observers: &mut Vec<Box<dyn Observer>>,
    ) -> Result<(), Error> {
        let mut watches: Vec<JointWatch> = surfaces.iter().map(whole).collect();
        for request in &plan.joints {
            watches.push(request.watch(mesh, &surfaces)?);
        }
        if !watches.is_empty() {
            let joints = JointHistories::new(Cadence::Seconds(plan.every), watches);
            let joints = joints.map_err(model)?;
            self.joints = Some(joints.recording());
            observers.push(Box::new(joints));
        }
        self.joint_surfaces = surfaces;
        Ok(())
    }

    /// Adds an observer of bolt forces.
    pub(crate) fn watch_bolts<'b>(
        &mut self,
        plan: &OutputPlan,
        bolts: impl IntoIterator<Item = &'b BoltSet>,
        observers: &mut Vec<Box<dyn Observer>>,
    ) -> Result<(), Error> {
        let mut bolts = bolts.into_iter().peekable();
        if bolts.peek().is_some() {
            let cadence = Cadence::Seconds(plan.every);
            let histories = BoltHistories::new(cadence, bolts).map_err(model)?;
            self.bolts = Some(histories.recording());
            observers.push(Box::new(histories));
        }
        Ok(())
    }

    /// Reads each recorded table of histories as it is now, with its place in the list of their files.
    pub(crate) fn each_table(&self, mut reader: impl FnMut(RunTable, &HistoryTable)) {
        for (table, recording) in [
            (RunTable::Histories, &self.histories),
            (RunTable::Sections, &self.sections),
            (RunTable::Energies, &self.energies),
            (RunTable::Accelerations, &self.accelerations),
        ] {
            if let Some(recording) = recording {
                recording.read(|rows| reader(table, rows));
            }
        }
        if let Some(joints) = &self.joints {
            joints.read(|tables| reader(RunTable::Joints, &tables.history));
        }
        if let Some(bolts) = &self.bolts {
            bolts.read(|tables| reader(RunTable::Bolts, &tables.history));
        }
    }

    /// Geometry of the sections, in the order of their requests.
    pub(crate) fn section_geometry(&self) -> &[SectionGeometry] {
        &self.section_geometry
    }

    /// Surfaces of the joints, by name.
    pub(crate) fn joint_surfaces(&self) -> &[NamedSurface] {
        &self.joint_surfaces
    }

    /// Which elements are present; none if all are.
    pub(crate) fn present(&self) -> Option<&[bool]> {
        self.present.as_deref()
    }

    /// The results of a run that is over.
    pub(crate) fn finish(self, finished: FinishedRun) -> Results {
        let FinishedRun {
            run,
            wall_time,
            step_time,
            snapshots,
            mut bolts,
        } = finished;
        let table = |recording: Option<Recording<HistoryTable>>| {
            recording.map(|r| r.copy()).unwrap_or_default()
        };
        let joints = self
            .joints
            .map(|recording| recording.copy())
            .unwrap_or_default();
        let tables = self.bolts.map(|recording| recording.copy());
        let BoltTables { history, peaks } = tables.unwrap_or_default();
        // A run that failed at its start has no samples.
        let seen = peaks.into_iter().filter(|_| !history.times.is_empty());
        for peaks in seen {
            if let Some(bolts) = bolts.iter_mut().find(|bolts| bolts.name == peaks.name) {
                bolts.greatest = Some(peaks.greatest);
            }
        }
        // Joints with common nodes are adjacent in the model, whatever their order in the scene.
        let surface = |joint: &JointTable| {
            let mut surfaces = self.joint_surfaces.iter();
            let found = surfaces.find(|(name, _)| *name == joint.name);
            found.map(|(_, surface)| surface.clone())
        };
        Results {
            joint_surfaces: joints.joints.iter().filter_map(surface).collect(),
            joint_histories: joints.history,
            joint_outcomes: joints.outcomes,
            joints: joints.joints,
            run,
            wall_time,
            step_time,
            histories: table(self.histories),
            accelerations: table(self.accelerations),
            sections: table(self.sections),
            section_geometry: self.section_geometry,
            section_capacities: self.section_capacities,
            section_rings: self.section_rings,
            energies: table(self.energies),
            envelope: self.envelope.map(|recording| recording.copy()),
            state: self.state.map(|recording| recording.copy()),
            present: self.present,
            structure: self.structure,
            resolution: self.resolution,
            snapshots,
            stages: Vec::new(),
            in_situ_stress: false,
            hand_over: None,
            bolts,
            bolt_histories: history,
            advice: Vec::new(),
            fibres: None,
        }
    }
}

/// Request for every joint as a whole.
fn whole((name, surface): &NamedSurface) -> JointWatch {
    JointWatch {
        name: name.clone(),
        joint: name.clone(),
        pairs: (0..surface.pairs.len()).collect(),
        quantities: JointQuantities {
            opening: false,
            traction: false,
            ..JointQuantities::ALL
        },
    }
}

impl JointRequest {
    /// The pairs that are requested.
    fn watch(&self, mesh: &Mesh, surfaces: &[NamedSurface]) -> Result<JointWatch, Error> {
        let of_name = surfaces.iter().find(|(name, _)| *name == self.joint);
        let Some((joint, surface)) = of_name else {
            return Err(Error::NoSuchJoint {
                name: self.joint.clone(),
            });
        };
        Ok(JointWatch {
            name: self.name.clone(),
            joint: joint.clone(),
            pairs: self.zone.pairs(mesh, (joint, surface))?,
            quantities: self.quantities,
        })
    }
}

/// Histories of a plan, and warnings of requests that record nothing.
fn histories(
    plan: &OutputPlan,
    mesh: &Mesh,
    present: Option<&[bool]>,
    state_variables: &StateVariables,
) -> Result<(History, Vec<Remark>), Error> {
    let mut builder =
        History::builder(Cadence::Seconds(plan.every)).accelerations(plan.accelerations);
    if let Some(present) = present {
        builder = builder.among(present);
    }
    for request in &plan.histories {
        if request.motion != Motion::default() {
            builder = builder.motion(&request.name, request.place.clone(), request.motion);
        }
    }
    for request in &plan.stresses {
        builder = match &request.place {
            StressPlace::Point(point) if request.at_point => {
                builder.stress_at(&request.name, point.clone())
            }
            place => builder.stress(&request.name, place.clone()),
        };
    }
    for request in &plan.state.places {
        builder = builder.state(&request.name, request.place.clone());
    }
    for request in &plan.relative {
        let (from, at) = (request.from.clone(), request.at.clone());
        builder = builder.relative(&request.name, from, at, Motion::DISPLACEMENT);
    }
    for request in &plan.sampled {
        builder = builder.sampled(&request.name, request.sampler.clone());
    }
    // In the order of the requests.
    let asked = RefCell::new(Vec::new());
    let variables = |element| {
        asked.borrow_mut().push(element);
        state_variables.of_element(element).to_vec()
    };
    let history = builder.build_with(mesh, variables).map_err(model)?;
    let places = plan.state.places.iter().zip(asked.into_inner());
    let without_state =
        places.filter(|(_, element)| state_variables.of_element(*element).is_empty());
    let remarks = without_state.map(|(request, element)| {
        Remark::from(remark::NoState {
            name: request.name.clone(),
            element: mesh.element_tags()[element as usize],
        })
    });
    Ok((history, remarks.collect()))
}

fn model(error: impl Into<ModelError>) -> Error {
    Error::Model(error.into())
}
