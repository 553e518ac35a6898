//! Results of a run that are compared between meshes.

use std::collections::BTreeSet;
use std::path::Path;

use powerhouse::Scene;
use powerhouse::io::TableColumn;
use powerhouse::model::HistoryKind;
use powerhouse::summary::PeakSummary;

use crate::StudyError;
use crate::even_samples::Accelerations;
use crate::run_summary::FoundSummary;
use crate::sweep::{CaseOutcome, JointCase, OUTCOME};

/// Frequencies (Hz) at which response spectra are compared, and their damping ratio.
const FREQUENCIES: [f64; 5] = [1.0, 2.0, 5.0, 10.0, 20.0];
const DAMPING: f64 = 0.05;
/// Least number of samples within a period of a response spectrum.
const SAMPLES_PER_PERIOD: f64 = 5.0;
/// Relative uncertainty of a response spectrum, whose peaks are sought at 32 instants a period: half of `1 - cos(pi / 32)`.
const OF_INSTANTS: f64 = 2.4e-3;
/// Directions with a peak acceleration below this share of the greatest have no spectrum.
const STILL: f64 = 1e-2;
/// History variables that describe the mesh.
const OF_MESH: [&str; 2] = ["crack_band_width", "crushing_band_width"];

/// Result of a run: a peak, a spectral value, a mean or a share.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Figure {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) value: f64,
    /// Whether it is of the motion of points, which converges faster than stresses.
    pub(super) of_motion: bool,
    /// Uncertainty of the value from its evaluation, in its unit: the change if the record ends a sample earlier, since runs on several
    /// meshes end within a step of each other, and that of peaks between the instants at which they are sought.
    pub(super) of_sampling: f64,
}

impl Figure {
    fn new(name: impl Into<String>, unit: &str, value: f64) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            value,
            of_motion: false,
            of_sampling: 0.0,
        }
    }
    fn of_motion(name: impl Into<String>, unit: &str, value: f64) -> Self {
        Self {
            of_motion: true,
            ..Self::new(name, unit, value)
        }
    }
}

/// Names of the history variables of a scene's laws that are no amounts: flags and components of tensors.
pub(super) fn not_compared(scene: &Scene) -> BTreeSet<&'static str> {
    let variables = scene
        .parts()
        .iter()
        .flat_map(|part| part.material.history());
    let excluded = variables.filter(|variable| variable.kind != HistoryKind::Amount);
    excluded
        .map(|variable| variable.name)
        .chain(OF_MESH)
        .collect()
}

/// The results of the folder of a finished run without the history variables that are not compared.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn figures(
    folder: &Path,
    not_compared: &BTreeSet<&'static str>,
) -> Result<Vec<Figure>, StudyError> {
    let outcome = CaseOutcome::read(&folder.join(OUTCOME))?;
    let summary = FoundSummary::of_results(folder)?;
    let mut found = peaks(&summary.peaks, not_compared);
    found.extend(spectra(&Accelerations::of_folder(folder)?));
    found.extend(outcomes(&outcome));
    Ok(found)
}

/// The absolute peaks of a run: motions, principal stresses, amounts of laws, section forces, bolts, joints, envelopes.
fn peaks(rows: &[PeakSummary], not_compared: &BTreeSet<&'static str>) -> Vec<Figure> {
    let kept = rows.iter().filter_map(|row| {
        let (name, unit) = (row.name.as_str(), row.unit.as_str());
        let variable = name.rsplit('.').next().unwrap_or(name);
        let is_component = ["xx", "yy", "zz", "xy", "yz", "zx", "s2"].contains(&variable);
        if is_component || not_compared.contains(variable) {
            return None;
        }
        let value = if row.below_rounding {
            0.0
        } else {
            row.value.abs()
        };
        // Instants have no limit with finer meshes.
        if !value.is_finite() || name.ends_with("(instant)") {
            return None;
        }
        Some(Figure {
            name: format!("peak of {name}"),
            unit: unit.into(),
            value,
            of_motion: ["m", "m/s", "m/s2"].contains(&unit)
                && variable.len() == 2
                && "uva".contains(&variable[..1]),
            of_sampling: 0.0,
        })
    });
    kept.collect()
}

/// Values of the response spectra of all acceleration histories, in the directions in which they move.
fn spectra(motion: &Accelerations) -> Vec<Figure> {
    let peak = |column: &TableColumn| {
        let values = column.values.iter();
        values.fold(0.0_f64, |most, value| most.max(value.abs()))
    };
    let is_acceleration = |column: &&TableColumn| {
        let axis = column
            .name
            .rsplit_once('.')
            .map_or("", |(_, variable)| variable);
        column.unit == "m/s2" && ["ax", "ay", "az"].contains(&axis)
    };
    let accelerations = motion.columns().iter();
    let accelerations: Vec<&TableColumn> = accelerations.filter(is_acceleration).collect();
    let most = accelerations
        .iter()
        .map(|column| peak(column))
        .fold(0.0, f64::max);
    let moving = accelerations
        .into_iter()
        .filter(|column| peak(column) > STILL * most);
    let spectra = moving.flat_map(|column| {
        let samples = column.values.len();
        let records =
            [samples, samples.saturating_sub(1)].map(|until| motion.history(column, until));
        let of = |frequency: f64| {
            let [value, shorter] = records.each_ref().map(|history| {
                let history = history.as_ref()?;
                let resolved = frequency * SAMPLES_PER_PERIOD * history.step() <= 1.0
                    && frequency <= motion.highest_frequency();
                let response = history.response_spectrum(DAMPING, &[1.0 / frequency]);
                resolved.then_some(response.ok()?.first()?.acceleration)
            });
            let name = format!("spectrum of {} at {frequency} Hz, 5 %", column.name);
            let value = value?;
            Some(Figure {
                of_sampling: (value - shorter.unwrap_or(value))
                    .abs()
                    .max(OF_INSTANTS * value),
                ..Figure::of_motion(name, "m/s2", value)
            })
        };
        FREQUENCIES.map(of).into_iter().flatten()
    });
    spectra.collect()
}

/// Results of parts, joints and relative displacements as a whole.
fn outcomes(outcome: &CaseOutcome) -> Vec<Figure> {
    let relative = outcome.relative.iter().map(|peak| {
        let name = format!("peak of {}, relative displacement", peak.name);
        Figure::of_motion(name, "m", peak.value)
    });
    let stresses = outcome.stresses.iter().map(|peak| {
        let name = format!("peak of {}, greatest principal stress", peak.name);
        Figure::new(name, "Pa", peak.value)
    });
    let parts = outcome.parts.iter().flat_map(|part| {
        [
            Figure::new(format!("mean damage of {}", part.name), "1", part.mean),
            Figure::new(format!("damaged share of {}", part.name), "1", part.damaged),
        ]
    });
    let joints = outcome.joints.iter().chain(&outcome.joint_parts);
    let joints = joints.flat_map(|joint: &JointCase| {
        let shares = [
            ("slipped", joint.slipped),
            ("open", joint.opened),
            ("unbonded", joint.broken),
        ];
        shares.map(|(share, value)| {
            Figure::new(format!("{share} share of {}", joint.name), "1", value)
        })
    });
    let failed = outcome.joint_and_lining.iter();
    let failed = failed.map(|found| Figure::new("failed share of all joints", "1", found.failed));
    let all = relative.chain(stresses).chain(parts);
    all.chain(joints).chain(failed).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Components of tensors, flags and widths of crack bands are not compared; peaks below rounding count as zero.
    #[test]
    fn peaks_are_those_of_amounts() {
        let peak = |name: &str, unit: &str, value: f64| json!({"name": name, "unit": unit, "value": value, "time": 0.1});
        let mut still = peak("crown.ux", "m", 1e-21);
        still["below_rounding"] = true.into();
        let rows = json!([
            still,
            peak("crown.vz", "m/s", -0.3),
            peak("wall.xx", "Pa", 4.0),
            peak("wall.s1", "Pa", 5.0),
            peak("wall.plastic_strain_xx", "1", 6.0),
            peak("wall.yield_state", "1", 7.0),
            peak("crack_band_width", "m", 8.0),
            peak("wall.damage", "1", 0.9),
            peak("lining.axial", "N", -10.0),
        ]);
        let rows: Vec<PeakSummary> = serde_json::from_value(rows).unwrap();
        let excluded = BTreeSet::from(["plastic_strain_xx", "yield_state", "crack_band_width"]);
        let found = peaks(&rows, &excluded);
        let found: Vec<(&str, f64, bool)> = found
            .iter()
            .map(|figure| (figure.name.as_str(), figure.value, figure.of_motion))
            .collect();
        assert_eq!(
            found,
            [
                ("peak of crown.ux", 0.0, true),
                ("peak of crown.vz", 0.3, true),
                ("peak of wall.s1", 5.0, false),
                ("peak of wall.damage", 0.9, false),
                ("peak of lining.axial", 10.0, false),
            ]
        );
    }

    /// A harmonic motion at the frequency of an oscillator at rest is amplified nearly tenfold at 5 % damping; a direction
    /// that hardly moves and a frequency with too few samples have no value.
    #[test]
    fn spectra_are_those_of_directions_that_move() {
        let times: Vec<f64> = (0..2001).map(|sample| 0.02 * f64::from(sample)).collect();
        let wave = |size: f64| {
            let values = times
                .iter()
                .map(|time| size * (4.0 * core::f64::consts::PI * time).sin());
            values.collect::<Vec<f64>>()
        };
        let table = [
            TableColumn::new("time", "s", times.clone()),
            TableColumn::new("crown.ax", "m/s2", wave(2.0)),
            TableColumn::new("crown.az", "m/s2", wave(1e-3)),
            TableColumn::new("crown.vx", "m/s", wave(2.0)),
        ];
        let found = spectra(&Accelerations::of_samples(table.into()));
        let names: Vec<&str> = found.iter().map(|figure| figure.name.as_str()).collect();
        let of = |frequency: &str| format!("spectrum of crown.ax at {frequency} Hz, 5 %");
        assert_eq!(names, ["1", "2", "5", "10"].map(of));
        assert!(
            (found[1].value / 20.0 - 1.0).abs() < 0.01,
            "{}",
            found[1].value
        );
    }
}
