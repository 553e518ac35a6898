//! Plots of a record and its Fourier spectrum.

use std::path::{Path, PathBuf};

use powerhouse::io::{Plot, PlotCurve, PlotPanel, TableColumn, write_plot};
use powerhouse::wavefield::{SpectralLine, TimeHistory};

use powerhouse_study::StudyError;
use powerhouse_study::internal::even_samples;

/// Highest drawn frequency (Hz).
const HIGHEST: f64 = 15.0;

/// Draws a record (time and acceleration) and its Fourier amplitude spectrum; `None` if it has too few samples. The end
/// of the runs (s) is marked if it is before the end of the record.
pub(super) fn plots(
    record: &[TableColumn],
    end: Option<f64>,
    folder: &Path,
) -> Result<Option<[PathBuf; 2]>, StudyError> {
    let (time, acceleration) = (&record[0].values, &record[1].values);
    let Some(lines) = even_samples(time, acceleration) else {
        return Ok(None);
    };
    let lines = TimeHistory::fourier_spectrum(&lines).into_iter();
    let (frequencies, amplitudes): (Vec<f64>, Vec<f64>) = lines
        .take_while(|line| line.frequency <= HIGHEST)
        .map(
            |SpectralLine {
                 frequency,
                 amplitude,
             }| (frequency, amplitude),
        )
        .unzip();
    let last = time.last().copied().unwrap_or(0.0);
    let end = end.filter(|end| *end < last).map(|end| [end, end]);
    let most = acceleration
        .iter()
        .fold(0.0_f64, |most, a| most.max(a.abs()));
    let height = [-most, most];
    let mark = end.as_ref().map(|end| PlotCurve {
        name: "end of the runs",
        x: end,
        y: &height,
    });
    let draw = |name: &str, (label, unit): (&str, &str), (what, of): (&str, &str), x, y| {
        let plot = Plot {
            title: String::new(),
            label: label.into(),
            unit: unit.into(),
            panels: vec![PlotPanel {
                label: what.into(),
                unit: of.into(),
                curves: std::iter::once(PlotCurve {
                    name: &record[1].name,
                    x,
                    y,
                })
                .chain(mark.filter(|_| name == "record"))
                .collect(),
            }],
            gaps: Vec::new(),
        };
        let file = folder.join(format!("{name}-{}.svg", record[1].name));
        write_plot(&file, &plot).map_err(powerhouse::Error::from)?;
        Ok::<_, StudyError>(file)
    };
    Ok(Some([
        draw(
            "record",
            ("time", "s"),
            ("acceleration", "m/s2"),
            time,
            acceleration,
        )?,
        draw(
            "spectrum",
            ("frequency", "Hz"),
            ("Fourier amplitude", "m/s"),
            &frequencies,
            &amplitudes,
        )?,
    ]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The plot of a record marks the end of the runs if it is before the end of the record, and only then.
    #[test]
    fn the_end_of_runs_is_marked() {
        let name = format!("powerhouse-record-plot-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        let times: Vec<f64> = (0..200).map(|i| 0.01 * f64::from(i)).collect();
        let motion = times.iter().map(|time| (20.0 * time).sin()).collect();
        let record = [
            TableColumn::new("time", "s", times),
            TableColumn::new("quake", "m/s2", motion),
        ];
        for (end, marked) in [(Some(0.5), true), (Some(5.0), false), (None, false)] {
            let [time, spectrum] = plots(&record, end, &folder).unwrap().unwrap();
            let has_mark = |file: PathBuf| {
                let text = std::fs::read_to_string(file).unwrap();
                text.contains("end of the runs")
            };
            assert_eq!(has_mark(time), marked, "{end:?}");
            assert!(!has_mark(spectrum));
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}
