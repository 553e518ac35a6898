//! Errors of the mesh of a machine bay.

use std::path::PathBuf;

use powerhouse::model::{MeshError, ParameterError};
use thiserror::Error;

/// Error of the mesh of a machine bay.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BayError {
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A mesh that cannot be built, or a set that it does not have.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", file.display())]
    Read {
        /// Path of the file.
        file: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// A file that is not valid TOML or has unknown keys.
    #[error("{}: {source}", file.display())]
    File {
        /// Path of the file.
        file: PathBuf,
        /// Cause, with the position in the file.
        source: Box<toml::de::Error>,
    },
    /// An odd number of elements across the transformer cavern, so that its axis would have no nodes.
    #[error("the transformer cavern needs an even number of elements across it, not {cells}")]
    OddCells {
        /// The number.
        cells: usize,
    },
    /// A picture that cannot be written.
    #[error(transparent)]
    Picture(#[from] powerhouse::Error),
}
