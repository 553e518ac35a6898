//! Accelerograms: PEER AT2 in its layouts, and columns of text.

mod at2;
mod columns;
mod error;
mod number;
mod set;
mod unit;

use std::borrow::Cow;
use std::path::Path;

pub use error::{RecordError, RecordFault};
pub use set::{LengthRule, common_length};
pub use unit::AccelerationUnit;

/// Greatest size of a file (bytes): an hour at 1000 samples a second takes a fifth of it.
const LARGEST: u64 = 256 << 20;

/// Uniformly sampled accelerogram.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Title of the record: the header or comment lines of the file.
    pub title: String,
    /// Time step between samples (s), above zero.
    pub step: f64,
    /// Accelerations (m/s2), the first at the record's own time zero; at least two.
    pub samples: Vec<f64>,
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

/// Declarations of the caller about a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RecordOptions {
    /// Unit of the accelerations; `None` if the file declares it.
    pub unit: Option<AccelerationUnit>,
    /// Time step between samples (s); `None` if the file declares it.
    pub step: Option<f64>,
    /// Treatment of a declared count that differs.
    pub count: CountRule,
}

/// Reads an accelerogram: AT2 if one of the first lines declares `NPTS`, columns of text otherwise.
///
/// Columns are separated by blanks, commas, semicolons or tabs; `#` and `%` start a comment; one
/// line of column names may precede the numbers. One column holds accelerations at the step given
/// in `options`; of two, the first holds the times, which must be uniform to 1 % of a step.
///
/// # Errors
/// [`RecordError`], with the file, line, column and fault.
///
/// ```
/// use powerhouse_io::{AccelerationUnit, RecordOptions, parse_record};
/// let options = RecordOptions { unit: Some(AccelerationUnit::Gravity), ..RecordOptions::default() };
/// let record = parse_record(b"0.00, 0.0\n0.02, 0.5\n0.04, -0.25\n", &options)?;
/// assert_eq!(record.samples[1], 0.5 * 9.80665);
/// assert!((record.step - 0.02).abs() < 1e-15);
/// # Ok::<(), powerhouse_io::RecordError>(())
/// ```
pub fn read_record(file: &Path, options: &RecordOptions) -> Result<Record, RecordError> {
    let bytes = crate::read_whole(file, LARGEST).map_err(|source| RecordError::File {
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
    if let Some(found) = other_format(&text) {
        return Err(content(RecordFault::Foreign { found }));
    }
    let record = match at2::header(&text)? {
        Some(header) => at2::read(&text, &header, options)?,
        None => columns::read(&text, options)?,
    };
    if record.samples.len() < 2 {
        let found = record.samples.len();
        return Err(RecordError::content(0, 0, RecordFault::TooShort { found }));
    }
    Ok(record)
}

/// Name of another format of a file, or of a file with bytes that are not text.
fn other_format(text: &str) -> Option<&'static str> {
    let start = text.trim_start();
    if start.starts_with("$MeshFormat") {
        return Some("a Gmsh mesh");
    }
    if start.starts_with(['<', '{']) {
        return Some("a page of markup");
    }
    if start.starts_with("[mesh]") || start.contains("\n[mesh]") {
        return Some("a scene");
    }
    // Titles of old records have some bytes of other encodings, but no NUL.
    start
        .contains('\0')
        .then_some("a file of bytes that are not text")
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
