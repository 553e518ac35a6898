//! Errors of files other than meshes and accelerograms.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Errors of reading and writing files.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum IoError {
    /// The operating system returned an error when a file or folder was opened, read or written.
    #[error("{}: {source}", file.display())]
    File {
        /// Path of the file.
        file: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A number that is to be written to a table, plot, picture or VTU file is not finite.
    #[error("{}: '{what}' has the value {value} at index {index}, which is not finite", file.display())]
    NotFinite {
        /// Path of the file.
        file: PathBuf,
        /// Name of the column or field.
        what: String,
        /// Index of the number, from 0.
        index: usize,
        /// Value of the number.
        value: f64,
    },
    /// A number of an integer field of a VTU file is not an integer of 32 bits.
    #[error("{}: '{what}' has the value {value} at index {index}, which is not a 32-bit integer", file.display())]
    NotWhole {
        /// Path of the file.
        file: PathBuf,
        /// Name of the field.
        what: String,
        /// Index of the number, from 0.
        index: usize,
        /// Value of the number.
        value: f64,
    },
    /// A field or column that is to be written has the wrong number of values.
    #[error("{}: '{what}' has {found} values instead of {expected}", file.display())]
    Length {
        /// Path of the file.
        file: PathBuf,
        /// Name of the column or field.
        what: String,
        /// Number of values given.
        found: usize,
        /// Number of values required.
        expected: usize,
    },
    /// A facet of a picture has fewer than three corners, or a corner that does not exist.
    #[error("{}: facet {facet} needs at least three corners, all among the {corners} given", file.display())]
    Facet {
        /// Path of the file.
        file: PathBuf,
        /// Index of the facet, from 0.
        facet: usize,
        /// Number of corners given.
        corners: usize,
    },
    /// The name or unit of a column of a table has control characters and cannot be written.
    #[error("{}: the name {name:?} cannot be written", file.display())]
    Name {
        /// Path of the file.
        file: PathBuf,
        /// Name that cannot be written.
        name: String,
    },
    /// A plot has no points, or a picture shows no element.
    #[error("{}: there is nothing to draw", file.display())]
    NothingToDraw {
        /// Path of the file.
        file: PathBuf,
    },
    /// A setting of a picture is outside its permitted range.
    #[error("{}: {source}", file.display())]
    Setting {
        /// Path of the file.
        file: PathBuf,
        /// Name, value and permitted range of the setting.
        source: powerhouse_model::ParameterError,
    },
    /// A summary that is to be written cannot be represented as JSON.
    #[cfg(feature = "json")]
    #[error("{}: {source}", file.display())]
    Json {
        /// Path of the file.
        file: PathBuf,
        /// Error of the JSON writer.
        source: serde_json::Error,
    },
    /// A value of a summary that is to be written is missing (`null`) or not finite.
    #[error("{}: the value at {path} is missing or not finite", file.display())]
    Null {
        /// Path of the file.
        file: PathBuf,
        /// Path of the value in the summary, such as `.peaks[2].value`.
        path: String,
    },
    /// A VTU or PVD file that is read is damaged, or has another form than those that are written.
    #[error("{}: {reason}", file.display())]
    Grid {
        /// Path of the file.
        file: PathBuf,
        /// Reason in words.
        reason: String,
    },
    /// A line of a table that is read is not a header with units, or not a row of as many numbers.
    #[error("{}:{line}: {reason}", file.display())]
    Table {
        /// Path of the file.
        file: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// Reason in words.
        reason: String,
    },
}

impl IoError {
    /// Conversion of an error of the operating system into that of a file: `fs::read(path).map_err(IoError::file(path))`.
    pub fn file(file: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let file = file.to_path_buf();
        move |source| Self::File { file, source }
    }
}
