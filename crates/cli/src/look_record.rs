//! `powerhouse look` of a record.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use powerhouse::io::{
    AccelerationUnit, Plot, Record, RecordError, RecordFault, RecordOptions, TableColumn,
    read_record, write_plot,
};
use powerhouse::wavefield::{OscillatorResponse, TimeHistory};

use crate::terminal::{say, say_warning};
use crate::{Outcome, check_ending};

/// Damping ratio of the response spectra.
const DAMPING: f64 = 0.05;
/// Shortest and longest period of the response spectra (s), and their number.
const PERIODS: (f64, f64, usize) = (0.02, 10.0, 200);

/// What the command says of a record.
pub(crate) struct LookRecord {
    pub(crate) units: Option<String>,
    pub(crate) time_step: Option<f64>,
    pub(crate) picture: Option<PathBuf>,
}

/// Prints format, peaks, Arias intensity and duration of each channel of a record, and draws the response spectra if a file
/// is given.
pub(crate) fn look(file: &Path, arguments: &LookRecord) -> Outcome {
    if let Some(picture) = &arguments.picture {
        check_ending(picture, ("plot", "svg"))?;
    }
    let unit = match &arguments.units {
        Some(name) => Some(AccelerationUnit::from_name(name).ok_or_else(|| {
            format!("`--units {name}` is no unit of acceleration: m/s2, cm/s2, mm/s2, g, %g or mg")
        })?),
        None => None,
    };
    let options = |channel: Option<usize>| RecordOptions {
        unit,
        step: arguments.time_step,
        channel: channel.map(|number| number.to_string()),
        ..RecordOptions::default()
    };
    let records = match read_record(file, &options(None)) {
        Ok(record) => vec![record],
        Err(RecordError::Content {
            fault: RecordFault::Channels { .. },
            ..
        }) => channels(file, options)?,
        Err(error) => return Err(error.to_string().into()),
    };
    say!("{}", file.display());
    let (low, high, count) = PERIODS;
    let period = |index: usize| low * (high / low).powf(index as f64 / (count - 1) as f64);
    let periods: Vec<f64> = (0..count).map(period).collect();
    let mut columns = vec![TableColumn::new("period", "s", periods.clone())];
    for (record, number) in records.into_iter().zip(1..) {
        let name = match record.component.as_str() {
            "" => format!("channel {number}"),
            component => component.to_string(),
        };
        let history = describe(record, &name)?;
        if arguments.picture.is_some() {
            let shortest = 1e-3 * history.step();
            let own: Vec<f64> = periods.iter().map(|period| period.max(shortest)).collect();
            let responses = history.response_spectrum(DAMPING, &own)?;
            let pseudo = responses
                .iter()
                .map(OscillatorResponse::pseudo_acceleration);
            columns.push(TableColumn::new(&name, "m/s2", pseudo.collect()));
        }
    }
    if let Some(picture) = &arguments.picture {
        let title = format!("{}: pseudo-acceleration, damping {DAMPING}", file.display());
        write_plot(picture, &Plot::of_table(&title, &columns))?;
        say!("{}", picture.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// All channels of a file of several.
fn channels(
    file: &Path,
    options: impl Fn(Option<usize>) -> RecordOptions,
) -> Result<Vec<Record>, String> {
    let mut found = Vec::new();
    for number in 1.. {
        match read_record(file, &options(Some(number))) {
            Ok(record) => found.push(record),
            Err(RecordError::Content {
                fault: RecordFault::NoSuchChannel { .. },
                ..
            }) => break,
            Err(error) => return Err(error.to_string()),
        }
    }
    Ok(found)
}

/// Prints what a record is.
fn describe(record: Record, name: &str) -> Result<TimeHistory, Box<dyn std::error::Error>> {
    let count = record.samples.len();
    say!("\n{name}: {}", record.format);
    for (label, text) in [
        ("station", &record.station),
        ("event", &record.event),
        ("from", &record.start),
        ("title", &record.title),
    ] {
        if !text.is_empty() {
            say!("  {label:<9} {text}");
        }
    }
    say!(
        "  samples   {count} at {} s in {}, {:.3} s",
        record.step,
        record.unit.name(),
        record.step * (count - 1) as f64
    );
    for note in &record.notes {
        say!("  {note}");
    }
    for warning in &record.warnings {
        say_warning!("{warning}");
    }
    let history = TimeHistory::new(record.step, record.samples)?;
    let report = history.report();
    say!(
        "  PGA {:.4} m/s2, PGV {:.4} m/s, PGD {:.4} m; ends at {:.2e} m/s, {:.2e} m",
        report.peak_acceleration,
        report.peak_velocity,
        report.peak_displacement,
        report.end_velocity,
        report.end_displacement
    );
    say!(
        "  Arias intensity {:.4} m/s, significant duration (5 to 95 %) {:.2} s",
        history.arias_intensity(),
        history.significant_duration(0.05, 0.95)?
    );
    Ok(history)
}
