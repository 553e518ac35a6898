//! Section of a report on the recorded accelerations of a run: intensities, response and Fourier spectra, Husid plots.

use std::path::Path;

use powerhouse::io::TableColumn;

use super::PLOTS;
use super::ReportTable;
use super::page::Page;
use crate::motion::{DAMPINGS, Measure, MotionPlot, RecordedMotions};
use powerhouse_study::StudyError;
use powerhouse_study::internal::rounded;

/// Columns with a peak below this share of the greatest of their history are left out: directions without motion.
const STILL: f64 = 1e-2;

/// Adds the section, if there are accelerations; the plots are in the folder of the report.
pub(super) fn section(
    page: &mut Page,
    folder: &Path,
    warnings: &[String],
) -> Result<(), StudyError> {
    let Ok(motions) = RecordedMotions::of_folder(folder) else {
        return Ok(());
    };
    let moving = moving(motions.columns());
    if moving.is_empty() {
        return Ok(());
    }
    page.section("Spectra of the accelerations");
    page.warnings(warnings);
    let mut rows = Vec::new();
    for column in &moving {
        let Ok(motion) = motions.acceleration(column) else {
            continue;
        };
        let duration = motion.significant_duration(0.05, 0.95)?;
        rows.push(vec![
            column.name.clone(),
            rounded(
                motion
                    .acceleration()
                    .iter()
                    .fold(0.0, |most, a| most.max(a.abs())),
            ),
            rounded(motion.arias_intensity()),
            rounded(duration),
        ]);
    }
    page.table(&ReportTable {
        header: [
            "history",
            "peak (m/s2)",
            "Arias intensity (m/s)",
            "5 to 95 % of it (s)",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
    });
    let mut plots = Vec::new();
    for column in moving {
        for (measure, what) in [
            (
                Measure::Response,
                "response spectrum at 2, 5 and 10 % of critical damping",
            ),
            (Measure::Fourier, "Fourier amplitude"),
            (Measure::Husid, "share of the Arias intensity"),
        ] {
            let name = powerhouse::file_name(&format!("{}-{}", column.name, measure.name()));
            let file = folder.join(PLOTS).join(format!("{name}.svg"));
            let drawn = MotionPlot {
                measure,
                columns: vec![column],
                dampings: DAMPINGS.into(),
            };
            let [plot, _] = motions.write(&drawn, Some(&file))?;
            plots.push((plot, format!("{}: {what}", column.name)));
        }
    }
    page.pairs(plots)
}

fn peak(column: &TableColumn) -> f64 {
    column.values.iter().fold(0.0, |most, a| most.max(a.abs()))
}

/// Accelerations but for directions in which a history hardly moves.
fn moving(columns: &[TableColumn]) -> Vec<&TableColumn> {
    let base = |column: &TableColumn| {
        column
            .name
            .rsplit_once('.')
            .map(|(base, _)| base.to_owned())
    };
    let accelerations = || columns.iter().filter(|column| column.unit == "m/s2");
    let most = |of: &TableColumn| {
        let same = accelerations().filter(|other| base(other) == base(of));
        same.map(peak).fold(0.0, f64::max)
    };
    accelerations()
        .filter(|column| peak(column) > STILL * most(column))
        .collect()
}
