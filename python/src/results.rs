//! Results of a run.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use powerhouse::engine::Ended;
use powerhouse::engine::observe::{EnvelopeTable, HistoryTable, PeakRow, Snapshot, StateTable};
use powerhouse::model::{self, HistoryVariable};
use powerhouse::{Remark, RunNotes, merge_messages};
use pyo3::prelude::*;

use crate::arrays::{components, of_list, of_rows, stresses};
use crate::fault::text_of;
use crate::mesh::Mesh;
use crate::table::Table;

/// A snapshot that is kept in memory; fields that were not requested are empty.
pub(crate) struct Shot {
    time: f64,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    stress: Vec<f64>,
    state: Vec<(HistoryVariable, Vec<f64>)>,
}

impl Shot {
    /// A copy of a snapshot.
    pub(crate) fn of(shot: &Snapshot) -> Self {
        Self {
            time: shot.time,
            displacement: components(shot.displacement.iter().copied()),
            velocity: components(shot.velocity.iter().copied()),
            acceleration: components(shot.acceleration.iter().copied()),
            stress: stresses(shot.stress),
            state: shot.state.to_vec(),
        }
    }
}

/// What a run has left.
pub(crate) struct Done {
    pub(crate) title: String,
    pub(crate) mesh: Arc<model::Mesh>,
    pub(crate) results: powerhouse::Results,
    pub(crate) notes: RunNotes,
    /// Warnings about checkpoints.
    pub(crate) of_checkpoints: Vec<String>,
    pub(crate) folder: Option<PathBuf>,
    pub(crate) files: Vec<PathBuf>,
    pub(crate) shots: Vec<Shot>,
}

/// A field: its name, unit and kind of members (`nodes` or `elements`), indices of the members, values and times (s).
type Field = (
    String,
    String,
    String,
    Py<PyArray1<u32>>,
    Py<PyArray1<f64>>,
    Option<Py<PyArray1<f64>>>,
);

/// Results of a run.
#[pyclass(frozen, get_all, module = "powerhouse_fe._core")]
pub(crate) struct Results {
    /// Title of the scene.
    title: String,
    /// How the run ended: `completed`, `interrupted`, `failed`, or the name of the observer that ended it.
    ended: String,
    /// Number of time steps.
    steps: u64,
    /// Length of a time step (s).
    step: f64,
    /// Time at the end (s).
    time: f64,
    /// Wall time of stages and run (s).
    wall_time: f64,
    /// Mean wall time of a step (s).
    step_time: f64,
    /// Histories of motion, stress and state variables.
    histories: Py<Table>,
    /// Accelerations of the histories up to the band.
    accelerations: Py<Table>,
    /// Section forces.
    sections: Py<Table>,
    /// Energies.
    energies: Py<Table>,
    /// Histories of joints.
    joints: Py<Table>,
    /// Histories of bolts.
    bolts: Py<Table>,
    /// Fields of envelopes and of state variables.
    fields: Vec<Field>,
    /// Peaks: name, unit, value, time (s), place in words.
    peaks: Vec<(String, String, f64, f64, Option<String>)>,
    /// The table of peaks as the command prints it.
    peaks_text: String,
    /// Residual of the energy balance at the end (J), over the work put in, and the largest one over the run (1).
    energy_residual: Option<(f64, Option<f64>, f64)>,
    /// Warnings about the results.
    warnings: Vec<String>,
    /// Facts about the composition of the scene.
    remarks: Vec<String>,
    /// Advice on a run that failed.
    advice: Vec<String>,
    /// Folder of the files.
    folder: Option<String>,
    /// Paths of the files.
    files: Vec<String>,
    /// The mesh.
    mesh: Py<Mesh>,
    /// Which elements are present, if not all are.
    present: Option<Py<PyArray1<bool>>>,
    /// Snapshots that are kept in memory.
    snapshots: Vec<Py<KeptSnapshot>>,
}

/// A snapshot: time (s) and fields, one row for a node or element.
#[pyclass(frozen, get_all, module = "powerhouse_fe._core")]
pub(crate) struct KeptSnapshot {
    /// Time (s).
    time: f64,
    /// Displacement (m) of the nodes.
    displacement: Option<Py<PyArray2<f64>>>,
    /// Velocity (m/s) of the nodes.
    velocity: Option<Py<PyArray2<f64>>>,
    /// Acceleration (m/s2) of the nodes.
    acceleration: Option<Py<PyArray2<f64>>>,
    /// Stress (Pa) of the elements: xx, yy, zz, xy, yz, zx.
    stress: Option<Py<PyArray2<f64>>>,
    /// History variables: name, unit, values of the elements.
    state: Vec<(String, String, Py<PyArray1<f64>>)>,
}

impl KeptSnapshot {
    fn new(py: Python<'_>, shot: Shot) -> PyResult<Self> {
        let rows = |values: Vec<f64>, width: usize| {
            if values.is_empty() {
                Ok(None)
            } else {
                Ok::<_, PyErr>(Some(of_rows(py, values, width)?.unbind()))
            }
        };
        let state = shot.state.into_iter().map(|(variable, values)| {
            let array = of_list(py, values).unbind();
            (variable.name.to_owned(), variable.unit.to_owned(), array)
        });
        Ok(Self {
            time: shot.time,
            displacement: rows(shot.displacement, 3)?,
            velocity: rows(shot.velocity, 3)?,
            acceleration: rows(shot.acceleration, 3)?,
            stress: rows(shot.stress, 6)?,
            state: state.collect(),
        })
    }
}

impl Results {
    /// The results, whose arrays have the memory of what was recorded.
    pub(crate) fn new(py: Python<'_>, done: Done) -> PyResult<Self> {
        let Done {
            title,
            mesh,
            mut results,
            notes,
            of_checkpoints,
            folder,
            files,
            shots,
        } = done;
        let peaks = results.peaks(&mesh);
        let residual = results.energy_residual();
        let of_results = results.warnings(&mesh);
        let (severe, facts): (Vec<&Remark>, Vec<&Remark>) =
            notes.remarks.iter().partition(|remark| remark.is_warning());
        let messages = (severe.into_iter().map(Remark::message))
            .chain(notes.warnings.iter().cloned())
            .chain(of_results.iter().map(Remark::message));
        let mut warnings: Vec<String> = (merge_messages(messages).into_iter())
            .map(|message| message.text)
            .collect();
        warnings.extend(of_checkpoints);
        let remarks = facts.iter().map(|remark| remark.to_string()).collect();
        let ended = match &results.run.ended {
            Ended::Completed => "completed".to_owned(),
            Ended::Stopped => "interrupted".to_owned(),
            Ended::Observer(name) => name.clone(),
            Ended::Failed(_) => "failed".to_owned(),
        };
        let mut fields = Vec::new();
        if let Some(table) = results.envelope.take() {
            of_envelope(py, table, &mut fields);
        }
        if let Some(table) = results.state.take() {
            of_state(py, table, &mut fields);
        }
        let table = |table: &HistoryTable| Py::new(py, Table::new(py, table.clone()));
        let kept = shots
            .into_iter()
            .map(|shot| Py::new(py, KeptSnapshot::new(py, shot)?));
        Ok(Self {
            title,
            ended,
            steps: results.run.steps,
            step: results.run.step,
            time: results.run.time,
            wall_time: results.wall_time.as_secs_f64(),
            step_time: results.step_time.as_secs_f64(),
            histories: table(results.histories())?,
            accelerations: table(results.accelerations())?,
            sections: table(results.sections())?,
            energies: table(results.energies())?,
            joints: table(results.joint_histories())?,
            bolts: table(results.bolt_histories())?,
            fields,
            peaks: peaks.rows.iter().map(of_peak).collect(),
            peaks_text: peaks.to_string(),
            energy_residual: residual
                .map(|found| (found.energy, found.share_of_input, found.largest)),
            warnings,
            remarks,
            advice: results.advice,
            folder: folder.as_deref().map(text_of),
            files: files.iter().map(|file| text_of(file)).collect(),
            mesh: Py::new(py, Mesh { mesh })?,
            present: results.present.map(|present| of_list(py, present).unbind()),
            snapshots: kept.collect::<PyResult<_>>()?,
        })
    }
}

fn of_peak(row: &PeakRow) -> (String, String, f64, f64, Option<String>) {
    let place = row.place.as_ref().map(ToString::to_string);
    (
        row.name.clone(),
        row.unit.to_owned(),
        row.value,
        row.time,
        place,
    )
}

/// Adds the fields of an envelope that were recorded.
fn of_envelope(py: Python<'_>, table: EnvelopeTable, fields: &mut Vec<Field>) {
    let nodes = of_list(py, table.nodes).unbind();
    let elements = of_list(py, table.elements).unbind();
    let all = [
        ("displacement", "m", "nodes", &nodes, table.displacement),
        ("velocity", "m/s", "nodes", &nodes, table.velocity),
        ("acceleration", "m/s2", "nodes", &nodes, table.acceleration),
        (
            "greatest_principal_stress",
            "Pa",
            "elements",
            &elements,
            table.greatest_stress,
        ),
        (
            "least_principal_stress",
            "Pa",
            "elements",
            &elements,
            table.least_stress,
        ),
    ];
    for (name, unit, of, members, field) in all {
        if !field.values.is_empty() {
            fields.push((
                name.into(),
                unit.into(),
                of.into(),
                members.clone_ref(py),
                of_list(py, field.values).unbind(),
                Some(of_list(py, field.times).unbind()),
            ));
        }
    }
}

/// Adds the fields of history variables.
fn of_state(py: Python<'_>, table: StateTable, fields: &mut Vec<Field>) {
    let elements = of_list(py, table.elements).unbind();
    for (variable, field) in table.peaks {
        let times = Some(of_list(py, field.times).unbind());
        let values = of_list(py, field.values).unbind();
        let (name, unit) = (variable.name.into(), variable.unit.into());
        fields.push((
            name,
            unit,
            "elements".into(),
            elements.clone_ref(py),
            values,
            times,
        ));
    }
    for (variable, values) in table.flags {
        let values = of_list(py, values).unbind();
        let (name, unit) = (variable.name.into(), variable.unit.into());
        fields.push((
            name,
            unit,
            "elements".into(),
            elements.clone_ref(py),
            values,
            None,
        ));
    }
}
