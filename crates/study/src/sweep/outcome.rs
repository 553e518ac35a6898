//! What a case of a sweep came to, in the numbers that cases are compared by.

use powerhouse::Results;
use powerhouse::engine::observe::{HistoryTable, JointOutcome};
use powerhouse::model::Mesh;
use serde::{Deserialize, Serialize};

use super::contact::{JointAndLining, JointCase};
use super::coverage::Coverage;
use super::damage::{DAMAGED, Damage, PartDamage, STRUCTURE};
use super::input::CaseInput;
use crate::StudyError;

/// The greatest of a history and when it was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// The name of the history.
    pub name: String,
    /// Its greatest value (Pa or m).
    pub value: f64,
    /// When (s).
    pub time: f64,
}

/// Damage of one kind, in the set `structure`, or everywhere if there is no such set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DamageOutcome {
    /// What the law calls it: `damage`, `damage_tension`, `damage_compression`.
    pub name: String,
    /// The greatest value.
    pub greatest: f64,
    /// The user's number of the element.
    pub element: u64,
    /// How many elements have more than a tenth.
    pub damaged: usize,
    /// How many elements are there.
    pub of: usize,
}

/// A case of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseOutcome {
    /// Its name.
    pub name: String,
    /// What comes in, and what it varies.
    #[serde(default)]
    pub input: CaseInput,
    /// How much of its records it has seen; none if no record moves it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub coverage: Option<Coverage>,
    /// Steps.
    pub steps: u64,
    /// Their length (s).
    pub step: f64,
    /// Time at the end (s).
    pub end: f64,
    /// Wall time of the motion (s), that of stages not in it.
    pub wall_time: f64,
    /// The largest residual of the energy ledger over the largest energy.
    pub energy_residual: f64,
    /// Greatest principal stress (Pa) of each history of stress.
    pub stresses: Vec<Peak>,
    /// Greatest displacement (m) of each history.
    pub displacements: Vec<Peak>,
    /// Greatest relative displacement (m).
    pub relative: Vec<Peak>,
    /// The same of ground without any structure, as the waves that come in move it; none without waves.
    #[serde(default)]
    pub ground: Vec<Peak>,
    /// Damage.
    pub damage: Vec<DamageOutcome>,
    /// Damage of the structure and its parts.
    #[serde(default)]
    pub parts: Vec<PartDamage>,
    /// Joints.
    pub joints: Vec<JointCase>,
    /// Parts of joints.
    #[serde(default)]
    pub joint_parts: Vec<JointCase>,
    /// How the failure of joints goes with the damage beside them, if there are joints.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub joint_and_lining: Option<JointAndLining>,
    /// Greatest axial force of each make of bolts over the motion (N).
    pub bolts: Vec<Peak>,
    /// The same at rest before it.
    #[serde(default)]
    pub bolts_at_rest: Vec<Peak>,
}

impl CaseOutcome {
    /// The outcome of a run whose relative displacements have these names, and which come to so much
    /// in the ground alone.
    pub(super) fn of(
        (name, input): (&str, CaseInput),
        mesh: &Mesh,
        results: &Results,
        (relative, ground): (&[String], Vec<Peak>),
    ) -> Self {
        let run = &results.run;
        let (relative, displacements) = displacement_peaks(&results.histories)
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
        let (bolts, bolts_at_rest) = bolt_peaks(&results.bolt_histories);
        Self {
            name: name.into(),
            input,
            coverage: None,
            steps: run.steps,
            step: run.step,
            end: run.time,
            wall_time: results.wall_time.as_secs_f64(),
            energy_residual: run.energy_residual,
            stresses: stress_peaks(&results.histories),
            displacements,
            relative,
            ground,
            damage: damage.collect(),
            parts: (of_parts.as_ref()).map_or_else(Vec::new, |damage| damage.parts(mesh)),
            joints: joints_of(joints),
            joint_parts: joints_of(joint_parts),
            joint_and_lining: JointAndLining::of(mesh, results, of_parts.as_ref()),
            bolts,
            bolts_at_rest,
        }
    }

    /// Reads an outcome that was written before.
    ///
    /// # Errors
    /// [`StudyError::Read`], [`StudyError::Outcome`].
    pub fn read(file: &std::path::Path) -> Result<Self, StudyError> {
        let text = std::fs::read(file).map_err(|source| StudyError::Read {
            file: file.into(),
            source,
        })?;
        serde_json::from_slice(&text).map_err(|source| StudyError::Outcome {
            file: file.into(),
            source,
        })
    }
}

/// The greatest of each column of a greatest principal stress.
fn stress_peaks(table: &HistoryTable) -> Vec<Peak> {
    let columns = table.columns.iter();
    let of = columns.filter_map(|column| Some((column.name.strip_suffix(".s1")?, column)));
    of.filter_map(|(name, column)| greatest(name, &table.times, &column.values))
        .collect()
}

/// The greatest force of each make of bolts over the motion, and that before it.
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

/// The greatest length of each displacement.
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
