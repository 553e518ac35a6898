//! Response spectra of floors.

use std::path::{Path, PathBuf};

use powerhouse::io::{Plot, PlotCurve, PlotPanel, TableColumn, write_plot, write_table};

use super::page::Table;
use super::{CaseFiles, column, history_of, kinds};
use crate::StudyError;
use crate::rounded::rounded;

/// Shares of critical damping.
const DAMPINGS: [f64; 3] = [0.02, 0.05, 0.1];
/// The one at which cases are compared.
const COMMON: f64 = 0.05;
/// Shortest and longest period (s), and how many there are, in equal ratios.
const PERIODS: ([f64; 2], usize) = ([0.03, 3.0], 90);
/// The longest period that is drawn (s).
const DRAWN: f64 = 1.5;
/// Directions that are looked at: along the wave and up.
const AXES: [char; 2] = ['x', 'z'];

/// What equipment on a floor of a case would feel in a direction.
pub(super) struct FloorSpectrum {
    pub(super) case: String,
    floor: String,
    axis: char,
    damping: f64,
    /// The greatest acceleration of the floor itself (m/s2).
    floor_peak: f64,
    /// The greatest absolute acceleration (m/s2) of an oscillator of each period.
    accelerations: Vec<f64>,
}

/// The periods of the spectra (s).
fn periods() -> Vec<f64> {
    let ([shortest, longest], count) = PERIODS;
    let ratio: f64 = longest / shortest;
    (0..count)
        .map(|place| shortest * ratio.powf(place as f64 / (count - 1) as f64))
        .collect()
}

/// The floors of a case: histories of acceleration whose names say so, and the middles `O1` and `O2` of the
/// bottom floors.
fn floors(case: &CaseFiles) -> Vec<&str> {
    let names = case.histories.iter();
    let names = names.filter_map(|column| column.name.strip_suffix(".ax"));
    names
        .filter(|name| name.contains("floor") || ["O1", "O2"].contains(name))
        .collect()
}

/// The spectra of all floors of a case.
pub(super) fn of_case(case: &CaseFiles) -> Vec<FloorSpectrum> {
    let periods = periods();
    let mut found = Vec::new();
    let Some(time) = case.histories.first() else {
        return found;
    };
    for floor in floors(case) {
        for axis in AXES {
            let Some(motion) = column(&case.histories, &format!("{floor}.a{axis}")) else {
                continue;
            };
            let Some(history) = history_of(&time.values, &motion.values) else {
                continue;
            };
            for damping in DAMPINGS {
                let Ok(responses) = history.response_spectrum(damping, &periods) else {
                    continue;
                };
                found.push(FloorSpectrum {
                    case: case.outcome.name.clone(),
                    floor: floor.into(),
                    axis,
                    damping,
                    floor_peak: motion.values.iter().fold(0.0, |most, a| most.max(a.abs())),
                    accelerations: responses.iter().map(|found| found.acceleration).collect(),
                });
            }
        }
    }
    found
}

/// Writes the spectra of a case as a table.
pub(super) fn write(
    folder: &Path,
    case: &str,
    spectra: &[FloorSpectrum],
) -> Result<(), StudyError> {
    let own = || spectra.iter().filter(|found| found.case == case);
    if own().next().is_none() {
        return Ok(());
    }
    let mut columns = vec![TableColumn::new("period", "s", periods())];
    for found in own() {
        let damping = 100.0 * found.damping;
        let name = format!("{} {} {damping} %", found.floor, found.axis);
        columns.push(TableColumn::new(name, "m/s2", found.accelerations.clone()));
    }
    let file = folder.join(format!("floor-spectra-{case}.csv"));
    Ok(write_table(&file, &columns).map_err(powerhouse::Error::from)?)
}

/// Peak accelerations of the floors of a case, and the peaks of their spectra.
pub(super) fn table(case: &str, spectra: &[FloorSpectrum]) -> Table {
    let periods = periods();
    let own = spectra
        .iter()
        .filter(|found| found.case == case && found.damping == COMMON);
    let rows = own.map(|found| {
        let all = found.accelerations.iter().zip(&periods);
        let most = all.max_by(|a, b| a.0.total_cmp(b.0));
        let (most, period) = most.map_or((0.0, 0.0), |(most, period)| (*most, *period));
        vec![
            format!("{} {}", found.floor, found.axis),
            rounded(found.floor_peak),
            rounded(most),
            rounded(period),
        ]
    });
    Table {
        head: [
            "floor, direction",
            "greatest acceleration (m/s2)",
            "greatest of the 5 % spectrum (m/s2)",
            "at period (s)",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
    }
}

/// For each floor the spectra at 5 % of the cases of each kind of wave, and those of one case at several
/// dampings: a plot with its caption for each.
pub(super) fn plots(
    cases: &[CaseFiles],
    headline: &str,
    spectra: &[FloorSpectrum],
    folder: &Path,
) -> Result<Vec<(PathBuf, String)>, StudyError> {
    let mut names: Vec<&str> = Vec::new();
    for found in spectra {
        if !names.contains(&found.floor.as_str()) {
            names.push(&found.floor);
        }
    }
    let mut plots = Vec::new();
    for floor in names {
        for (kind, of_kind) in kinds(cases) {
            let is_one = |found: &FloorSpectrum| {
                let of_case = of_kind.iter().any(|case| case.outcome.name == found.case);
                of_case && found.damping == COMMON
            };
            let called = |found: &FloorSpectrum| found.case.clone();
            let file = folder.join(format!("spectra-{floor}-{kind}.svg"));
            if draw(&file, floor, spectra, is_one, called)? {
                let kind = kind.to_uppercase();
                plots.push((
                    file,
                    format!("Response spectra of {floor}, 5 %, {kind} waves"),
                ));
            }
        }
        let is_one = |found: &FloorSpectrum| found.case == headline;
        let called = |found: &FloorSpectrum| format!("{} %", 100.0 * found.damping);
        let file = folder.join(format!("spectra-{floor}-damping.svg"));
        if draw(&file, floor, spectra, is_one, called)? {
            plots.push((
                file,
                format!("Response spectra of {floor}, case {headline}"),
            ));
        }
    }
    Ok(plots)
}

/// Draws some spectra of a floor, a panel for each direction; whether there were any.
fn draw(
    file: &Path,
    floor: &str,
    spectra: &[FloorSpectrum],
    is_one: impl Fn(&FloorSpectrum) -> bool,
    called: impl Fn(&FloorSpectrum) -> String,
) -> Result<bool, StudyError> {
    let mut periods = periods();
    periods.retain(|period| *period <= DRAWN);
    let drawn: Vec<(&FloorSpectrum, String)> = (spectra.iter())
        .filter(|found| found.floor == floor && is_one(found))
        .map(|found| (found, called(found)))
        .collect();
    let panels: Vec<PlotPanel> = (AXES.iter())
        .map(|axis| {
            let own = drawn.iter().filter(|(found, _)| found.axis == *axis);
            PlotPanel {
                label: format!("acceleration along {axis}"),
                unit: "m/s2".into(),
                curves: own
                    .map(|(found, name)| PlotCurve {
                        name,
                        x: &periods,
                        y: &found.accelerations[..periods.len()],
                    })
                    .collect(),
            }
        })
        .filter(|panel| !panel.curves.is_empty())
        .collect();
    if panels.is_empty() {
        return Ok(false);
    }
    let plot = Plot {
        title: String::new(),
        label: "period".into(),
        unit: "s".into(),
        panels,
    };
    write_plot(file, &plot).map_err(powerhouse::Error::from)?;
    Ok(true)
}
