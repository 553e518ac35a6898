//! `powerhouse vtkhdf`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use powerhouse_study::fields::RecordedFields;

use crate::terminal::say;
use crate::{Outcome, check_ending};

/// Name of the file in the folder of the results.
const FILE: &str = "snapshots.vtkhdf";

/// Writes all snapshots of a run as one file.
pub(crate) fn vtkhdf(results: &Path, out: Option<PathBuf>) -> Outcome {
    if let Some(file) = &out {
        check_ending(file, ("VTKHDF file", "vtkhdf"))?;
    }
    let fields = RecordedFields::at(results)?;
    let file = out.unwrap_or_else(|| fields.folder().join(FILE));
    fields.write_vtkhdf(&file)?;
    say!("{} ({} snapshots)", file.display(), fields.len());
    Ok(ExitCode::SUCCESS)
}
