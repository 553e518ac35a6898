//! Measures of recorded motions from the tables of a run: time histories, response spectra, Fourier spectra, growth of
//! the Arias intensity.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use powerhouse::io::{Plot, TableColumn, read_table, write_noted_table, write_plot};
use powerhouse::wavefield::{SpectralLine, TimeHistory};
use serde_json::Value;

use powerhouse_study::StudyError;
use powerhouse_study::internal::Accelerations;

/// Damping ratios of the oscillators of response spectra.
pub const DAMPINGS: [f64; 3] = [0.02, 0.05, 0.1];
/// Tables over time in a result folder, and what the warnings about each are about.
const TABLES: [(&str, &str); 5] = [
    ("histories.csv", "histories"),
    ("sections.csv", "sections"),
    ("joints.csv", "joints"),
    ("bolts.csv", "bolts"),
    ("energies.csv", "energy"),
];
/// Greatest length of the names of columns together in the name of a file (bytes).
const LONGEST: usize = 100;
/// Folder of the plots in a result folder.
pub(crate) const PLOTS: &str = "plots";
/// Unit of accelerations.
pub(crate) const ACCELERATION: &str = "m/s2";
/// Shortest period of response spectra (s).
pub(crate) const SHORTEST_PERIOD: f64 = 0.02;
/// Longest period of response spectra (s).
pub(crate) const LONGEST_PERIOD: f64 = 3.0;
/// Number of periods in geometric progression.
const PERIODS: usize = 90;

/// Measure of a motion, as a function of time, period or frequency.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The motion itself, of any unit.
    Time,
    /// Greatest absolute acceleration of oscillators (m/s2) over their period (s), of an acceleration.
    Response,
    /// Fourier amplitude (m/s) over frequency (Hz), of an acceleration.
    Fourier,
    /// Share of the Arias intensity that is reached (1) over time (s), of an acceleration (Husid plot).
    Husid,
}

impl Measure {
    /// Name of the measure in names of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Response => "response",
            Self::Fourier => "fourier",
            Self::Husid => "husid",
        }
    }
}

/// Plot of a measure of some columns of a table of histories.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionPlot<'c> {
    /// What is drawn.
    pub measure: Measure,
    /// Columns that are drawn together.
    pub columns: Vec<&'c TableColumn>,
    /// Damping ratios of response spectra (1), such as [`DAMPINGS`].
    pub dampings: Vec<f64>,
}

/// Table of the histories of a run, or of its section forces, joints, bolts or energies over time.
#[derive(Clone, Debug)]
pub struct RecordedMotions {
    folder: PathBuf,
    about: &'static str,
    table: Vec<TableColumn>,
    /// Accelerations from which spectra are.
    accelerations: Accelerations,
}

impl RecordedMotions {
    /// The histories in a result folder of a run or of a case of a sweep.
    ///
    /// # Errors
    /// [`StudyError::NoHistoryTable`]; a table that cannot be read.
    pub fn of_folder(folder: impl Into<PathBuf>) -> Result<Self, StudyError> {
        let folder = folder.into();
        let histories = Self::of_table(&folder, TABLES[0])?;
        histories.ok_or(StudyError::NoHistoryTable { folder })
    }
    /// All tables over time in a result folder: histories, section forces, joints, bolts and energies, as far as the run
    /// has them.
    ///
    /// # Errors
    /// [`StudyError::NoHistoryTable`] without any; a table that cannot be read.
    pub fn all_of_folder(folder: impl Into<PathBuf>) -> Result<Vec<Self>, StudyError> {
        let folder = folder.into();
        // A folder that does not exist is not one without histories.
        std::fs::read_dir(&folder).map_err(|source| StudyError::Read {
            file: folder.clone(),
            source,
        })?;
        let mut tables = Vec::new();
        for table in TABLES {
            tables.extend(Self::of_table(&folder, table)?);
        }
        if tables.is_empty() {
            Err(StudyError::NoHistoryTable { folder })
        } else {
            Ok(tables)
        }
    }
    /// The table that has all named columns or histories, of tables of one folder.
    ///
    /// # Errors
    /// [`StudyError::NoSuchColumn`]; [`StudyError::SeveralTables`] of names in different tables.
    pub fn with_names<'t>(tables: &'t [Self], names: &[String]) -> Result<&'t Self, StudyError> {
        for name in names {
            if !tables.iter().any(|table| table.named(name).is_ok()) {
                let columns = tables.iter().flat_map(Self::columns);
                return Err(StudyError::NoSuchColumn {
                    name: name.clone(),
                    available: columns.map(|column| column.name.clone()).collect(),
                });
            }
        }
        let has_all = |table: &&Self| names.iter().all(|name| table.named(name).is_ok());
        tables
            .iter()
            .find(has_all)
            .ok_or_else(|| StudyError::SeveralTables {
                names: names.to_vec(),
            })
    }
    /// A table of a result folder; none if there is none, or it has no columns.
    fn of_table(
        folder: &Path,
        (name, about): (&str, &'static str),
    ) -> Result<Option<Self>, StudyError> {
        let file = folder.join(name);
        if !file.exists() {
            return Ok(None);
        }
        let table = read_table(&file).map_err(powerhouse::Error::from)?;
        if table.len() < 2 {
            return Ok(None);
        }
        for column in &table {
            let is_time = std::ptr::eq(column, &table[0]);
            let wrong = (0..column.values.len()).find(|&row| {
                let value = column.values[row];
                let falls = is_time && row > 0 && value <= column.values[row - 1];
                !value.is_finite() || falls
            });
            if let Some(row) = wrong {
                return Err(StudyError::HistoryValue {
                    file,
                    column: column.name.clone(),
                    row: row + 1,
                    value: column.values[row],
                });
            }
        }
        Ok(Some(Self {
            folder: folder.into(),
            about,
            accelerations: if name == TABLES[0].0 {
                Accelerations::of_folder(folder)?
            } else {
                Accelerations::default()
            },
            table,
        }))
    }
    /// Folder of the results.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
    /// Accelerations from which spectra are.
    pub(crate) fn accelerations(&self) -> &Accelerations {
        &self.accelerations
    }
    /// Shortest period (s) of response spectra.
    pub(crate) fn shortest_period(&self) -> f64 {
        self.accelerations.shortest_period()
    }
    /// Columns of the table but for the time, each with its name and unit.
    pub fn columns(&self) -> &[TableColumn] {
        &self.table[1..]
    }
    /// Columns with a name, or all of a history with this name.
    ///
    /// # Errors
    /// [`StudyError::NoSuchColumn`].
    pub fn named(&self, name: &str) -> Result<Vec<&TableColumn>, StudyError> {
        let is_of = |column: &&TableColumn| {
            let rest = column.name.strip_prefix(name);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let found: Vec<&TableColumn> = self.columns().iter().filter(is_of).collect();
        if found.is_empty() {
            Err(StudyError::NoSuchColumn {
                name: name.into(),
                available: self
                    .columns()
                    .iter()
                    .map(|column| column.name.clone())
                    .collect(),
            })
        } else {
            Ok(found)
        }
    }
    /// The columns of some names, each once; of a history that is named as a whole the accelerations alone if they are
    /// `of_accelerations`.
    ///
    /// # Errors
    /// [`StudyError::NoSuchColumn`].
    pub fn all_named(
        &self,
        names: &[String],
        of_accelerations: bool,
    ) -> Result<Vec<&TableColumn>, StudyError> {
        let mut columns: Vec<&TableColumn> = Vec::new();
        for name in names {
            let mut found = self.named(name)?;
            if of_accelerations && found.len() > 1 {
                found.retain(|column| column.unit == ACCELERATION);
            }
            found.retain(|column| !columns.contains(column));
            columns.extend(found);
        }
        Ok(columns)
    }
    /// The acceleration of a column at short equal intervals, band-limited if the run has recorded it so.
    ///
    /// # Errors
    /// [`StudyError::NoAcceleration`] for another unit, or fewer than two samples.
    pub fn acceleration(&self, column: &TableColumn) -> Result<TimeHistory, StudyError> {
        self.acceleration_of(column, &self.source(&[column]))
    }
    /// Accelerations that have all of some columns: the band-limited ones, or the samples of the table.
    fn source(&self, columns: &[&TableColumn]) -> Cow<'_, Accelerations> {
        let has = |column: &&TableColumn| self.accelerations.column(&column.name).is_some();
        if columns.iter().all(has) {
            Cow::Borrowed(&self.accelerations)
        } else {
            Cow::Owned(Accelerations::of_samples(self.table.clone()))
        }
    }
    fn acceleration_of(
        &self,
        column: &TableColumn,
        recorded: &Accelerations,
    ) -> Result<TimeHistory, StudyError> {
        let same = recorded
            .column(&column.name)
            .filter(|_| column.unit == ACCELERATION);
        let history = same.and_then(|same| recorded.history(same, usize::MAX));
        history.ok_or_else(|| StudyError::NoAcceleration {
            name: column.name.clone(),
            unit: column.unit.clone(),
            samples: column.values.len(),
        })
    }
    /// Table of a plot: the first column is time, period or frequency. Response spectra have a column for each damping
    /// ratio.
    ///
    /// # Errors
    /// As [`acceleration`](Self::acceleration); damping ratios outside their range.
    pub fn table(&self, plot: &MotionPlot) -> Result<Vec<TableColumn>, StudyError> {
        if plot.measure == Measure::Time {
            let all = std::iter::once(&self.table[0]).chain(plot.columns.iter().copied());
            return Ok(all.cloned().collect());
        }
        let mut table: Vec<TableColumn> = Vec::new();
        let recorded = self.source(&plot.columns);
        for column in &plot.columns {
            let motion = self.acceleration_of(column, &recorded)?;
            let of_motion = match plot.measure {
                Measure::Response => {
                    let periods = periods(recorded.shortest_period());
                    response(&column.name, &motion, (&periods, &plot.dampings))?
                }
                Measure::Fourier => fourier(&column.name, &motion, recorded.highest_frequency()),
                Measure::Time | Measure::Husid => husid(&column.name, &motion, recorded.start()),
            };
            let others = of_motion.into_iter();
            if table.is_empty() {
                table = others.collect()
            } else {
                table.extend(others.skip(1))
            }
        }
        Ok(table)
    }
    /// Writes a plot (SVG) and its table (CSV) beside it, by default into the folder of the plots of the run; the table
    /// begins with the warnings of the run about them. Returns the two files.
    ///
    /// # Errors
    /// As [`table`](Self::table); files that cannot be written.
    pub fn write(
        &self,
        plot: &MotionPlot,
        file: Option<&Path>,
    ) -> Result<[PathBuf; 2], StudyError> {
        let table = self.table(plot)?;
        let drawing = match file {
            Some(file) => self.outside(file)?.with_extension("svg"),
            None => {
                let names = plot.columns.iter().map(|column| column.name.as_str());
                let common = self.common(&names.collect::<Vec<_>>(), plot.measure);
                let name = powerhouse::file_name(&format!("{common}-{}", plot.measure.name()));
                self.folder.join(PLOTS).join(format!("{name}.svg"))
            }
        };
        let notes = self.warnings().into_iter();
        let mut notes: Vec<String> = notes.map(|text| format!("warning: {text}")).collect();
        if plot.measure != Measure::Time {
            notes.push(self.source(&plot.columns).note());
        }
        write_drawn(drawing, &notes, &table)
    }
    /// A file for a plot, which is not beside the tables of the run.
    pub(crate) fn outside<'f>(&self, file: &'f Path) -> Result<&'f Path, StudyError> {
        let folder = match file.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        match (folder.canonicalize(), self.folder.canonicalize()) {
            (Ok(folder), Ok(own)) if folder == own => {
                Err(StudyError::PlotAmongResults { file: file.into() })
            }
            _ => Ok(file),
        }
    }
    /// Name of some columns together: that of the history of which they are all that have the measure, or their own; of many
    /// the first.
    fn common(&self, names: &[&str], measure: Measure) -> String {
        let Some(first) = names.first() else {
            return String::new();
        };
        let base = first.rsplit_once('.').map_or(*first, |(base, _)| base);
        let mut all = self.named(base).unwrap_or_default();
        all.retain(|column| measure == Measure::Time || column.unit == ACCELERATION);
        let is_whole = all.len() > 1
            && all.len() == names.len()
            && all
                .iter()
                .all(|column| names.contains(&column.name.as_str()));
        let joined = names.join("-and-");
        match is_whole {
            true => base.into(),
            false if joined.len() > LONGEST => format!("{first}-and-{}-others", names.len() - 1),
            false => joined,
        }
    }
    /// Warnings of the run about the table.
    pub fn warnings(&self) -> Vec<String> {
        let summary = std::fs::read(self.folder.join("summary.json")).unwrap_or_default();
        let summary: Value = serde_json::from_slice(&summary).unwrap_or_default();
        let warnings = summary["warnings"].as_array().into_iter().flatten();
        let about = warnings.filter(|warning| warning["about"] == self.about);
        let texts = about.filter_map(|warning| warning["text"].as_str());
        texts.map(String::from).collect()
    }
}

/// Writes a table below its notes as a plot (SVG) and, beside it, as numbers (CSV). Returns the two files.
pub(crate) fn write_drawn(
    drawing: PathBuf,
    notes: &[String],
    table: &[TableColumn],
) -> Result<[PathBuf; 2], StudyError> {
    let numbers = drawing.with_extension("csv");
    write_noted_table(&numbers, notes, table).map_err(powerhouse::Error::from)?;
    write_plot(&drawing, &Plot::of_table("", table)).map_err(powerhouse::Error::from)?;
    Ok([drawing, numbers])
}

/// The periods (s) of response spectra, from the shortest one (s) for which the motions hold.
pub(crate) fn periods(resolved: f64) -> Vec<f64> {
    let shortest = resolved.clamp(SHORTEST_PERIOD, LONGEST_PERIOD);
    geometric(shortest, LONGEST_PERIOD, PERIODS)
}

/// So many numbers in geometric progression.
pub(crate) fn geometric(first: f64, last: f64, count: usize) -> Vec<f64> {
    let ratio = last / first;
    (0..count)
        .map(|index| first * ratio.powf(index as f64 / (count - 1) as f64))
        .collect()
}

/// A share in per cent, to hundredths.
pub(crate) fn percent(share: f64) -> f64 {
    (1e4 * share).round() / 1e2
}

fn response(
    name: &str,
    motion: &TimeHistory,
    (periods, dampings): (&[f64], &[f64]),
) -> Result<Vec<TableColumn>, StudyError> {
    let mut table = vec![TableColumn::new("period", "s", periods.to_vec())];
    for &damping in dampings {
        let found = motion.response_spectrum(damping, periods);
        let accelerations = found?
            .iter()
            .map(|response| response.acceleration)
            .collect();
        let name = format!("{name} {} %", percent(damping));
        table.push(TableColumn::new(name, ACCELERATION, accelerations));
    }
    Ok(table)
}

/// Fourier amplitudes up to a frequency (Hz).
fn fourier(name: &str, motion: &TimeHistory, highest: f64) -> Vec<TableColumn> {
    let lines = motion.fourier_spectrum().into_iter();
    let (frequencies, amplitudes) = lines
        .take_while(|line| line.frequency <= highest * (1.0 + 1e-9))
        .map(
            |SpectralLine {
                 frequency,
                 amplitude,
             }| (frequency, amplitude),
        )
        .unzip();
    vec![
        TableColumn::new("frequency", "Hz", frequencies),
        TableColumn::new(name, "m/s", amplitudes),
    ]
}

/// Share of the integral of the squared acceleration, exact for linear interpolation; zero for a motion that is zero.
fn husid(name: &str, motion: &TimeHistory, start: f64) -> Vec<TableColumn> {
    let acceleration = motion.acceleration();
    let mut sums = vec![0.0];
    for pair in acceleration.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        sums.push(sums[sums.len() - 1] + (a * a + a * b + b * b) / 3.0);
    }
    let all = sums[sums.len() - 1];
    if all > 0.0 {
        sums.iter_mut().for_each(|sum| *sum /= all);
    }
    let times = (0..sums.len())
        .map(|index| start + motion.step() * index as f64)
        .collect();
    vec![
        TableColumn::new("time", "s", times),
        TableColumn::new(name, "1", sums),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angular frequency of the motion, on a line of its Fourier spectrum of 2048 samples 5 ms apart.
    const W: f64 = std::f64::consts::TAU * 20.0 / (2048.0 * 0.005);

    /// Motions of a folder with a sine over 4 s and a displacement.
    fn motions(name: &str) -> RecordedMotions {
        let folder =
            std::env::temp_dir().join(format!("powerhouse-motion-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let times: Vec<f64> = (0..=800).map(|i| 0.005 * f64::from(i)).collect();
        let wave = |time: &f64| 3.0 * (W * time).sin();
        let table = [
            TableColumn::new("time", "s", times.clone()),
            TableColumn::new("crown.ux", "m", vec![0.1; times.len()]),
            TableColumn::new("crown.ax", "m/s2", times.iter().map(wave).collect()),
        ];
        powerhouse::io::write_table(&folder.join(TABLES[0].0), &table).unwrap();
        RecordedMotions::of_folder(folder).unwrap()
    }

    /// Spectra peak where the motion does, at the height of the closed form; the Arias intensity grows evenly.
    #[test]
    fn measures_are_those_of_a_sine() {
        let motions = motions("sine");
        let columns = motions.named("crown.ax").unwrap();
        let of = |measure| {
            let (columns, dampings) = (columns.clone(), vec![0.05]);
            let plot = MotionPlot {
                measure,
                columns,
                dampings,
            };
            motions.table(&plot).unwrap()
        };
        let peak = |table: &[TableColumn]| {
            let values = table[1].values.iter().copied().zip(&table[0].values);
            values.fold(
                (0.0, 0.0),
                |most, (value, &at)| {
                    if value > most.0 { (value, at) } else { most }
                },
            )
        };
        let (height, period) = peak(&of(Measure::Response));
        // At resonance the relative acceleration is a / (2 z) (1 - exp(-z w t)), a quarter of a period behind the base.
        let grown = 1.0 - (-0.05 * W * 4.0).exp();
        let expected = 3.0 * (1.0 + (grown / 0.1).powi(2)).sqrt();
        // The next period of the spectrum is up to 2.6 % off resonance, where a steady motion has 0.89 of it.
        let share = height / expected;
        assert!(share > 0.89 && share < 1.001, "{height} {expected}");
        assert!(
            (period * W / std::f64::consts::TAU - 1.0).abs() < 0.05,
            "{period}"
        );
        let (height, frequency) = peak(&of(Measure::Fourier));
        assert!(
            (frequency * std::f64::consts::TAU / W - 1.0).abs() < 1e-9,
            "{frequency}"
        );
        let (real, imaginary) = (
            (W * 4.0).sin().powi(2) / (2.0 * W),
            2.0 - (W * 8.0).sin() / (4.0 * W),
        );
        let expected = 3.0 * real.hypot(imaginary);
        assert!(
            (height / expected - 1.0).abs() < 0.01,
            "{height} {expected}"
        );
        let husid = of(Measure::Husid);
        let grown = |time: f64| time / 2.0 - (2.0 * W * time).sin() / (4.0 * W);
        for index in [200, 400, 600, 800] {
            let share = grown(0.005 * index as f64) / grown(4.0);
            assert!((husid[1].values[index] - share).abs() < 1e-4);
        }
        std::fs::remove_dir_all(&motions.folder).unwrap();
    }

    /// Plots and tables are written; other units, other names and folders without histories are refused by name.
    #[test]
    fn plots_are_written_and_refused() {
        let motions = motions("files");
        let all = motions.named("crown").unwrap();
        assert_eq!(all.len(), 2);
        let of = |measure| MotionPlot {
            measure,
            columns: all.clone(),
            dampings: DAMPINGS.into(),
        };
        let [plot, table] = motions.write(&of(Measure::Time), None).unwrap();
        assert!(plot.ends_with("plots/crown-time.svg") && table.ends_with("plots/crown-time.csv"));
        assert_eq!(read_table(&table).unwrap().len(), 3);
        let refused = motions.write(&of(Measure::Response), None).unwrap_err();
        assert!(refused.to_string().contains("'crown.ux' (m)"), "{refused}");
        let refused = motions.named("floor").unwrap_err().to_string();
        assert!(refused.contains("crown.ux, crown.ax"), "{refused}");
        // Section forces have a table of their own times.
        let sections = [
            TableColumn::new("time", "s", vec![0.0, 0.1]),
            TableColumn::new("lining.moment_across", "N m", vec![1.0, -2.0]),
        ];
        let file = motions.folder.join("sections.csv");
        powerhouse::io::write_table(&file, &sections).unwrap();
        let tables = RecordedMotions::all_of_folder(&motions.folder).unwrap();
        assert_eq!(tables.len(), 2);
        let names = |names: &[&str]| -> Vec<String> { names.iter().map(|n| (*n).into()).collect() };
        let found = RecordedMotions::with_names(&tables, &names(&["lining"])).unwrap();
        let moments = MotionPlot {
            measure: Measure::Time,
            columns: found.named("lining").unwrap(),
            dampings: Vec::new(),
        };
        let [_, table] = found.write(&moments, None).unwrap();
        assert_eq!(read_table(&table).unwrap()[1].values, [1.0, -2.0]);
        assert!(matches!(
            RecordedMotions::with_names(&tables, &names(&["lining", "crown"])),
            Err(StudyError::SeveralTables { .. })
        ));
        let refused = RecordedMotions::with_names(&tables, &names(&["floor"])).unwrap_err();
        assert!(
            refused.to_string().contains("lining.moment_across"),
            "{refused}"
        );
        let folder = motions.folder.join("none");
        assert!(matches!(
            RecordedMotions::of_folder(folder),
            Err(StudyError::NoHistoryTable { .. })
        ));
        std::fs::remove_dir_all(&motions.folder).unwrap();
    }
}
