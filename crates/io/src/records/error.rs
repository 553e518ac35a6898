//! What can be wrong with an accelerogram, and where.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// An accelerogram that could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The operating system refused.
    #[error("{}: {source}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The content is at fault.
    #[error("{}{fault}", place(file.as_deref(), *line, *column))]
    Content {
        /// The file; none if it was parsed from memory.
        file: Option<PathBuf>,
        /// Line, from 1; 0 if the fault has no line.
        line: usize,
        /// Column, from 1; 0 if the fault has no column.
        column: usize,
        /// What is wrong.
        fault: RecordFault,
    },
}

/// What is wrong with an accelerogram.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RecordFault {
    /// Something that should be a number is none.
    #[error("{text:?} is no number")]
    NotANumber {
        /// What stands there.
        text: String,
    },
    /// A number that is not finite.
    #[error("{text:?} is not finite")]
    NotFinite {
        /// What stands there.
        text: String,
    },
    /// Nothing but white space.
    #[error("the file is empty")]
    Empty,
    /// A file of another kind.
    #[error("this is {found}, no accelerogram: PEER AT2, or one or two columns of numbers")]
    Foreign {
        /// What it seems to be.
        found: &'static str,
    },
    /// Neither a header of PEER AT2 nor a row of numbers.
    #[error(
        "neither a header of PEER AT2 with NPTS and DT nor columns of numbers are found: {text:?} stands first"
    )]
    NoNumbers {
        /// The first line.
        text: String,
    },
    /// A header without a number of samples or a step.
    #[error("the header declares no {what}")]
    Header {
        /// `NPTS` or `DT`.
        what: &'static str,
    },
    /// Another number of samples than declared.
    #[error("the header declares {declared} samples, the file holds {found}")]
    Count {
        /// Declared.
        declared: u64,
        /// Found.
        found: usize,
    },
    /// A step that is zero, negative or not finite.
    #[error("the time step {value} s is not above zero")]
    Step {
        /// The step (s).
        value: f64,
    },
    /// A step that neither the file nor the caller declares.
    #[error("one column of numbers needs its time step to be declared")]
    NoStep,
    /// A step declared twice, differently.
    #[error("the file's time step is {found} s, the declared one {declared} s")]
    StepConflict {
        /// Of the file (s).
        found: f64,
        /// Of the caller (s).
        declared: f64,
    },
    /// A unit that neither the file nor the caller declares.
    #[error("neither the file nor the caller declares the unit of acceleration")]
    NoUnit,
    /// A unit in the file that is none of acceleration, such as that of a velocity.
    #[error("the file's unit {found:?} is none of acceleration (g, gal, cm/s2, m/s2)")]
    UnknownUnit {
        /// What stands there.
        found: String,
    },
    /// A unit declared twice, differently.
    #[error("the file's unit is {found}, the declared one {declared}")]
    UnitConflict {
        /// Of the file.
        found: &'static str,
        /// Of the caller.
        declared: &'static str,
    },
    /// A row with another number of columns than the first, or more than two.
    #[error("{found} columns instead of {expected}")]
    Columns {
        /// Found.
        found: usize,
        /// Wanted, as words.
        expected: &'static str,
    },
    /// Times that are not uniform.
    #[error("time {time} s is not the expected {expected} s: the samples are not uniform")]
    NotUniform {
        /// The time (s).
        time: f64,
        /// What a uniform step makes it (s).
        expected: f64,
    },
    /// Fewer than two samples.
    #[error("a record needs two samples at least, there are {found}")]
    TooShort {
        /// How many.
        found: usize,
    },
    /// Components with different steps.
    #[error("component {component} has the time step {found} s, the first one {expected} s")]
    StepsDiffer {
        /// Which, from 0.
        component: usize,
        /// Its step (s).
        found: f64,
        /// The first one's (s).
        expected: f64,
    },
}

impl RecordError {
    pub(super) fn content(line: usize, column: usize, fault: RecordFault) -> Self {
        Self::Content {
            file: None,
            line,
            column,
            fault,
        }
    }
    pub(super) fn in_file(mut self, name: &Path) -> Self {
        if let Self::Content { file, .. } = &mut self {
            *file = Some(name.into());
        }
        self
    }
}

fn place(file: Option<&Path>, line: usize, column: usize) -> String {
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
