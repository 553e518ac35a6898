//! A record and its Fourier spectrum.

use std::path::{Path, PathBuf};

use powerhouse::io::{Plot, PlotCurve, PlotPanel, TableColumn, write_plot};
use powerhouse::wavefield::{SpectralLine, TimeHistory};

use super::history_of;
use crate::StudyError;

/// The highest frequency that is drawn (Hz).
const HIGHEST: f64 = 15.0;

/// Draws a record (time and acceleration) and the amplitude of its Fourier transform; nothing if it has
/// too few samples.
pub(super) fn plots(
    record: &[TableColumn],
    folder: &Path,
) -> Result<Option<[PathBuf; 2]>, StudyError> {
    let (time, acceleration) = (&record[0].values, &record[1].values);
    let Some(lines) = history_of(time, acceleration) else {
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
    let draw = |name: &str, (label, unit): (&str, &str), (what, of): (&str, &str), x, y| {
        let plot = Plot {
            title: String::new(),
            label: label.into(),
            unit: unit.into(),
            panels: vec![PlotPanel {
                label: what.into(),
                unit: of.into(),
                curves: vec![PlotCurve {
                    name: &record[1].name,
                    x,
                    y,
                }],
            }],
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
