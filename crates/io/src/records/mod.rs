//! Accelerograms: PEER AT2 in its many layouts, and columns of text.

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

/// The largest file (bytes): an hour at a thousand samples a second takes a fifth of it.
const LARGEST: u64 = 256 << 20;

/// A uniformly sampled accelerogram.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// What the file says about itself: its header or comment lines.
    pub title: String,
    /// Time between samples (s), above zero.
    pub step: f64,
    /// Accelerations (m/s2), the first at the record's own time zero; at least two.
    pub samples: Vec<f64>,
    /// What was taken differently from what the file declares.
    pub warnings: Vec<String>,
}

/// What to do if a file declares another number of samples than it holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CountRule {
    /// Refuse it.
    #[default]
    AsDeclared,
    /// Take the samples that are there, and say so among the warnings.
    AsFound,
}

/// What the reader cannot know from the file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RecordOptions {
    /// The unit of the accelerations; none if the file declares it.
    pub unit: Option<AccelerationUnit>,
    /// Time between samples (s); none if the file declares it.
    pub step: Option<f64>,
    /// How strictly a declared count is taken.
    pub count: CountRule,
}

/// Reads an accelerogram: AT2 if one of the first lines declares `NPTS`, columns of text otherwise.
///
/// Columns are separated by blanks, commas, semicolons or tabs; `#` and `%` start a comment; one
/// line of column names may precede the numbers. One column holds accelerations at the step given
/// in `options`; of two, the first holds the times, which must be uniform to 1 % of a step.
///
/// # Errors
/// [`RecordError`] names the file, line and column, and what is wrong there.
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
/// As [`read_record`], without a file's name.
pub fn parse_record(bytes: &[u8], options: &RecordOptions) -> Result<Record, RecordError> {
    if let Some(step) = options.step {
        check_step(step).map_err(|fault| RecordError::content(0, 0, fault))?;
    }
    // Titles may come in any single-byte encoding; numbers are plain ASCII in all of them.
    let text = String::from_utf8_lossy(bytes);
    let text = plain(&text);
    let content = |fault| RecordError::content(0, 0, fault);
    if text.trim().is_empty() {
        return Err(content(RecordFault::Empty));
    }
    if let Some(found) = foreign(&text) {
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

/// What a file is that is no accelerogram: one of another format, or of bytes that are no text.
fn foreign(text: &str) -> Option<&'static str> {
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
    // Titles of old records hold some bytes of other encodings, but no NUL.
    start
        .contains('\0')
        .then_some("a file of bytes that are no text")
}

/// The text without a mark of UTF-8 in front or an end-of-file mark behind, and with line ends that
/// `str::lines` knows if it has only those of old systems.
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
