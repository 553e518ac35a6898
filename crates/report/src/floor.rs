//! Floor response spectra for the design of what a floor carries: over frequency, enveloped over several results, with
//! broadened peaks.

use std::path::{Path, PathBuf};

use powerhouse::io::TableColumn;
use powerhouse::wavefield::{TimeHistory, broadened_spectrum};
use powerhouse_study::StudyError;

use crate::motion::{
    ACCELERATION, LONGEST_PERIOD, PLOTS, RecordedMotions, SHORTEST_PERIOD, geometric, percent,
    write_drawn,
};

/// Number of frequencies in geometric progression.
const FREQUENCIES: usize = 300;

/// Floor response spectra of accelerations of some results.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorPlot {
    /// Names of histories, of which all accelerations are drawn, or of columns.
    pub histories: Vec<String>,
    /// Damping ratios (1), such as [`DAMPINGS`](crate::motion::DAMPINGS).
    pub dampings: Vec<f64>,
    /// Share by which peaks are broadened to both sides (1), such as 0.15; zero for spectra as computed.
    pub broaden: f64,
}

/// Greatest ordinates over some motions of one place and direction.
pub(crate) struct FloorEnvelope {
    /// Frequencies (Hz), ascending.
    pub(crate) frequencies: Vec<f64>,
    /// Share by which peaks are broadened (1).
    pub(crate) broaden: f64,
}

impl FloorEnvelope {
    /// One up to the frequency (Hz) to which all motions hold, of which the shortest period (s) is given.
    pub(crate) fn new(shortest: f64, broaden: f64) -> Self {
        let shortest = shortest.clamp(SHORTEST_PERIOD, LONGEST_PERIOD);
        Self {
            frequencies: geometric(1.0 / LONGEST_PERIOD, 1.0 / shortest, FREQUENCIES),
            broaden,
        }
    }
    /// Greatest absolute accelerations (m/s2) over the motions, with broadened peaks.
    ///
    /// # Errors
    /// Ratios outside their ranges.
    pub(crate) fn ordinates(
        &self,
        motions: &[TimeHistory],
        damping: f64,
    ) -> Result<Vec<f64>, StudyError> {
        let periods: Vec<f64> = self.frequencies.iter().map(|f| 1.0 / f).collect();
        let mut most = vec![0.0_f64; periods.len()];
        for motion in motions {
            let found = motion.response_spectrum(damping, &periods)?;
            for (most, response) in most.iter_mut().zip(found) {
                *most = most.max(response.acceleration);
            }
        }
        Ok(broadened_spectrum(&self.frequencies, &most, self.broaden)?)
    }
}

impl FloorPlot {
    /// Table over frequency (Hz): for each acceleration and damping ratio the greatest over all results.
    ///
    /// # Errors
    /// [`StudyError::NoSuchColumn`] of a result without a named history; [`StudyError::NoAcceleration`]; ratios outside their
    /// ranges.
    pub fn table(&self, results: &[RecordedMotions]) -> Result<Vec<TableColumn>, StudyError> {
        let shortest = results.iter().map(RecordedMotions::shortest_period);
        let envelope = FloorEnvelope::new(shortest.fold(0.0, f64::max), self.broaden);
        let mut table = vec![TableColumn::new(
            "frequency",
            "Hz",
            envelope.frequencies.clone(),
        )];
        let [first, ..] = results else {
            return Ok(table);
        };
        for column in first.all_named(&self.histories, true)? {
            let motions = results.iter().map(|one| {
                let same = one.named(&column.name)?;
                one.acceleration(same[0])
            });
            let motions = motions.collect::<Result<Vec<_>, _>>()?;
            for &damping in &self.dampings {
                let mut name = format!("{} {} %", column.name, percent(damping));
                if results.len() > 1 {
                    name += &format!(", greatest of {}", results.len());
                }
                if self.broaden > 0.0 {
                    name += &format!(", peaks +-{} %", percent(self.broaden));
                }
                let ordinates = envelope.ordinates(&motions, damping)?;
                table.push(TableColumn::new(name, ACCELERATION, ordinates));
            }
        }
        Ok(table)
    }
    /// Writes the plot (SVG) and its table (CSV) beside it, by default into the folder of the plots of the first result; the
    /// table begins with the warnings of all results about their histories, and how far each holds. Returns the two files.
    ///
    /// # Errors
    /// As [`table`](Self::table); files that cannot be written.
    pub fn write(
        &self,
        results: &[RecordedMotions],
        file: Option<&Path>,
    ) -> Result<[PathBuf; 2], StudyError> {
        let table = self.table(results)?;
        let drawing = match file {
            Some(file) => {
                for one in results {
                    one.outside(file)?;
                }
                file.with_extension("svg")
            }
            None => {
                let name = format!("{}-floor-spectrum", self.histories.join("-and-"));
                let folder = results.first().map_or(Path::new("."), |one| one.folder());
                let name = powerhouse::file_name(&name);
                folder.join(PLOTS).join(format!("{name}.svg"))
            }
        };
        let notes: Vec<String> = results.iter().flat_map(notes).collect();
        write_drawn(drawing, &notes, &table)
    }
}

/// What the spectra of a result are of, after its warnings.
fn notes(result: &RecordedMotions) -> Vec<String> {
    let folder = result.folder().display().to_string();
    let warnings = result.warnings().into_iter();
    let warnings = warnings.map(|text| format!("warning: {folder}: {text}"));
    let about = format!("{folder}: {}", result.accelerations().note());
    warnings.chain([about]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Results of a sine of a frequency (Hz) and amplitude (m/s2) over 20 s, at a floor.
    fn result(name: &str, frequency: f64, amplitude: f64) -> RecordedMotions {
        let folder =
            std::env::temp_dir().join(format!("powerhouse-floor-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let times: Vec<f64> = (0..=10_000).map(|i| 0.002 * f64::from(i)).collect();
        let wave = |time: &f64| amplitude * (std::f64::consts::TAU * frequency * time).sin();
        let table = [
            TableColumn::new("floor.ux", "m", vec![0.0; times.len()]),
            TableColumn::new("floor.ax", ACCELERATION, times.iter().map(wave).collect()),
        ];
        let time = TableColumn::new("time", "s", times);
        let table = [&[time], &table[..]].concat();
        powerhouse::io::write_table(&folder.join("histories.csv"), &table).unwrap();
        RecordedMotions::of_folder(folder).unwrap()
    }

    /// The envelope of two results has the resonance of each at the height of the closed form, over its share to both
    /// sides where peaks are broadened, and is the stronger motion where oscillators are stiff.
    #[test]
    fn envelopes_have_the_peaks_of_all_results() {
        let results = [result("five", 5.0, 1.0), result("nine", 9.0, 2.0)];
        let of = |broaden| FloorPlot {
            histories: vec!["floor".into()],
            dampings: vec![0.05],
            broaden,
        };
        let [narrow, broad] = [0.0, 0.15].map(|share| of(share).table(&results).unwrap());
        let at = |table: &[TableColumn], frequency: f64| {
            let index = table[0].values.partition_point(|f| *f < frequency);
            table[1].values[index]
        };
        // Steady resonance: the absolute acceleration is sqrt(1 + 1 / (4 z^2)) times that of the floor.
        let gain = (1.0 + 100.0_f64).sqrt();
        for (frequency, amplitude) in [(5.0, 1.0), (9.0, 2.0)] {
            let peak = amplitude * gain;
            for side in [0.86, 1.0, 1.14] {
                let found = at(&broad, side * frequency);
                assert!((found / peak - 1.0).abs() < 0.03, "{frequency}: {found}");
            }
            assert!(at(&narrow, 0.86 * frequency) < 0.6 * peak);
        }
        let stiff = narrow[1].values[narrow[1].values.len() - 1];
        assert!((stiff / 2.0 - 1.0).abs() < 0.08, "{stiff}");
        assert_eq!(narrow.len(), 2);
        let [_, numbers] = of(0.15).write(&results, None).unwrap();
        let written = std::fs::read_to_string(&numbers).unwrap();
        let notes = written.lines().take_while(|line| line.starts_with('#'));
        assert_eq!(notes.count(), 2, "{written}");
        let other = FloorPlot {
            histories: vec!["roof".into()],
            ..of(0.0)
        };
        assert!(matches!(
            other.table(&results),
            Err(StudyError::NoSuchColumn { .. })
        ));
        for one in results {
            std::fs::remove_dir_all(one.folder()).unwrap();
        }
    }
}
