//! Accelerograms from files: formats of agencies, each recognised by its content, and columns of text.
//!
//! ```
//! use powerhouse_records::{AccelerationUnit, RecordOptions, parse_record};
//! let options = RecordOptions {
//!     unit: Some(AccelerationUnit::MetrePerSecondSquared),
//!     ..RecordOptions::default()
//! };
//! let record = parse_record(b"time,a\n0.00,0.1\n0.02,-0.3\n0.04,0.2\n", &options)?;
//! assert_eq!((record.step, record.samples), (0.02, vec![0.1, -0.3, 0.2]));
//!
//! // What is not a number is an error with its line and column.
//! let error = parse_record(b"0.00 0.1\n0.02 nan\n", &options).unwrap_err();
//! assert_eq!(error.to_string(), "2:6: \"nan\" is not finite");
//! # Ok::<(), powerhouse_records::RecordError>(())
//! ```
//!
//! # Why so
//! *Units are declared, not guessed.* A text may not state whether it is in g or m/s2; the caller must. What is certain
//! is recognised and stated in [`Record::notes`]; what is not is refused.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod afad;
mod at2;
mod channel;
mod columns;
mod cosmos;
mod csmip;
mod csmnc;
mod cwb;
mod error;
mod esm;
mod geonet;
mod knet;
mod number;
mod set;
mod smc;
mod times;
mod title;
mod unit;

use std::borrow::Cow;
use std::path::Path;

use channel::Channel;
pub use error::{RecordError, RecordFault};
pub use set::{LengthRule, common_length};
pub use unit::AccelerationUnit;

/// Greatest size of a file (bytes): an hour at 1000 samples a second takes a fifth of it.
const LARGEST: u64 = 256 << 20;

/// Format of an agency.
struct Format {
    name: &'static str,
    /// Whether a text has its mark.
    recognises: fn(&str) -> bool,
    /// All channels of acceleration.
    channels: fn(&str) -> Result<Vec<Channel>, RecordError>,
}

macro_rules! formats {
    ($($format:ident),*) => {
        &[$(Format {
            name: $format::NAME,
            recognises: $format::recognises,
            channels: $format::channels,
        }),*]
    };
}

/// Formats other than PEER AT2 and columns. No file has the mark of two.
const FORMATS: &[Format] = formats![knet, cosmos, geonet, csmip, esm, smc, cwb, csmnc, afad];

/// Uniformly sampled accelerogram.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Name of the format of the file.
    pub format: &'static str,
    /// Title of the record: the header or comment lines of the file.
    pub title: String,
    /// Station, as the file names it; empty if it does not.
    pub station: String,
    /// Event, likewise.
    pub event: String,
    /// Component, likewise.
    pub component: String,
    /// Time of the first sample, likewise.
    pub start: String,
    /// Unit of the samples in the file.
    pub unit: AccelerationUnit,
    /// Time step between samples (s), above zero.
    pub step: f64,
    /// Accelerations (m/s2), the first at the record's own time zero; at least two.
    pub samples: Vec<f64>,
    /// What the reader concluded from the content of the file, such as the column or channel that it took.
    pub notes: Vec<String>,
    /// Warnings of differences between the record and the declarations of its file.
    pub warnings: Vec<String>,
}

/// Treatment of a file whose number of samples differs from the declared one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CountRule {
    /// The difference is an error.
    #[default]
    AsDeclared,
    /// The samples in the file are used, with a warning.
    AsFound,
}

/// Columns of a text, by their numbers from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordColumns {
    /// Column of the times (s); `None` if the step is declared.
    pub time: Option<usize>,
    /// Column of the accelerations.
    pub acceleration: usize,
}

/// Declarations of the caller about a file.
///
/// `skip`, `columns` and `values_in_a_row` are about plain text: with one of them a file is read as that, whatever
/// its header.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordOptions {
    /// Unit of the accelerations; `None` if the file declares it.
    pub unit: Option<AccelerationUnit>,
    /// Time step between samples (s); `None` if the file declares it.
    pub step: Option<f64>,
    /// Treatment of a declared count that differs.
    pub count: CountRule,
    /// Number (from 1) or name of the channel of a file that has several.
    pub channel: Option<String>,
    /// Number of first lines of a text that are left out; `None` if titles and what precedes the samples are
    /// recognised.
    pub skip: Option<usize>,
    /// Columns of a text; `None` if it has one or two, or names them.
    pub columns: Option<RecordColumns>,
    /// Number of successive samples, or of times and samples, in each row of a text.
    pub values_in_a_row: Option<usize>,
}

/// Reads an accelerogram, of a format that its content shows:
///
/// | format | files |
/// |---|---|
/// | PEER AT2 | `NPTS` in one of the first lines |
/// | K-NET, KiK-net | ASCII, one component in a file; the offset of the instrument is subtracted |
/// | COSMOS v1.20 | `.v1`, `.v1c`, `.v2`, `.v2c`; data sets one after the other |
/// | CSMIP, CDMG | volumes 1 and 2, several channels |
/// | GeoNet | `.V1A` and `.V2A`, three components |
/// | ESM, ITACA, AFAD since 2018 | `.ASC` of the header format DYNA |
/// | AFAD until 2018, CWB (TSMIP) | text of three components |
/// | CSMNC, USGS SMC | one component in a file |
/// | plain text | columns, or several values in a row |
///
/// Of several channels `options.channel` names one. Columns of text are separated by blanks, commas, semicolons or
/// tabs; `#` and
/// `%` start a comment; lines that start with a word may precede the numbers. One column holds accelerations at the
/// step that
/// `options` or a title declare; of two, the first holds the times, which must be uniform to 1 % of a step; of more,
/// names of columns or `options` tell which is which. Decimal commas are recognised where no other reading is
/// possible. A number of samples or a step in front of them, unit, step and quantity in titles are recognised, or
/// refused if they are not certain.
///
/// # Errors
/// [`RecordError`], with the file, line, column and fault.
///
/// ```
/// use powerhouse_records::{AccelerationUnit, RecordOptions, parse_record};
/// let options = RecordOptions { unit: Some(AccelerationUnit::Gravity), ..RecordOptions::default() };
/// let record = parse_record(b"0.00, 0.0\n0.02, 0.5\n0.04, -0.25\n", &options)?;
/// assert_eq!(record.samples[1], 0.5 * 9.80665);
/// assert!((record.step - 0.02).abs() < 1e-15);
/// # Ok::<(), powerhouse_records::RecordError>(())
/// ```
pub fn read_record(file: &Path, options: &RecordOptions) -> Result<Record, RecordError> {
    let bytes = powerhouse_io::read_whole(file, LARGEST).map_err(|source| RecordError::File {
        file: file.into(),
        source,
    })?;
    parse_record(&bytes, options).map_err(|error| error.in_file(file))
}

/// Reads an accelerogram from memory; see [`read_record`].
///
/// # Errors
/// As [`read_record`], without the name of a file.
pub fn parse_record(bytes: &[u8], options: &RecordOptions) -> Result<Record, RecordError> {
    if let Some(step) = options.step {
        check_step(step).map_err(|fault| RecordError::content(0, 0, fault))?;
    }
    // Titles may be in any single-byte encoding; numbers are plain ASCII in all of them.
    let text = String::from_utf8_lossy(bytes);
    let text = plain(&text);
    let content = |fault| RecordError::content(0, 0, fault);
    if text.trim().is_empty() {
        return Err(content(RecordFault::Empty));
    }
    if let Some((found, way)) = other_format(bytes, &text) {
        return Err(content(RecordFault::Foreign { found, way }));
    }
    let record = read(&text, options)?;
    if record.samples.len() < 2 {
        let found = record.samples.len();
        return Err(RecordError::content(0, 0, RecordFault::TooShort { found }));
    }
    Ok(record)
}

fn read(text: &str, options: &RecordOptions) -> Result<Record, RecordError> {
    if options.skip.is_some() || options.columns.is_some() || options.values_in_a_row.is_some() {
        return columns::read(text, options);
    }
    if let Some(format) = FORMATS.iter().find(|format| (format.recognises)(text)) {
        return channel::record(format.name, (format.channels)(text)?, options);
    }
    match at2::header(text)? {
        Some(header) => {
            let other = options.channel.clone().filter(|channel| channel != "1");
            match other {
                Some(wanted) => {
                    let channels = "1, the only one of PEER AT2".into();
                    Err(RecordError::content(
                        0,
                        0,
                        RecordFault::NoSuchChannel { wanted, channels },
                    ))
                }
                None => at2::read(text, &header, options),
            }
        }
        None => columns::read(text, options),
    }
}

/// Refuses lines other than blank ones and words behind the samples of a format of one component.
fn nothing_follows(
    lines: &[&str],
    end: usize,
    is_start: impl Fn(&str) -> bool,
) -> Result<(), RecordError> {
    for (line, number) in lines.iter().zip(1..).skip(end) {
        let fault = if is_start(line) {
            RecordFault::SecondRecord { last: end }
        } else if line
            .trim_start()
            .starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        {
            let text = line.trim().chars().take(40).collect();
            RecordFault::NotANumber { text }
        } else {
            continue;
        };
        return Err(RecordError::content(number, 0, fault));
    }
    Ok(())
}

/// Name of another format of a file, or of a file with bytes that are not text, and the way out.
fn other_format(bytes: &[u8], text: &str) -> Option<(&'static str, &'static str)> {
    const OBSPY: &str = "in Python, `trace = obspy.read(FILE)[0]` and \
        `numpy.savetxt(\"record.txt\", numpy.c_[trace.times(), trace.data])` write a text, after `apply_calib=True` or the removal of the \
        response has made accelerations of counts";
    const EXPORT: &str = "export the accelerations as text or as one of the formats of `file`";
    let word = |at: usize| {
        bytes
            .get(at..at + 4)
            .map(|four| [four[0], four[1], four[2], four[3]])
    };
    if word(304).is_some_and(|word| [[6, 0, 0, 0], [0, 0, 0, 6]].contains(&word)) {
        return Some(("a SAC file", OBSPY));
    }
    let is_block = |head: &[u8]| {
        head[..6].iter().all(u8::is_ascii_digit) && b"DRQM".contains(&head[6]) && head[7] == b' '
    };
    if bytes.len() >= 64 && is_block(&bytes[..8]) {
        return Some(("a miniSEED file", OBSPY));
    }
    let start = text.trim_start();
    let first = start
        .lines()
        .next()
        .unwrap_or_default()
        .to_ascii_lowercase();
    if first.starts_with("response and fourier amplitude spectra") {
        return Some((
            "a file of spectra (CSMIP volume 3)",
            "volume 2 (`.V2`) has the accelerations",
        ));
    }
    if first.starts_with("timeseries ") && first.contains(" tspair") {
        return Some(("a text of dates and values (TSPAIR)", OBSPY));
    }
    if ["xw01", "wid1", "wid2"]
        .iter()
        .any(|word| first.starts_with(word))
    {
        return Some(("a GSE file", OBSPY));
    }
    let is_title = |title: &str| first.contains(title);
    if is_title("corrected accelerogram") || is_title("archivo estandar de aceleracion") {
        let known = FORMATS.iter().any(|format| (format.recognises)(text));
        return (!known).then_some((
            "an accelerogram of an agency in a layout that is not read",
            EXPORT,
        ));
    }
    if let Some(found) = powerhouse_io::known_format(bytes) {
        return Some((found, EXPORT));
    }
    if start.starts_with(['<', '{']) {
        return Some(("a page of markup", EXPORT));
    }
    if start.starts_with("[mesh]") || start.contains("\n[mesh]") {
        return Some(("a scene", EXPORT));
    }
    // Titles of old records have some bytes of other encodings, but no NUL.
    start
        .contains('\0')
        .then_some(("a file of bytes that are not text", EXPORT))
}

/// Text without a UTF-8 byte order mark at the start or an end-of-file mark at the end, and with old line
/// ends, if it has only those, replaced by ones that `str::lines` recognises.
fn plain(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let text = text.trim_end_matches(|c: char| c == '\u{1a}' || c.is_whitespace());
    if text.contains('\n') {
        text.into()
    } else {
        text.replace('\r', "\n").into()
    }
}

fn check_step(step: f64) -> Result<(), RecordFault> {
    if step.is_finite() && step > 0.0 {
        Ok(())
    } else {
        Err(RecordFault::Step { value: step })
    }
}
