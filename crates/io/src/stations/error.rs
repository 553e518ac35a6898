//! Errors of motions of stations.

use std::path::PathBuf;

use thiserror::Error;

/// Error of reading the motions of stations.
#[derive(Debug, Error)]
#[error("{}: {fault}", file.display())]
pub struct StationFileError {
    /// Path of the file.
    pub file: PathBuf,
    /// Fault of the file.
    pub fault: StationFileFault,
}

/// Faults of a file of motions of stations.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StationFileFault {
    /// The file cannot be read.
    #[error("{0}")]
    Read(std::io::Error),
    /// An H5DRM file in a program without the feature `h5drm`.
    #[error(
        "this program was compiled without the reader of H5DRM (HDF5) files: compile it with `--features h5drm` (`cargo install powerhouse-cli --features h5drm`), or give the motions as a table (CSV)"
    )]
    NoReader,
    /// An HDF5 file without the data of H5DRM, such as one of another program.
    #[error(
        "this HDF5 file has no /DRM_Data, so it is no H5DRM file (as ShakerMaker writes it): give the motions as one, or as a table (CSV)"
    )]
    NotH5drm,
    /// The file is damaged, or no HDF5 file, or uses what the reader does not know.
    #[error("{object}: {reason}")]
    Damaged {
        /// Object of the file that cannot be read.
        object: &'static str,
        /// Reason of the reader.
        reason: String,
    },
    /// An object of the file has another shape than its stations and samples need.
    #[error("{object} has the shape {found:?}, expected {expected}")]
    Shape {
        /// Object of the file.
        object: &'static str,
        /// Its lengths.
        found: Vec<u64>,
        /// Expected lengths in words.
        expected: String,
    },
    /// A number of the file is outside its range.
    #[error("{object} = {value} at index {index}, expected {expected}")]
    Value {
        /// Object of the file.
        object: &'static str,
        /// Index of the number, from 0.
        index: usize,
        /// Its value.
        value: f64,
        /// Permitted range in words.
        expected: String,
    },
    /// The motions need more memory than they may take.
    #[error(
        "{samples} samples of {stations} stations need {needed} bytes, more than the {most} that may be taken here"
    )]
    Memory {
        /// Number of stations.
        stations: u64,
        /// Number of samples of each.
        samples: u64,
        /// Memory that they need (bytes).
        needed: u64,
        /// Memory that they may take (bytes).
        most: u64,
    },
    /// The file has more numbers than its size can hold.
    #[error(
        "{object} claims {claimed} bytes, more than a file of {size} bytes can hold, compressed or not"
    )]
    Endless {
        /// Object of the file.
        object: &'static str,
        /// Bytes that its shape needs.
        claimed: u64,
        /// Size of the file (bytes).
        size: u64,
    },
    /// A table that is none: not a header with units, or not a row of as many numbers.
    #[error(transparent)]
    Table(crate::IoError),
    /// A table without a column.
    #[error("there is no column '{name}' in {units}; the columns are {found}")]
    NoColumn {
        /// Name of the column.
        name: &'static str,
        /// Permitted units in words.
        units: String,
        /// Columns of the table.
        found: String,
    },
    /// A row of a table that does not follow its rows before.
    #[error("row {row} below the header: {reason}")]
    Row {
        /// Number of the row, from 1.
        row: usize,
        /// Reason in words.
        reason: String,
    },
}
