//! What can go wrong with files other than meshes.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// A file that could not be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum IoError {
    /// The operating system refused.
    #[error("{}: {source}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A number that is not finite where results are written.
    #[error("{}: '{what}' has the value {value} at place {place}, which is not finite", file.display())]
    NotFinite {
        /// The file.
        file: PathBuf,
        /// The column or field.
        what: String,
        /// Its place, from 0.
        place: usize,
        /// The value.
        value: f64,
    },
    /// A number that should be a whole one of 32 bits.
    #[error("{}: '{what}' has the value {value} at place {place}, which is not a whole number of 32 bits", file.display())]
    NotWhole {
        /// The file.
        file: PathBuf,
        /// The field.
        what: String,
        /// Its place, from 0.
        place: usize,
        /// The value.
        value: f64,
    },
    /// A field or column whose length does not fit.
    #[error("{}: '{what}' has {found} values instead of {expected}", file.display())]
    Length {
        /// The file.
        file: PathBuf,
        /// The column or field.
        what: String,
        /// Values given.
        found: usize,
        /// Values wanted.
        expected: usize,
    },
    /// A facet of a picture with fewer than three corners, or one that is not there.
    #[error("{}: facet {facet} needs three corners or more among the {corners} given", file.display())]
    Facet {
        /// The file.
        file: PathBuf,
        /// Its place, from 0.
        facet: usize,
        /// Corners given.
        corners: usize,
    },
    /// A name that the format cannot hold.
    #[error("{}: the name {name:?} cannot be written", file.display())]
    Name {
        /// The file.
        file: PathBuf,
        /// The name.
        name: String,
    },
    /// A plot without points, or a picture without elements in sight.
    #[error("{}: there is nothing to draw", file.display())]
    NothingToDraw {
        /// The file.
        file: PathBuf,
    },
    /// A setting outside its range.
    #[error("{}: {source}", file.display())]
    Setting {
        /// The file.
        file: PathBuf,
        /// Which, and what is permitted.
        source: powerhouse_model::ParameterError,
    },
    /// A summary that cannot be written as JSON.
    #[error("{}: {source}", file.display())]
    Json {
        /// The file.
        file: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// A value that is missing or not finite in a summary.
    #[error("{}: the value at {place} is missing or not finite", file.display())]
    Null {
        /// The file.
        file: PathBuf,
        /// Its path in the summary.
        place: String,
    },
    /// A table that cannot be read back.
    #[error("{}:{line}: {reason}", file.display())]
    Table {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Why.
        reason: String,
    },
}

impl IoError {
    pub(crate) fn file(file: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let file = file.to_path_buf();
        move |source| Self::File { file, source }
    }
}
