//! `powerhouse plot`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use powerhouse::file_name;
use powerhouse::io::{Plot, shown_number, write_noted_table, write_plot};
use powerhouse::model::Vec3;
use powerhouse_report::fields::{FieldLine, FieldQuantity, LineTable, RecordedFields};
use powerhouse_report::floor::FloorPlot;
use powerhouse_report::motion::{DAMPINGS, Measure, MotionPlot, RecordedMotions};

use crate::advise::number;
use crate::picture::{finite, instant, numbers};
use crate::terminal::{say, say_warning};
use crate::{Outcome, check_ending};

/// Arguments of `powerhouse plot`.
#[derive(Args)]
pub(crate) struct PlotArguments {
    /// Folder of the results of a run or of a case.
    folder: PathBuf,
    /// Histories, sections, joints, bolts or energies that are drawn together, such as crown (all its columns) or crown.ax;
    /// without any the columns are listed. With `--along` quantities of snapshots, such as stress.zz.
    histories: Vec<String>,
    /// Line along which quantities of a snapshot are drawn: two or more points (m), such as 0,0,-60:0,0,-90. In place of the
    /// folder a VTU file may then be given.
    #[arg(long, value_name = "POINTS", value_parser = corners, allow_hyphen_values = true, requires = "histories")]
    along: Option<Corners>,
    /// Number of points on the line, both ends included.
    #[arg(long, value_name = "COUNT", default_value = "101", requires = "along", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    points: u32,
    /// Time of the snapshot (s), of which the nearest is taken; by default the last.
    #[arg(long, value_name = "SECONDS", requires = "along", value_parser = finite, allow_negative_numbers = true)]
    time: Option<f64>,
    /// What is drawn.
    #[arg(long, value_enum, default_value_t = Kind::Time, conflicts_with = "along")]
    of: Kind,
    /// Damping ratio of a response spectrum, such as 5%; may be repeated. 2, 5 and 10 % by default.
    #[arg(long, value_name = "SHARE", value_parser = damping)]
    damping: Vec<f64>,
    /// Share by which the peaks of a floor spectrum are broadened to both sides, such as 15%.
    #[arg(long, value_name = "SHARE", value_parser = broadening)]
    broaden: Option<f64>,
    /// Folder of further results, such as of another case or mesh: a floor spectrum is the greatest of all; may be repeated.
    #[arg(long, value_name = "FOLDER")]
    with: Vec<PathBuf>,
    /// SVG file, beside which a CSV table is written; by default in the folder plots of the results.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Corners of a line (m).
#[derive(Clone)]
struct Corners(Vec<Vec3>);

/// Measure of a motion.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// The motion over time.
    Time,
    /// Response spectrum of an acceleration.
    Response,
    /// Response spectrum over frequency, the greatest of several results, with broadened peaks: for what a floor carries.
    FloorSpectrum,
    /// Fourier amplitude of an acceleration.
    Fourier,
    /// Growth of the Arias intensity of an acceleration (Husid).
    Husid,
}

/// Draws histories of a finished run, or lists them.
pub(crate) fn plot(arguments: PlotArguments) -> Outcome {
    if let Some(file) = &arguments.out {
        check_ending(file, ("plot", "svg"))?;
    }
    if let Some(Corners(corners)) = arguments.along {
        let line = FieldLine {
            corners,
            points: arguments.points as usize,
        };
        let quantities = arguments.histories.into_iter().map(FieldQuantity);
        return along(
            &arguments.folder,
            arguments.time,
            &line,
            (quantities.collect(), arguments.out),
        );
    }
    if arguments.folder.is_file() {
        let file = arguments.folder.display();
        let message = format!(
            "{file} is a file; histories are those of a folder of results, and `--along` draws a VTU file"
        );
        return Err(message.into());
    }
    let is_floor = arguments.of == Kind::FloorSpectrum;
    if !arguments.damping.is_empty() && !is_floor && arguments.of != Kind::Response {
        let ways = "`--damping` is that of response spectra: give `--of response` or `--of floor-spectrum`";
        return Err(ways.into());
    }
    if !is_floor && (arguments.broaden.is_some() || !arguments.with.is_empty()) {
        let way = "`--broaden` and `--with` are those of floor spectra: give `--of floor-spectrum`";
        return Err(way.into());
    }
    let tables = RecordedMotions::all_of_folder(&arguments.folder)?;
    if arguments.histories.is_empty() {
        let columns = || tables.iter().flat_map(RecordedMotions::columns);
        let longest = columns().map(|column| column.name.chars().count()).max();
        let width = longest.unwrap_or(0).max(24);
        for column in columns() {
            let farther = |most: f64, &value: &f64| {
                if value.abs() > most.abs() {
                    value
                } else {
                    most
                }
            };
            let peak = column.values.iter().fold(0.0_f64, farther);
            say!("{:<width$} {peak:>12.4e} {}", column.name, column.unit);
        }
        return Ok(ExitCode::SUCCESS);
    }
    let dampings = if arguments.damping.is_empty() {
        DAMPINGS.into()
    } else {
        arguments.damping.clone()
    };
    let measure = match arguments.of {
        Kind::FloorSpectrum => return floor(arguments, dampings),
        Kind::Time => Measure::Time,
        Kind::Response => Measure::Response,
        Kind::Fourier => Measure::Fourier,
        Kind::Husid => Measure::Husid,
    };
    let motions = RecordedMotions::with_names(&tables, &arguments.histories)?;
    let columns = motions.all_named(&arguments.histories, measure != Measure::Time)?;
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

/// Draws floor spectra of one or several results.
fn floor(arguments: PlotArguments, dampings: Vec<f64>) -> Outcome {
    let folders = std::iter::once(arguments.folder).chain(arguments.with);
    let results = folders.map(RecordedMotions::of_folder);
    let results: Vec<RecordedMotions> = results.collect::<Result<_, _>>()?;
    let plot = FloorPlot {
        histories: arguments.histories,
        dampings,
        broaden: arguments.broaden.unwrap_or(0.0),
    };
    let files = plot.write(&results, arguments.out.as_deref())?;
    for result in &results {
        for warning in result.warnings() {
            say_warning!("{}: {warning}", result.folder().display());
        }
    }
    for file in files {
        say!("{}", file.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// Draws quantities of a snapshot along a line.
fn along(
    results: &Path,
    time: Option<f64>,
    line: &FieldLine,
    (quantities, out): (Vec<FieldQuantity>, Option<PathBuf>),
) -> Outcome {
    let fields = RecordedFields::at(results)?;
    let index = instant(&fields, time)?;
    let grid = fields.read(index)?;
    let LineTable {
        columns: table,
        outside,
        gaps,
        ..
    } = line.table(&grid, &quantities, fields.file(index))?;
    let drawing = out.unwrap_or_else(|| {
        let names: Vec<String> = quantities.iter().map(ToString::to_string).collect();
        let when = fields.times().nth(index);
        let when = when.map_or_else(String::new, |time| format!("-{}s", shown_number(time)));
        let name = file_name(&format!("{}-along-line", names.join("-and-")));
        fields.place("plots", &format!("{name}{when}.svg"))
    });
    let numbers = drawing.with_extension("csv");
    let warning = (outside > 0).then(|| {
        let all = line.points;
        format!("{outside} of {all} points are in no active element and left out")
    });
    let notes: Vec<String> = warning
        .iter()
        .map(|text| format!("warning: {text}"))
        .collect();
    write_noted_table(&numbers, &notes, &table)?;
    let when = grid
        .time
        .map(|time| format!(" at {} s", shown_number(time)));
    let mut title = format!("{}{}", fields.title(), when.unwrap_or_default());
    if outside > 0 {
        title += &format!(", {outside} points in no element left out");
    }
    // The positions are in the table alone.
    let drawn: Vec<_> = table
        .iter()
        .take(1)
        .chain(table.iter().skip(4))
        .cloned()
        .collect();
    write_plot(&drawing, &Plot::of_table(&title, &drawn).with_gaps(gaps))?;
    if let Some(warning) = warning {
        say_warning!("{warning}");
    }
    say!("{}\n{}", drawing.display(), numbers.display());
    Ok(ExitCode::SUCCESS)
}

/// Reads the corners of a line (m).
fn corners(text: &str) -> Result<Corners, String> {
    let points: Option<Vec<Vec3>> = text
        .split(':')
        .map(|p| numbers::<3>(p).map(Vec3::from))
        .collect();
    let points = points.filter(|points| points.len() > 1);
    let corners = points.map(Corners);
    corners.ok_or_else(|| "two or more points of three coordinates, such as 0,0,-60:0,0,-90".into())
}

/// Reads a damping ratio from 0 to below 1, such as `5%` or `0.05`.
fn damping(text: &str) -> Result<f64, String> {
    let damping = number(text).filter(|damping| (0.0..=0.99).contains(damping));
    damping.ok_or_else(|| "a damping ratio from 0 to 99%, such as 5% or 0.05".into())
}

/// Reads a share by which peaks are broadened, from 0 to a half.
fn broadening(text: &str) -> Result<f64, String> {
    let share = number(text).filter(|share| (0.0..=0.5).contains(share));
    share.ok_or_else(|| "a share from 0 to 50%, such as 15% or 0.15".into())
}
