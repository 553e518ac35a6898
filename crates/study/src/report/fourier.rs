//! A record and its Fourier spectrum.

use std::path::{Path, PathBuf};

use powerhouse::io::{Plot, PlotCurve, PlotPanel, TableColumn, write_plot};

use crate::StudyError;

/// The highest frequency that is drawn (Hz).
const HIGHEST: f64 = 15.0;
/// Frequencies that are drawn.
const FREQUENCIES: usize = 600;

/// Draws a record (time and acceleration) and the amplitude of its Fourier transform.
pub(super) fn plots(record: &[TableColumn], folder: &Path) -> Result<[PathBuf; 2], StudyError> {
    let (time, acceleration) = (&record[0].values, &record[1].values);
    let frequencies: Vec<f64> = (1..=FREQUENCIES)
        .map(|place| HIGHEST * place as f64 / FREQUENCIES as f64)
        .collect();
    let step = match time[..] {
        [first, second, ..] => second - first,
        _ => 0.0,
    };
    let spectrum: Vec<f64> = (frequencies.iter())
        .map(|frequency| amplitude(acceleration, step, *frequency))
        .collect();
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
    Ok([
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
            &spectrum,
        )?,
    ])
}

/// `|sum a exp(-i 2 pi f t)| dt`, by a recurrence of rotations.
fn amplitude(samples: &[f64], step: f64, frequency: f64) -> f64 {
    let (sine, cosine) = (core::f64::consts::TAU * frequency * step).sin_cos();
    let (mut real, mut imaginary) = (0.0, 0.0);
    let (mut c, mut s) = (1.0, 0.0);
    for sample in samples {
        real += sample * c;
        imaginary -= sample * s;
        (c, s) = (c * cosine - s * sine, s * cosine + c * sine);
    }
    step * f64::hypot(real, imaginary)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A whole number of sines has half its duration as amplitude at its frequency, and none at
    /// another whole number.
    #[test]
    fn a_sine_stands_at_its_frequency() {
        let (step, count) = (0.01, 1000);
        let wave = |k: usize| (core::f64::consts::TAU * 2.0 * k as f64 * step).sin();
        let samples: Vec<f64> = (0..count).map(wave).collect();
        assert!((amplitude(&samples, step, 2.0) - 5.0).abs() < 1e-9);
        assert!(amplitude(&samples, step, 3.0) < 1e-9);
    }
}
