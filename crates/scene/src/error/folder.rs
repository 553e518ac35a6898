//! Errors of results folders.

use std::path::PathBuf;

use thiserror::Error;

/// Error of a results folder that cannot hold the files of a run, or lost them.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FolderError {
    /// Folder in which another run writes, in `ResultFolder::lock`.
    #[error(
        "{}: {holder} writes into this folder; wait for its end or give another folder (--out)",
        folder.display()
    )]
    Busy {
        /// Path of the folder.
        folder: PathBuf,
        /// Run that holds the lock: its process and start time.
        holder: String,
    },
    /// Folder that cannot be created, or in which files cannot be written.
    #[error(
        "{}: cannot write into this folder ({source}); give another folder (--out)",
        folder.display()
    )]
    Unwritable {
        /// Path of the folder.
        folder: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// Folder that was removed or replaced during the run, in `FolderLock::release` at its end.
    #[error(
        "{}: this folder, or its lock, was removed while the run went on; results in memory were written to it again, but files written before (snapshots, stages) may be missing",
        folder.display()
    )]
    Gone {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// Insufficient disk space for the files of the run, in `ResultFolder::prove`.
    #[error(
        "{}: the run may write up to {:.3} GB, {:.3} GB are free; request fewer snapshots or give another folder (--out)",
        folder.display(), *needed as f64 / 1e9, *free as f64 / 1e9
    )]
    NoRoom {
        /// Path of the folder.
        folder: PathBuf,
        /// Upper bound of the size of the files (bytes).
        needed: u64,
        /// Free disk space (bytes).
        free: u64,
    },
    /// Folder whose copy of the scene would take the place of the scene itself, in
    /// `ResultFolder::keep_scene`.
    #[error(
        "the copy of the scene among the results would take the place of {}: choose another folder with --out",
        scene.display()
    )]
    OfScene {
        /// Path of the scene file.
        scene: PathBuf,
    },
    /// Folder with the path of a result file, in `ResultFolder::prove`.
    #[error("{}: there is a folder of this name, which a result file needs", file.display())]
    InTheWay {
        /// Path of the file.
        file: PathBuf,
    },
}
