//! Errors of checkpoints.

use std::io::ErrorKind;
use std::path::PathBuf;

use powerhouse_io::{IoError, SectionFileError};
use powerhouse_model::{ModelError, StateError};
use thiserror::Error;

/// Checkpoint that cannot be read or does not belong to a run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// No checkpoint in a folder.
    #[error("{} has no checkpoint from which the run could be resumed", folder.display())]
    None {
        /// The results folder.
        folder: PathBuf,
    },
    /// File that cannot be read, is incomplete, damaged, or of another version.
    #[error(transparent)]
    File(#[from] SectionFileError),
    /// Section of a file that does not encode what it should.
    #[error("{}: section '{section}': {source}", file.display())]
    Section {
        /// The file.
        file: PathBuf,
        /// Name of the section.
        section: String,
        /// Cause.
        source: StateError,
    },
    /// Checkpoint of a run with other inputs.
    #[error("{} belongs to another run; changed since: {what}", file.display())]
    OtherRun {
        /// The file.
        file: PathBuf,
        /// The inputs that differ.
        what: String,
    },
    /// Time at which no state was kept.
    #[error("{} has no state at t = {time} s: {}", folder.display(), of_available(available))]
    NoState {
        /// The results folder.
        folder: PathBuf,
        /// The time (s).
        time: f64,
        /// Times (s) of the states that were kept.
        available: Vec<f64>,
    },
    /// Change of a scene that acts before the state from which its run is to start.
    #[error("no variant of the run can start from {}: {what} must be as in the run", file.display())]
    Variant {
        /// The file of the state.
        file: PathBuf,
        /// The inputs that differ and may not.
        what: String,
    },
    /// Run that ends before the state from which it is to start.
    #[error(
        "the run ends at t = {end} s, but starts from a state at t = {time} s: the duration counts from the start of the first run"
    )]
    Ended {
        /// Time of the state (s).
        time: f64,
        /// End of the run (s).
        end: f64,
    },
    /// Incident waves that differ from those of the run at the time of the state from which a run is to start.
    #[error("no variant of the run can start from {}: its incident waves have another motion at t = {time} s, at the nodes of the mesh", file.display())]
    Waves {
        /// The file of the state.
        file: PathBuf,
        /// Time of the state (s).
        time: f64,
    },
    /// Incident motion that cannot be computed.
    #[error("the incident motion at a checkpoint: {0}")]
    Motion(ModelError),
    /// Both generations of a checkpoint cannot be used.
    #[error("no checkpoint can be used: {latest}; {previous}")]
    Both {
        /// Reason for the last one.
        latest: Box<CheckpointError>,
        /// Reason for the one before.
        previous: Box<CheckpointError>,
    },
    /// State that cannot be written.
    #[error(transparent)]
    Write(#[from] IoError),
    /// State that cannot be encoded.
    #[error("the state of a checkpoint: {0}")]
    State(StateError),
}

impl CheckpointError {
    /// Whether a file is not there.
    pub fn is_absent(&self) -> bool {
        matches!(self, Self::File(SectionFileError::Read { source, .. }) if source.kind() == ErrorKind::NotFound)
    }
}

/// What to do without a state at a time.
fn of_available(times: &[f64]) -> String {
    match times {
        [] => "none was kept, as the key keep of [checkpoint] requests".into(),
        times => {
            let times: Vec<String> = times.iter().map(|time| format!("{time} s")).collect();
            format!("there are states at {}", times.join(", "))
        }
    }
}
