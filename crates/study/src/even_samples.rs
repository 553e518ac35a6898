//! Accelerations at equal intervals, from which spectra are.

use std::path::Path;

use powerhouse::io::{TableColumn, read_table};
use powerhouse::wavefield::TimeHistory;

use crate::StudyError;
use crate::rounded::rounded;

/// Name of the table of band-limited accelerations, and of that of histories.
const FILES: [&str; 2] = ["accelerations.csv", "histories.csv"];
/// Rows of band-limited accelerations to a period of the band.
const ROWS_OF_BAND: f64 = 5.0;
/// Number of intervals into which those between rows of band-limited accelerations are divided.
const REFINED: usize = 4;
/// Least number of samples within the shortest period of response spectra.
///
/// Samples of histories act as straight lines between them: a sinusoid of ten samples per period then acts with 0.967 of its
/// amplitude, `(sin(pi / n) / (pi / n))^2` for `n` samples, one of five with 0.875. Band-limited accelerations are refined: to ten
/// rows per period there are forty values.
const SAMPLES_PER_PERIOD: f64 = 10.0;

/// Recorded accelerations of a run, from which its spectra and intensities are: the band-limited ones, or samples of its
/// histories where there are none.
#[derive(Clone, Debug, Default)]
pub struct Accelerations {
    table: Vec<TableColumn>,
    is_band_limited: bool,
    /// Parts with the highest frequency that their mesh resolves, and their flat damping reaches (Hz).
    parts: Vec<(String, f64, Option<f64>)>,
}

impl Accelerations {
    /// Those in the folder of a run; empty without histories.
    ///
    /// # Errors
    /// A table that cannot be read.
    pub fn of_folder(folder: &Path) -> Result<Self, StudyError> {
        for (name, is_band_limited) in FILES.into_iter().zip([true, false]) {
            let file = folder.join(name);
            if file.exists() {
                let table = read_table(&file).map_err(powerhouse::Error::from)?;
                return Ok(Self {
                    table,
                    is_band_limited,
                    parts: parts(folder),
                });
            }
        }
        Ok(Self::default())
    }
    /// Samples of a table of histories, the first column the times.
    pub fn of_samples(table: Vec<TableColumn>) -> Self {
        Self {
            table,
            is_band_limited: false,
            parts: Vec::new(),
        }
    }
    /// The columns but for the time.
    pub fn columns(&self) -> &[TableColumn] {
        self.table.get(1..).unwrap_or_default()
    }
    /// The column with a name.
    pub fn column(&self, name: &str) -> Option<&TableColumn> {
        self.columns().iter().find(|column| column.name == name)
    }
    /// Time of the first sample (s).
    pub fn start(&self) -> f64 {
        let times = self.table.first().and_then(|time| time.values.first());
        times.copied().unwrap_or(0.0)
    }
    /// Mean interval between samples (s); none for fewer than two.
    fn interval(&self) -> Option<f64> {
        let times = &self.table.first()?.values;
        let [first, .., last] = times[..] else {
            return None;
        };
        Some((last - first) / (times.len() - 1) as f64)
    }
    /// Shortest period of an oscillator (s) for which the samples hold; zero for fewer than two.
    pub fn shortest_period(&self) -> f64 {
        SAMPLES_PER_PERIOD * self.interval().unwrap_or(0.0)
    }
    /// Highest frequency of the motion that the samples are of (Hz): the band, or half of that of the samples, in which higher
    /// frequencies may be aliased.
    pub fn highest_frequency(&self) -> f64 {
        let of_interval = if self.is_band_limited {
            1.0 / ROWS_OF_BAND
        } else {
            0.5
        };
        self.interval()
            .map_or(0.0, |interval| of_interval / interval)
    }
    /// What spectra of these accelerations are of, one line.
    pub fn note(&self) -> String {
        let (highest, shortest) = (self.highest_frequency(), self.shortest_period());
        let (highest, lowest) = (rounded(highest), rounded(1.0 / shortest));
        let mut note = if self.is_band_limited {
            format!(
                "from accelerations up to {highest} Hz (band-limited, all steps): response spectra hold up to {lowest} Hz, as far as mesh and damping do"
            )
        } else {
            format!(
                "from samples of the histories: response spectra hold up to {lowest} Hz if there is little motion above {highest} Hz, which is aliased; `band` of [output] takes it away"
            )
        };
        let mut sign = "; ";
        for (set, mesh, damped) in &self.parts {
            note += &format!("{sign}'{set}' carries waves up to {} Hz", rounded(*mesh));
            if let Some(damped) = damped {
                note += &format!(" and has flat damping up to {} Hz", rounded(*damped));
            }
            sign = ", ";
        }
        note
    }
    /// The history of a column's first samples, or all, at short equal intervals; none for fewer than two, or an invalid record.
    pub fn history(&self, column: &TableColumn, samples: usize) -> Option<TimeHistory> {
        let times = &self.table.first()?.values;
        let samples = samples.min(times.len()).min(column.values.len());
        let history = even_samples(&times[..samples], &column.values[..samples])?;
        if self.is_band_limited {
            history.refined(REFINED).ok()
        } else {
            Some(history)
        }
    }
}

/// Parts of a run by its summary, with the frequencies (Hz) that their mesh resolves and their flat damping reaches.
fn parts(folder: &Path) -> Vec<(String, f64, Option<f64>)> {
    let summary = std::fs::read(folder.join("summary.json")).unwrap_or_default();
    let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap_or_default();
    let parts = summary["resolution"].as_array().into_iter().flatten();
    let named = parts.filter_map(|part| {
        let set = part["set"].as_str()?.to_owned();
        Some((set, part["frequency"].as_f64()?, part["damped"].as_f64()))
    });
    named.collect()
}

/// Resamples an acceleration (m/s2) at equal intervals, with the same number of samples, since a run samples at its
/// steps. `None` for fewer than two samples or an invalid record.
pub fn even_samples(times: &[f64], acceleration: &[f64]) -> Option<TimeHistory> {
    let ([first, _, ..], [.., last]) = (times, times) else {
        return None;
    };
    let step = (last - first) / (times.len() - 1) as f64;
    let mut index = 0;
    let even = (0..times.len()).map(|sample| {
        let time = first + step * sample as f64;
        while index + 2 < times.len() && times[index + 1] <= time {
            index += 1;
        }
        let share = (time - times[index]) / (times[index + 1] - times[index]);
        let [from, to] = [acceleration[index], acceleration[index + 1]];
        from + (to - from) * share.clamp(0.0, 1.0)
    });
    TimeHistory::new(step, even.collect()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples at unequal intervals are resampled to those of the same motion at equal intervals.
    #[test]
    fn uneven_samples_become_even_ones() {
        // Every first step of 6 ms at or past a multiple of 10 ms.
        let times: Vec<f64> = (0..100)
            .map(|sample| 6e-3 * (10.0 * f64::from(sample) / 6.0).ceil())
            .collect();
        let wave = |time: f64| (5.0 * time).sin();
        let uneven: Vec<f64> = times.iter().map(|&time| wave(time)).collect();
        let even = even_samples(&times, &uneven).unwrap();
        let step = times[99] / 99.0;
        assert!((even.step() - step).abs() < 1e-15);
        for (sample, value) in even.acceleration().into_iter().enumerate() {
            // Chords of at most 12 ms.
            let off = value - wave(step * sample as f64);
            assert!(
                off.abs() < 25.0 * 0.012_f64.powi(2) / 8.0 + 1e-12,
                "{off:e}"
            );
        }
        let given: Vec<f64> = (0..50).map(|sample| 0.25 * f64::from(sample)).collect();
        let same = even_samples(&given, &given).unwrap().acceleration();
        assert!(same.iter().zip(&given).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(even_samples(&[0.0], &[1.0]).is_none());
    }
}
