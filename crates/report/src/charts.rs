//! Plots of a report.

use std::path::{Path, PathBuf};

use powerhouse::file_name;
use powerhouse::io::{Plot, PlotCurve, PlotPanel, write_plot};

use super::{ReportCase, column, kinds};
use powerhouse_study::StudyError;
use powerhouse_study::sweep::Peak;

/// Name of the point whose history is drawn for all cases.
const POINT: &str = "A";
/// Displacements below this share of the greatest are not drawn.
const STILL: f64 = 1e-3;
/// Components below this share of the largest are rounding errors.
const ROUNDING: f64 = 1e-12;

/// Plots of peaks against the angle of incidence, one for each kind of wave with several angles.
pub(super) fn by_angle(
    cases: &[ReportCase],
    folder: &Path,
    what: &str,
) -> Result<Vec<(PathBuf, String)>, StudyError> {
    let (label, unit, scale) = match what {
        "stress" => ("greatest principal stress", "MPa", 1e-6),
        _ => ("greatest relative displacement", "mm", 1e3),
    };
    let of = |case: &ReportCase| -> Vec<Peak> {
        match what {
            "stress" => case.outcome.stresses.clone(),
            _ => case.outcome.relative.clone(),
        }
    };
    let mut plots = Vec::new();
    for (kind, of_kind) in kinds(cases) {
        let mut known: Vec<(f64, Vec<Peak>)> = (of_kind.iter())
            .filter_map(|case| Some((case.outcome.input.wave()?.1, of(case))))
            .collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [Some(first), Some(last)] = [known.first(), known.last()] else {
            continue;
        };
        // Several cases of one angle differ in their records.
        if first.0 == last.0 || first.1.is_empty() {
            continue;
        }
        let angles: Vec<f64> = known.iter().map(|(angle, _)| *angle).collect();
        let names: Vec<String> = known[0].1.iter().map(|peak| peak.name.clone()).collect();
        let values: Vec<Vec<f64>> = (0..names.len())
            .map(|index| {
                let peaks = known.iter().map(|(_, peaks)| peaks.get(index));
                peaks
                    .map(|peak| peak.map_or(0.0, |peak| scale * peak.value))
                    .collect()
            })
            .collect();
        let curves = names.iter().zip(&values);
        let plot = Plot {
            title: String::new(),
            label: "angle of incidence".into(),
            unit: "degrees".into(),
            panels: vec![PlotPanel {
                label: label.into(),
                unit: unit.into(),
                curves: curves
                    .map(|(name, y)| PlotCurve {
                        name,
                        x: &angles,
                        y,
                    })
                    .collect(),
            }],
            gaps: Vec::new(),
        };
        let file = folder.join(format!("{what}-{kind}.svg"));
        write_plot(&file, &plot).map_err(powerhouse::Error::from)?;
        plots.push((file, format!("{label}, {} waves", kind.to_uppercase())));
    }
    Ok(plots)
}

/// The greatest displacement of the crown over all cases (m); zero without one.
fn greatest_displacement(cases: &[ReportCase]) -> f64 {
    let peaks = cases.iter().flat_map(|case| &case.outcome.displacements);
    let own = peaks.filter(|peak| peak.name == POINT);
    own.fold(0.0, |most, peak| most.max(peak.value))
}

/// Plots of a history of the crown, one for each kind of wave.
pub(super) fn histories(
    cases: &[ReportCase],
    folder: &Path,
    component: &str,
) -> Result<Vec<(PathBuf, String)>, StudyError> {
    let (name, unit, scale, label) = match component {
        ".s1" => (
            format!("{POINT}-concrete.s1"),
            "MPa",
            1e-6,
            "greatest principal stress",
        ),
        ".uz" => (format!("{POINT}.uz"), "mm", 1e3, "displacement upwards"),
        ".uy" => (format!("{POINT}.uy"), "mm", 1e3, "displacement along"),
        other => (format!("{POINT}{other}"), "mm", 1e3, "displacement across"),
    };
    let least = match component {
        ".s1" => f64::NEG_INFINITY,
        _ => STILL * scale * greatest_displacement(cases),
    };
    let mut plots = Vec::new();
    for (kind, of_kind) in kinds(cases) {
        let series: Vec<(&str, &[f64], Vec<f64>)> = of_kind
            .into_iter()
            .filter_map(|case| {
                let time = case.histories.first()?;
                let column = column(&case.histories, &name)?;
                let values = column.values.iter().map(|value| scale * value);
                Some((&*case.outcome.name, &*time.values, values.collect()))
            })
            .collect();
        let greatest = series.iter().flat_map(|(.., values)| values);
        let greatest = greatest.fold(0.0_f64, |most, value| most.max(value.abs()));
        // These waves do not move the crown along this axis.
        if series.is_empty() || greatest <= least {
            continue;
        }
        let plot = Plot {
            title: String::new(),
            label: "time".into(),
            unit: "s".into(),
            panels: vec![PlotPanel {
                label: format!("{label} at {POINT}"),
                unit: unit.into(),
                curves: (series.iter())
                    .map(|(name, x, y)| PlotCurve { name, x, y })
                    .collect(),
            }],
            gaps: Vec::new(),
        };
        let file = folder.join(format!("history{}-{kind}.svg", component.replace('.', "-")));
        write_plot(&file, &plot).map_err(powerhouse::Error::from)?;
        let caption = format!("{label} ({name}), {} waves", kind.to_uppercase());
        plots.push((file, caption));
    }
    Ok(plots)
}

/// Plots of the histories of a general scene: one for each point and quantity, with a panel for each moving component
/// and a curve for each case.
pub(super) fn all_histories(
    cases: &[ReportCase],
    folder: &Path,
) -> Result<Vec<(PathBuf, String)>, StudyError> {
    // Point, first letter of its components, and unit: displacements, velocities, accelerations, stresses.
    let mut groups: Vec<(String, String, String)> = Vec::new();
    for column in cases.iter().flat_map(|case| case.histories.iter().skip(1)) {
        let (point, component) = column.name.rsplit_once('.').unwrap_or((&column.name, ""));
        let kind = component.get(..1).unwrap_or("").to_owned();
        let group = (point.to_owned(), kind, column.unit.clone());
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    let mut plots = Vec::new();
    for (point, kind, unit) in groups {
        let mut components: Vec<&str> = Vec::new();
        for column in cases.iter().flat_map(|case| case.histories.iter().skip(1)) {
            let (own, component) = column.name.rsplit_once('.').unwrap_or((&column.name, ""));
            let is_one = own == point && component.starts_with(&kind) && column.unit == unit;
            if is_one && !components.contains(&component) {
                components.push(component);
            }
        }
        let curves = |component: &str| -> Vec<PlotCurve> {
            let name = match component {
                "" => point.clone(),
                component => format!("{point}.{component}"),
            };
            let of = cases.iter().filter_map(|case| {
                Some(PlotCurve {
                    name: &case.outcome.name,
                    x: &case.histories.first()?.values,
                    y: &column(&case.histories, &name)?.values,
                })
            });
            of.collect()
        };
        let mut panels: Vec<PlotPanel> = (components.iter())
            .map(|component| PlotPanel {
                label: (*component).to_owned(),
                unit: unit.clone(),
                curves: curves(component),
            })
            .collect();
        let greatest = |panel: &PlotPanel| {
            let values = panel.curves.iter().flat_map(|curve| curve.y);
            values.fold(0.0_f64, |most, value| most.max(value.abs()))
        };
        let most = panels.iter().map(greatest).fold(0.0, f64::max);
        panels.retain(|panel| greatest(panel) > ROUNDING * most);
        if panels.is_empty() {
            continue;
        }
        let drawn: Vec<String> = panels.iter().map(|panel| panel.label.clone()).collect();
        let plot = Plot {
            title: String::new(),
            label: "time".into(),
            unit: "s".into(),
            panels,
            gaps: Vec::new(),
        };
        let name = file_name(&format!("{point}-{kind}-{unit}"));
        let file = folder.join(format!("history-{name}.svg"));
        write_plot(&file, &plot).map_err(powerhouse::Error::from)?;
        plots.push((file, format!("{point}: {} ({unit})", drawn.join(", "))));
    }
    Ok(plots)
}
