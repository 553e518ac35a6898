//! Statistics of a sweep over a set of records: tables of fractiles and envelopes, fragility curves.

use std::path::{Path, PathBuf};

use powerhouse::file_name;
use powerhouse::io::{Plot, PlotCurve, PlotPanel, write_plot};
use powerhouse_study::StudyError;
use powerhouse_study::internal::rounded;
use powerhouse_study::sweep::{FragilityResult, ScaleStatistics, SetStatistics};

use super::ReportTable;
use super::tables::header;

/// Number of points of a drawn curve.
const POINTS: usize = 200;

/// Scale and number of cases.
pub(super) fn heading(scale: &ScaleStatistics) -> String {
    let all = scale.finished + scale.missing.len();
    format!("Scale {}: {} of {all} cases", scale.scale, scale.finished)
}

/// Warning about cases without results.
pub(super) fn missing(scale: &ScaleStatistics) -> Option<String> {
    (!scale.missing.is_empty()).then(|| {
        format!(
            "at scale {} the statistics are those of {} cases without {}, which have no results",
            scale.scale,
            scale.finished,
            scale.missing.join(", ")
        )
    })
}

/// Fractiles of all results at a scale, in the units that their names have.
pub(super) fn figures(scale: &ScaleStatistics) -> ReportTable {
    let rows = scale.figures.iter().map(|figure| {
        let head = [figure.figure.clone(), figure.count.to_string()];
        head.into_iter().chain(figure.shown()).collect()
    });
    ReportTable {
        header: header(&["result", "cases", "16 %", "median", "84 %"]),
        rows: rows.collect(),
    }
}

/// Envelopes of section forces at all scales; `None` without sections.
pub(super) fn envelopes(found: &SetStatistics) -> Option<ReportTable> {
    let rows = found.scales.iter().flat_map(|scale| {
        scale.envelopes.iter().map(move |envelope| {
            let forces = [envelope.axial, envelope.shear, envelope.moment];
            let forces = forces
                .into_iter()
                .flatten()
                .map(|value| rounded(1e-3 * value));
            let names = [envelope.section.clone(), scale.scale.to_string()];
            names.into_iter().chain(forces).collect()
        })
    });
    let rows: Vec<Vec<String>> = rows.collect();
    (!rows.is_empty()).then(|| ReportTable {
        header: header(&[
            "section",
            "scale",
            "least N",
            "greatest N",
            "least Q",
            "greatest Q",
            "least M",
            "greatest M",
        ]),
        rows,
    })
}

/// Parameters of the fragility curves with their intervals, or why there is none.
pub(super) fn fragility(found: &SetStatistics) -> ReportTable {
    let interval = |value: f64, [low, high]: [f64; 2]| {
        format!("{} ({} to {})", rounded(value), rounded(low), rounded(high))
    };
    let rows = found.fragility.iter().map(|fragility| {
        let side = if fragility.limit < 0.0 {
            "below"
        } else {
            "above"
        };
        let [median, dispersion] = match (&fragility.curve, &fragility.refused) {
            (Some(curve), _) => [
                interval(curve.median, curve.median_interval),
                interval(curve.dispersion, curve.dispersion_interval),
            ],
            (None, refused) => [
                format!("none: {}", refused.as_deref().unwrap_or_default()),
                String::new(),
            ],
        };
        vec![
            fragility.name.clone(),
            format!("{} {side} {}", fragility.figure, rounded(fragility.limit)),
            fragility.measure.clone(),
            format!("{} of {}", fragility.exceeded(), fragility.runs.len()),
            median,
            dispersion,
        ]
    });
    ReportTable {
        header: header(&[
            "curve",
            "limit",
            "intensity",
            "exceeded in",
            "median",
            "dispersion",
        ]),
        rows: rows.collect(),
    }
}

/// Plots of the fragility curves up to the greatest intensity of their runs, each with its caption.
pub(super) fn curves(
    found: &SetStatistics,
    folder: &Path,
) -> Result<Vec<(PathBuf, String)>, StudyError> {
    let fitted = found
        .fragility
        .iter()
        .filter(|fragility| fragility.curve.is_some());
    fitted.map(|fragility| curve(fragility, folder)).collect()
}

/// Mean intensities of groups of runs by rising intensity, and the shares of their runs that exceed the limit: runs of equal
/// intensity are in one group, and each has a sixth of the runs at least, but for the last.
fn observed(fragility: &FragilityResult) -> [Vec<f64>; 2] {
    const GROUPS: usize = 6;
    let least = fragility.runs.len().div_ceil(GROUPS);
    let (mut intensities, mut shares) = (Vec::new(), Vec::new());
    let mut rest = &fragility.runs[..];
    while !rest.is_empty() {
        let mut count = least.min(rest.len());
        while count < rest.len() && rest[count].intensity == rest[count - 1].intensity {
            count += 1;
        }
        let (group, others) = rest.split_at(count);
        let sum: f64 = group.iter().map(|run| run.intensity).sum();
        let exceeding = group.iter().filter(|run| run.exceeds).count();
        intensities.push(sum / count as f64);
        shares.push(exceeding as f64 / count as f64);
        rest = others;
    }
    [intensities, shares]
}

fn curve(fragility: &FragilityResult, folder: &Path) -> Result<(PathBuf, String), StudyError> {
    let greatest = fragility.runs.iter().map(|run| run.intensity);
    let greatest = greatest.fold(0.0, f64::max);
    let places = (1..=POINTS).map(|point| greatest * point as f64 / POINTS as f64);
    let places: Vec<f64> = places.collect();
    let probability = |place: &f64| {
        fragility
            .curve
            .map_or(0.0, |curve| curve.probability(*place))
    };
    let probabilities: Vec<f64> = places.iter().map(probability).collect();
    let groups = observed(fragility);
    let (label, unit) = match fragility.measure.split_once(" [") {
        Some((label, unit)) => (label, unit.trim_end_matches(']')),
        None => (fragility.measure.as_str(), ""),
    };
    let plot = Plot {
        title: String::new(),
        label: label.into(),
        unit: unit.into(),
        panels: vec![PlotPanel {
            label: "probability of exceedance".into(),
            unit: String::new(),
            curves: vec![
                PlotCurve {
                    name: &fragility.name,
                    x: &places,
                    y: &probabilities,
                },
                PlotCurve {
                    name: "share of the runs",
                    x: &groups[0],
                    y: &groups[1],
                },
            ],
        }],
        gaps: Vec::new(),
    };
    let file = folder.join(format!("fragility-{}.svg", file_name(&fragility.name)));
    write_plot(&file, &plot).map_err(powerhouse::Error::from)?;
    Ok((file, format!("Fragility curve {}", fragility.name)))
}
