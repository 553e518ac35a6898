//! Outcome of a case of a sweep: the values by which cases are compared.

use powerhouse::Results;
use powerhouse::engine::observe::{HistoryTable, JointOutcome};
use powerhouse::model::Mesh;
use serde::{Deserialize, Serialize};

use super::contact::{JointAndLining, JointCase};
use super::coverage::Coverage;
use super::damage::{DAMAGED, Damage, PartDamage, STRUCTURE};
use super::input::CaseInput;
use super::sections::{self, SectionExtremes};
use crate::StudyError;
use crate::json::read_json;

/// Greatest value of a history over the samples of the dynamic run, with its time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Name of the history.
    pub name: String,
    /// Greatest value, in the unit of the history (Pa, m or N).
    pub value: f64,
    /// Time of the greatest value (s).
    pub time: f64,
}

/// Summary of the envelope of one damage variable over the dynamic run, in the element set `structure`, or in the whole
/// mesh without such a set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DamageOutcome {
    /// Name of the history variable: `damage`, `damage_tension` or `damage_compression`.
    pub name: String,
    /// Greatest value over elements and time, from 0 to 1.
    pub greatest: f64,
    /// Number of the element with the greatest value in the mesh file.
    pub element: u64,
    /// Number of elements whose greatest value is above 0.1.
    pub damaged: usize,
    /// Number of all elements of the set.
    pub of: usize,
}

/// Outcome of a finished case of a sweep, as stored in `outcome.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseOutcome {
    /// Name of the case.
    pub name: String,
    /// Input: waves and varied parameter.
    #[serde(default)]
    pub input: CaseInput,
    /// Covered share of its records; `None` without records.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub coverage: Option<Coverage>,
    /// Number of time steps that the dynamic run took; construction stages have none, iterations of a dynamic
    /// relaxation are not counted.
    pub steps: u64,
    /// Time step of the dynamic run (s).
    pub step: f64,
    /// Time at the end of the dynamic run (s).
    pub end: f64,
    /// Wall time of the dynamic run (s), without stages, free-field check and result files.
    pub wall_time: f64,
    /// Largest residual of the energy balance over the largest energy stored or put in until then (1).
    pub energy_residual: f64,
    /// Greatest principal stress over time (Pa, tension positive) of each stress history, that of the stages included.
    pub stresses: Vec<Peak>,
    /// Greatest displacement norm over time (m) of each displacement history, from the start of the dynamic run.
    pub displacements: Vec<Peak>,
    /// Greatest norm over time (m) of each relative displacement, from the start of the dynamic run.
    pub relative: Vec<Peak>,
    /// Greatest norm over time (m) of each relative displacement in the incident field, without the structure; empty
    /// without waves.
    #[serde(default)]
    pub ground: Vec<Peak>,
    /// Summary of each damage variable of the laws; empty without one.
    pub damage: Vec<DamageOutcome>,
    /// Damage of the set `structure` and of the element sets within it; empty without such a set or without damage
    /// variables.
    #[serde(default)]
    pub parts: Vec<PartDamage>,
    /// Results of each joint as a whole.
    pub joints: Vec<JointCase>,
    /// Results of the parts of joints that output requests select.
    #[serde(default)]
    pub joint_parts: Vec<JointCase>,
    /// Relation between joint failure and damage of the structure; `None` without joints.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub joint_and_lining: Option<JointAndLining>,
    /// Extremes of the forces of each ring, and of each section that is of none.
    #[serde(default)]
    pub sections: Vec<SectionExtremes>,
    /// Greatest axial force over the dynamic run (N, tension positive) of each bolt group.
    pub bolts: Vec<Peak>,
    /// Greatest axial force (N, tension positive) of each bolt group after the stages, before the dynamic run.
    #[serde(default)]
    pub bolts_at_rest: Vec<Peak>,
}

impl CaseOutcome {
    /// Evaluates a run, with the names of its relative displacements and their peaks in the free field.
    pub(super) fn of(
        (name, input): (&str, CaseInput),
        mesh: &Mesh,
        results: &Results,
        (relative, ground): (&[String], Vec<Peak>),
    ) -> Self {
        let run = &results.run;
        let (relative, displacements) = displacement_peaks(results.histories())
            .into_iter()
            .partition(|peak| relative.contains(&peak.name));
        let structure = mesh.element_set(STRUCTURE).ok();
        let whole = structure.map_or(mesh.element_count(), <[u32]>::len);
        let counts = |element: &u32| structure.is_none_or(|set| set.binary_search(element).is_ok());
        let damage = results.state.iter().flat_map(|state| {
            let of = state.peaks.iter();
            let named = of.filter(|(variable, _)| variable.name.starts_with("damage"));
            named.filter_map(|(variable, peaks)| {
                let all = state.elements.iter().zip(&peaks.values);
                let own = || all.clone().filter(|(element, _)| counts(element));
                let (&element, &greatest) = own().max_by(|a, b| a.1.total_cmp(b.1))?;
                Some(DamageOutcome {
                    name: variable.name.to_string(),
                    greatest,
                    element: mesh.element_tags()[element as usize],
                    damaged: own().filter(|(_, damage)| **damage > DAMAGED).count(),
                    of: whole,
                })
            })
        });
        let of_parts = results.state.as_ref();
        let of_parts = of_parts.and_then(|state| Damage::of(mesh, state));
        let is_whole = |outcome: &&JointOutcome| outcome.name == outcome.joint;
        let (joints, joint_parts): (Vec<_>, Vec<_>) =
            results.joint_outcomes.iter().partition(is_whole);
        let joints_of = |outcomes: Vec<&JointOutcome>| -> Vec<JointCase> {
            outcomes.into_iter().map(JointCase::of).collect()
        };
        let (bolts, bolts_at_rest) = bolt_peaks(results.bolt_histories());
        Self {
            name: name.into(),
            input,
            coverage: None,
            steps: run.steps,
            step: run.step,
            end: run.time,
            wall_time: results.wall_time.as_secs_f64(),
            energy_residual: run.energy_residual,
            stresses: stress_peaks(results.histories()),
            displacements,
            relative,
            ground,
            damage: damage.collect(),
            parts: (of_parts.as_ref()).map_or_else(Vec::new, |damage| damage.parts(mesh)),
            joints: joints_of(joints),
            joint_parts: joints_of(joint_parts),
            joint_and_lining: JointAndLining::of(mesh, results, of_parts.as_ref()),
            sections: sections::of(results),
            bolts,
            bolts_at_rest,
        }
    }

    /// The results by which cases are compared, with their names and units, as the columns of `sweep.csv`.
    pub fn figures(&self) -> Vec<(String, f64)> {
        super::table::figures(self)
    }

    /// Reads an outcome from its JSON file.
    ///
    /// # Errors
    /// [`StudyError::Read`], [`StudyError::Outcome`].
    pub fn read(file: &std::path::Path) -> Result<Self, StudyError> {
        read_json(file)
    }
}

/// The peaks of the greatest principal stress of each stress history.
fn stress_peaks(table: &HistoryTable) -> Vec<Peak> {
    let columns = table.columns.iter();
    let of = columns.filter_map(|column| Some((column.name.strip_suffix(".s1")?, column)));
    of.filter_map(|(name, column)| greatest(name, &table.times, &column.values))
        .collect()
}

/// The peaks of the bolt forces over the motion, and their values before it.
fn bolt_peaks(table: &HistoryTable) -> (Vec<Peak>, Vec<Peak>) {
    let columns = table.columns.iter();
    let of = columns.filter_map(|column| Some((column.name.strip_suffix(".greatest")?, column)));
    let peaks = of.filter_map(|(name, column)| {
        let at_rest = Peak {
            name: name.into(),
            value: *column.values.first()?,
            time: *table.times.first()?,
        };
        Some((greatest(name, &table.times, &column.values)?, at_rest))
    });
    peaks.unzip()
}

/// The peaks of the norm of each displacement history.
pub(super) fn displacement_peaks(table: &HistoryTable) -> Vec<Peak> {
    let names = table
        .columns
        .iter()
        .filter_map(|column| column.name.strip_suffix(".ux"));
    let peaks = names.filter_map(|name| {
        let component = |axis: &str| table.column(&format!("{name}.{axis}"));
        let [x, y, z] = [component("ux")?, component("uy")?, component("uz")?];
        let lengths: Vec<f64> = (0..table.times.len())
            .map(|i| x.values[i].hypot(y.values[i]).hypot(z.values[i]))
            .collect();
        greatest(name, &table.times, &lengths)
    });
    peaks.collect()
}

fn greatest(name: &str, times: &[f64], values: &[f64]) -> Option<Peak> {
    let samples = times.iter().zip(values);
    let (time, value) = samples.max_by(|a, b| a.1.total_cmp(b.1))?;
    Some(Peak {
        name: name.into(),
        value: *value,
        time: *time,
    })
}
