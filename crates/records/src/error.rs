//! Errors of accelerograms, with their position.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Errors of reading an accelerogram.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The operating system returned an error when a file or folder was opened, read or written.
    #[error("{}: {source}", file.display())]
    File {
        /// Path of the file.
        file: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The content of the file, or a declaration of the caller, is invalid.
    #[error("{}{fault}", position(file.as_deref(), *line, *column))]
    Content {
        /// Path of the file; `None` if the content was parsed from memory.
        file: Option<PathBuf>,
        /// Number of the line, from 1; 0 if the fault has no line.
        line: usize,
        /// Number of the column, from 1; 0 if the fault has no column.
        column: usize,
        /// Fault of the content.
        fault: RecordFault,
    },
}

/// Faults of the content of an accelerogram.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RecordFault {
    /// A text in the place of a number is not a number.
    #[error("{text:?} is not a number")]
    NotANumber {
        /// Text of the file.
        text: String,
    },
    /// A number is not finite.
    #[error("{text:?} is not finite")]
    NotFinite {
        /// Text of the file.
        text: String,
    },
    /// The file has nothing but white space.
    #[error("the file is empty")]
    Empty,
    /// The file has another known format, not that of an accelerogram.
    #[error("this is {found}, not an accelerogram that is read: {way}")]
    Foreign {
        /// Probable format of the file.
        found: &'static str,
        /// How to get to an accelerogram.
        way: &'static str,
    },
    /// The file has neither the header of a known format nor a row of numbers.
    #[error(
        "no header of a known format (for PEER AT2 a line with NPTS and DT) and no columns of numbers are found; the first line is {text:?}"
    )]
    NoNumbers {
        /// First line of the file.
        text: String,
    },
    /// The header of the format lacks what the samples need.
    #[error("the header declares no {what}")]
    Header {
        /// Missing quantity, such as `NPTS` or `DT`.
        what: &'static str,
    },
    /// The samples are of another quantity than acceleration.
    #[error("the file has {found:?}, not accelerations, which alone are read")]
    Quantity {
        /// Quantity as the file names it.
        found: String,
    },
    /// A number stands for a missing sample.
    #[error("{text} stands for a missing sample: the record has a gap or is damaged here")]
    Filler {
        /// Text of the file.
        text: String,
    },
    /// The samples exceed the peak that the header declares, or do not reach it.
    #[error("the header declares a peak of {declared} {unit}, the samples have {found:.6} {unit}")]
    Peak {
        /// Peak of the header.
        declared: f64,
        /// Peak of the samples.
        found: f64,
        /// Unit of both.
        unit: &'static str,
    },
    /// Another record starts behind the samples of a format of one component.
    #[error(
        "another record starts here, behind the samples that end in line {last}: keep each in a file of its own"
    )]
    SecondRecord {
        /// Number of the last line of samples before it, from 1.
        last: usize,
    },
    /// The file has several channels, and the caller names none.
    #[error(
        "the file has the channels {channels}: the key `channel` chooses one by its number or name"
    )]
    Channels {
        /// Numbers and names.
        channels: String,
    },
    /// The file has no channel of the name or number that the caller gives.
    #[error("there is no one channel {wanted:?}; the channels are {channels}")]
    NoSuchChannel {
        /// Name or number of the caller.
        wanted: String,
        /// Numbers and names.
        channels: String,
    },
    /// Rows have more than two numbers, and no names tell what they are.
    #[error(
        "rows of {width} numbers: `values_in_a_row = {width}` reads them as successive samples, `columns = {{ time = 1, acceleration = 2 }}` one of them; the file starts with{lines}"
    )]
    Layout {
        /// Numbers of a row.
        width: usize,
        /// First lines of the file.
        lines: String,
    },
    /// What is in front of the samples may be a count or a step, or a sample.
    #[error(
        "{found} in front of the samples may be their number or step: `skip` leaves out that many first lines of the file (0 takes it as a sample), `time_step` declares the step; the file starts with{lines}"
    )]
    Leader {
        /// The numbers.
        found: String,
        /// First lines of the file.
        lines: String,
    },
    /// A line of words starts with a number.
    #[error(
        "{text:?} follows a number: `skip` leaves out that many first lines of the file, if this is a title"
    )]
    TitleRow {
        /// Text of the file.
        text: String,
    },
    /// The caller chooses a column that the file does not have.
    #[error("there is no column {column}; the rows have {width} numbers")]
    NoSuchColumn {
        /// Number of the column, from 1.
        column: usize,
        /// Numbers of a row.
        width: usize,
    },
    /// The number of samples differs from the declared one, under [`CountRule::AsDeclared`](crate::CountRule::AsDeclared).
    #[error("the header declares {declared} samples, the file has {found}")]
    Count {
        /// Declared number of samples.
        declared: u64,
        /// Number of samples in the file.
        found: usize,
    },
    /// The time step of the file or of the caller is zero, negative or not finite.
    #[error("the time step {value} s is not above zero")]
    Step {
        /// Step (s).
        value: f64,
    },
    /// Neither the file nor the caller declares the time step.
    #[error(
        "neither the file nor the caller declares the time step: the key `time_step` of the record does"
    )]
    NoStep,
    /// The time steps of the file and of the caller differ by more than rounding.
    #[error("the file's time step is {found} s, the declared one {declared} s")]
    StepConflict {
        /// Step of the file (s).
        found: f64,
        /// Step declared by the caller (s).
        declared: f64,
    },
    /// Neither the file nor the caller declares the unit.
    #[error(
        "neither the file nor the caller declares the unit of acceleration: the key `units` of the record does"
    )]
    NoUnit,
    /// The unit of the file is not one of acceleration, but for example of velocity.
    #[error("the file's unit {found:?} is not a unit of acceleration (m/s2, cm/s2 or gal, g)")]
    UnknownUnit {
        /// Unit as written in the file.
        found: String,
    },
    /// The unit of the file is not the one in which files of its format are.
    #[error(
        "the file's unit {found:?} is not {usual}, in which all files of this format are: its header may be damaged"
    )]
    UnusualUnit {
        /// Unit as written in the file.
        found: String,
        /// Unit of the format.
        usual: &'static str,
    },
    /// The units of the file and of the caller differ.
    #[error("the file's unit is {found}, the declared one {declared}")]
    UnitConflict {
        /// Unit of the file.
        found: &'static str,
        /// Unit declared by the caller.
        declared: &'static str,
    },
    /// A row has another number of values than the ones before it, or than declared.
    #[error("the row has {found} numbers, not {expected}")]
    RowLength {
        /// Numbers of the row.
        found: usize,
        /// Expected number.
        expected: usize,
    },
    /// The times of the first column are not uniform to 1 % of a step.
    #[error("time {time} s is not the expected {expected} s: the samples are not uniform")]
    NotUniform {
        /// Time in the file (s).
        time: f64,
        /// Time at a uniform step (s).
        expected: f64,
    },
    /// There are fewer than two samples.
    #[error("a record needs at least two samples, but has {found}")]
    TooShort {
        /// Number of samples.
        found: usize,
    },
    /// Components of one station have time steps that differ by more than 1e-6 of the first; from
    /// [`common_length`](crate::common_length).
    #[error("component {component} has the time step {found} s, the first one {expected} s")]
    StepsDiffer {
        /// Index of the component, from 0.
        component: usize,
        /// Step of the component (s).
        found: f64,
        /// Step of the first component (s).
        expected: f64,
    },
}

impl RecordError {
    pub(crate) fn content(line: usize, column: usize, fault: RecordFault) -> Self {
        Self::Content {
            file: None,
            line,
            column,
            fault,
        }
    }
    pub(crate) fn in_file(mut self, name: &Path) -> Self {
        if let Self::Content { file, .. } = &mut self {
            *file = Some(name.into());
        }
        self
    }
}

fn position(file: Option<&Path>, line: usize, column: usize) -> String {
    let mut text = file.map_or(String::new(), |file| format!("{}:", file.display()));
    if line > 0 {
        text.push_str(&format!("{line}:"));
    }
    if column > 0 {
        text.push_str(&format!("{column}:"));
    }
    if !text.is_empty() {
        text.push(' ');
    }
    text
}
