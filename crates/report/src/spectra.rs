//! Floor response spectra.

use std::path::{Path, PathBuf};

use powerhouse::io::{Plot, PlotCurve, PlotPanel, TableColumn, write_noted_table, write_plot};
use powerhouse::wavefield::TimeHistory;

use super::ReportTable;
use super::{ReportCase, column, kinds};
use crate::floor::FloorEnvelope;
use crate::motion::{DAMPINGS, periods};
use powerhouse_study::StudyError;
use powerhouse_study::internal::rounded;

/// Damping ratio at which cases are compared.
const COMMON: f64 = 0.05;
/// Longest drawn period (s).
const DRAWN: f64 = 1.5;
/// Evaluated directions.
const AXES: [char; 3] = ['x', 'y', 'z'];
/// Directions with a peak acceleration below this share of the greatest are left out.
const STILL: f64 = 1e-2;
/// Frequency (Hz) of an oscillator that follows the floor: what it bears is the peak of the floor.
const STIFF: f64 = 33.0;

/// Share by which the peaks of envelopes are broadened to both sides.
const BROADENED: f64 = 0.15;
/// Lowest drawn frequency of envelopes (Hz).
const LOWEST: f64 = 1.0;

/// Floor response spectra of several cases.
pub(super) struct FloorSpectra {
    /// Periods of all spectra (s).
    periods: Vec<f64>,
    /// Period (s) of the oscillator that bears the peak of the floor.
    stiff: f64,
    all: Vec<FloorSpectrum>,
    /// The greatest of all cases with broadened peaks (m/s2), after their frequencies (Hz); and of which floor and axis each
    /// is.
    envelope: (TableColumn, Vec<(String, char, TableColumn)>),
}

/// Response spectrum of a floor of a case in one direction at one damping ratio.
struct FloorSpectrum {
    case: String,
    floor: String,
    axis: char,
    damping: f64,
    /// Peak absolute acceleration (m/s2) of a stiff oscillator, that of [`STIFF`], which follows the floor.
    floor_peak: f64,
    /// Peak absolute acceleration (m/s2) of an oscillator for each period.
    accelerations: Vec<f64>,
}

/// The floors of a case: acceleration histories with `floor` in their names, and the centres `O1` and `O2` of the
/// bottom floors.
fn floors(case: &ReportCase) -> Vec<&str> {
    let names = case.accelerations.columns().iter();
    let names = names.filter_map(|column| column.name.strip_suffix(".ax"));
    names
        .filter(|name| name.contains("floor") || ["O1", "O2"].contains(name))
        .collect()
}

/// Acceleration history of a floor along an axis.
struct FloorMotion<'c> {
    case: &'c str,
    floor: &'c str,
    axis: char,
    history: TimeHistory,
    /// Shortest period (s) for which it holds.
    shortest: f64,
    /// Peak of the recorded acceleration (m/s2).
    peak: f64,
}

/// The acceleration histories of the floors of a case, without directions in which they hardly move.
fn motions(case: &ReportCase) -> Vec<FloorMotion<'_>> {
    let mut found = Vec::new();
    for floor in floors(case) {
        let along = AXES.map(|axis| {
            let recorded = &case.accelerations;
            let motion = column(recorded.columns(), &format!("{floor}.a{axis}"))?;
            Some(FloorMotion {
                case: &case.outcome.name,
                floor,
                axis,
                history: recorded.history(motion, usize::MAX)?,
                shortest: recorded.shortest_period(),
                peak: motion.values.iter().fold(0.0, |most, a| most.max(a.abs())),
            })
        });
        let along: Vec<FloorMotion> = along.into_iter().flatten().collect();
        let most = along
            .iter()
            .fold(0.0_f64, |most, motion| most.max(motion.peak));
        let moving = along.into_iter();
        found.extend(moving.filter(|motion| motion.peak > STILL * most));
    }
    found
}

/// The greatest spectra of the motions of each floor and axis over frequency, with broadened peaks, up to that of the shortest
/// period (s).
fn envelope(
    motions: &[FloorMotion],
    shortest: f64,
) -> (TableColumn, Vec<(String, char, TableColumn)>) {
    let of_frequency = FloorEnvelope::new(shortest, BROADENED);
    let mut places: Vec<(&str, char)> = Vec::new();
    for motion in motions {
        if !places.contains(&(motion.floor, motion.axis)) {
            places.push((motion.floor, motion.axis));
        }
    }
    places.sort_unstable();
    let mut envelopes = Vec::new();
    for (floor, axis) in places {
        let own = motions
            .iter()
            .filter(|one| (one.floor, one.axis) == (floor, axis));
        let histories: Vec<TimeHistory> = own.map(|motion| motion.history.clone()).collect();
        for damping in DAMPINGS {
            let Ok(ordinates) = of_frequency.ordinates(&histories, damping) else {
                continue;
            };
            let name = format!("{floor} {axis} {} %", 100.0 * damping);
            envelopes.push((
                floor.into(),
                axis,
                TableColumn::new(name, "m/s2", ordinates),
            ));
        }
    }
    let frequencies = TableColumn::new("frequency", "Hz", of_frequency.frequencies);
    (frequencies, envelopes)
}

impl FloorSpectra {
    /// Computes the spectra of all floors of several cases.
    pub(super) fn of(cases: &[ReportCase]) -> Self {
        let motions: Vec<FloorMotion> = cases.iter().flat_map(motions).collect();
        let shortest = motions.iter().map(|motion| motion.shortest);
        let periods = periods(shortest.fold(0.0, f64::max));
        let stiff = periods[0].max(1.0 / STIFF);
        let spectra = motions.iter().flat_map(|motion| {
            let peak = motion.history.response_spectrum(COMMON, &[stiff]);
            let peak = peak.map_or(f64::NAN, |found| found[0].acceleration);
            let at = |damping: f64| {
                let responses = motion.history.response_spectrum(damping, &periods).ok()?;
                Some(FloorSpectrum {
                    case: motion.case.into(),
                    floor: motion.floor.into(),
                    axis: motion.axis,
                    damping,
                    floor_peak: peak,
                    accelerations: responses.iter().map(|found| found.acceleration).collect(),
                })
            };
            DAMPINGS.map(at).into_iter().flatten()
        });
        let all = spectra.collect();
        Self {
            envelope: envelope(&motions, periods[0]),
            periods,
            stiff,
            all,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Shortest period (s).
    pub(super) fn shortest(&self) -> f64 {
        self.periods[0]
    }

    /// Writes the spectra of a case as a CSV table, below what they are of and a warning.
    pub(super) fn write(
        &self,
        folder: &Path,
        case: &ReportCase,
        warning: Option<&str>,
    ) -> Result<(), StudyError> {
        let note = case.accelerations.note();
        let case = &case.outcome.name;
        let own = || self.all.iter().filter(|found| found.case == *case);
        if own().next().is_none() {
            return Ok(());
        }
        let mut columns = vec![TableColumn::new("period", "s", self.periods.clone())];
        for found in own() {
            let damping = 100.0 * found.damping;
            let name = format!("{} {} {damping} %", found.floor, found.axis);
            columns.push(TableColumn::new(name, "m/s2", found.accelerations.clone()));
        }
        let file = folder.join(format!("floor-spectra-{case}.csv"));
        let warning = warning.map(|text| format!("warning: {text}"));
        let notes: Vec<String> = warning.into_iter().chain([note]).collect();
        Ok(write_noted_table(&file, &notes, &columns).map_err(powerhouse::Error::from)?)
    }

    /// Writes the greatest spectra of all cases, with broadened peaks, as a CSV table below the notes; returns the plots of the
    /// floors with their captions.
    pub(super) fn write_envelope(
        &self,
        folder: &Path,
        notes: &[String],
    ) -> Result<Vec<(PathBuf, String)>, StudyError> {
        let (frequencies, envelopes) = &self.envelope;
        let columns = envelopes.iter().map(|(_, _, column)| column.clone());
        let columns: Vec<TableColumn> = std::iter::once(frequencies.clone())
            .chain(columns)
            .collect();
        let file = folder.join("floor-spectra-broadened.csv");
        write_noted_table(&file, notes, &columns).map_err(powerhouse::Error::from)?;
        let from = frequencies.values.partition_point(|f| *f < LOWEST);
        let mut plots = Vec::new();
        for of_floor in envelopes.chunk_by(|a, b| a.0 == b.0) {
            let floor = &of_floor[0].0;
            let plot = Plot {
                title: String::new(),
                label: "frequency".into(),
                unit: "Hz".into(),
                panels: (of_floor.chunk_by(|a, b| a.1 == b.1))
                    .map(|of_axis| PlotPanel {
                        label: format!("acceleration along {}", of_axis[0].1),
                        unit: "m/s2".into(),
                        curves: of_axis
                            .iter()
                            .map(|(_, _, column)| PlotCurve {
                                name: &column.name,
                                x: &frequencies.values[from..],
                                y: &column.values[from..],
                            })
                            .collect(),
                    })
                    .collect(),
                gaps: Vec::new(),
            };
            let file = folder.join(format!("spectra-{floor}-broadened.svg"));
            write_plot(&file, &plot).map_err(powerhouse::Error::from)?;
            let share = 100.0 * BROADENED;
            plots.push((
                file,
                format!("Greatest of all cases at {floor}, peaks broadened by {share} %"),
            ));
        }
        Ok(plots)
    }

    /// The table of the peak accelerations of the floors of a case and the peaks of their spectra.
    pub(super) fn table(&self, case: &str) -> ReportTable {
        let own = self.all.iter();
        let own = own.filter(|found| found.case == case && found.damping == COMMON);
        let rows = own.map(|found| {
            let all = found.accelerations.iter().zip(&self.periods);
            let most = all.max_by(|a, b| a.0.total_cmp(b.0));
            let (most, period) = most.map_or((0.0, 0.0), |(most, period)| (*most, *period));
            vec![
                format!("{} {}", found.floor, found.axis),
                rounded(found.floor_peak),
                rounded(most),
                rounded(period),
            ]
        });
        ReportTable {
            header: vec![
                "floor, direction".into(),
                format!(
                    "peak: 5 % spectrum at {} Hz (m/s2)",
                    rounded(1.0 / self.stiff)
                ),
                "greatest of the 5 % spectrum (m/s2)".into(),
                "at period (s)".into(),
            ],
            rows: rows.collect(),
        }
    }

    /// Plots with their captions for each floor: the spectra at 5 % damping of the cases of each kind of wave, and those
    /// of the headline case at several damping ratios.
    pub(super) fn plots(
        &self,
        cases: &[ReportCase],
        headline: &str,
        folder: &Path,
    ) -> Result<Vec<(PathBuf, String)>, StudyError> {
        let mut names: Vec<&str> = Vec::new();
        for found in &self.all {
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
                let label = |found: &FloorSpectrum| found.case.clone();
                let file = folder.join(format!("spectra-{floor}-{kind}.svg"));
                if self.draw((&file, floor), is_one, label)? {
                    let kind = kind.to_uppercase();
                    plots.push((
                        file,
                        format!("Response spectra of {floor}, 5 %, {kind} waves"),
                    ));
                }
            }
            let is_one = |found: &FloorSpectrum| found.case == headline;
            let label = |found: &FloorSpectrum| format!("{} %", 100.0 * found.damping);
            let file = folder.join(format!("spectra-{floor}-damping.svg"));
            if self.draw((&file, floor), is_one, label)? {
                plots.push((
                    file,
                    format!("Response spectra of {floor}, case {headline}"),
                ));
            }
        }
        Ok(plots)
    }

    /// Draws the selected spectra of a floor with a panel for each direction; returns whether there were any.
    fn draw(
        &self,
        (file, floor): (&Path, &str),
        is_one: impl Fn(&FloorSpectrum) -> bool,
        label: impl Fn(&FloorSpectrum) -> String,
    ) -> Result<bool, StudyError> {
        let mut periods = self.periods.clone();
        periods.retain(|period| *period <= DRAWN);
        let drawn: Vec<(&FloorSpectrum, String)> = (self.all.iter())
            .filter(|found| found.floor == floor && is_one(found))
            .map(|found| (found, label(found)))
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
            gaps: Vec::new(),
        };
        write_plot(file, &plot).map_err(powerhouse::Error::from)?;
        Ok(true)
    }
}
