//! `powerhouse plot`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use powerhouse_study::motion::{DAMPINGS, Measure, MotionPlot, RecordedMotions};

use crate::Outcome;
use crate::advise::number;
use crate::terminal::{say, say_warning};

/// Arguments of `powerhouse plot`.
#[derive(Args)]
pub(crate) struct PlotArguments {
    /// Folder of the results of a run or of a case.
    folder: PathBuf,
    /// Histories, sections, joints, bolts or energies that are drawn together, such as crown (all its columns) or crown.ax;
    /// without any the columns are listed.
    histories: Vec<String>,
    /// What is drawn.
    #[arg(long, value_enum, default_value_t = Kind::Time)]
    of: Kind,
    /// Damping ratio of a response spectrum, such as 5%; may be repeated. 2, 5 and 10 % by default.
    #[arg(long, value_name = "SHARE", value_parser = damping)]
    damping: Vec<f64>,
    /// SVG file, beside which a CSV table is written; by default in the folder plots of the results.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Measure of a motion.
#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    /// The motion over time.
    Time,
    /// Response spectrum of an acceleration.
    Response,
    /// Fourier amplitude of an acceleration.
    Fourier,
    /// Growth of the Arias intensity of an acceleration (Husid).
    Husid,
}

/// Draws histories of a finished run, or lists them.
pub(crate) fn plot(arguments: PlotArguments) -> Outcome {
    let tables = RecordedMotions::all_of_folder(arguments.folder)?;
    if arguments.histories.is_empty() {
        for column in tables.iter().flat_map(RecordedMotions::columns) {
            let peak = column
                .values
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()));
            say!("{:<24} {peak:>12.4e} {}", column.name, column.unit);
        }
        return Ok(ExitCode::SUCCESS);
    }
    let motions = RecordedMotions::with_names(&tables, &arguments.histories)?;
    let measure = match arguments.of {
        Kind::Time => Measure::Time,
        Kind::Response => Measure::Response,
        Kind::Fourier => Measure::Fourier,
        Kind::Husid => Measure::Husid,
    };
    let dampings = match arguments.damping.is_empty() {
        true => DAMPINGS.into(),
        false => arguments.damping,
    };
    let mut columns = Vec::new();
    for name in &arguments.histories {
        let mut found = motions.named(name)?;
        // Of a history that is named as a whole the accelerations have spectra.
        if measure != Measure::Time && found.len() > 1 {
            found.retain(|column| column.unit == "m/s2");
        }
        for column in found {
            if !columns.contains(&column) {
                columns.push(column);
            }
        }
    }
    let plot = MotionPlot {
        measure,
        columns,
        dampings,
    };
    let files = motions.write(&plot, arguments.out.as_deref())?;
    for warning in motions.warnings() {
        say_warning!("{warning}");
    }
    for file in files {
        say!("{}", file.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// Reads a damping ratio from 0 to below 1, such as `5%` or `0.05`.
fn damping(text: &str) -> Result<f64, String> {
    let damping = number(text).filter(|damping| (0.0..=0.99).contains(damping));
    damping.ok_or_else(|| "a damping ratio from 0 to 99%, such as 5% or 0.05".into())
}
