//! `powerhouse vtkhdf`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use powerhouse_report::fields::RecordedFields;

use crate::terminal::say;
use crate::{Outcome, check_ending};

/// Name of the file in the folder of the results.
const FILE: &str = "snapshots.vtkhdf";

/// Writes all snapshots of a run as one file.
pub(crate) fn vtkhdf(results: &Path, out: Option<PathBuf>) -> Outcome {
    if let Some(file) = &out {
        check_ending(file, ("VTKHDF file", "vtkhdf"))?;
    }
    if !results.is_dir() {
        let folder = results.display();
        return Err(
            format!("{folder} is no folder of results: the file is one of all snapshots").into(),
        );
    }
    let fields = RecordedFields::at(results)?;
    let file = out.unwrap_or_else(|| fields.folder().join(FILE));
    fields.write_vtkhdf(&file)?;
    let count = fields.len();
    let ending = if count == 1 { "" } else { "s" };
    say!("{} ({count} snapshot{ending})", file.display());
    Ok(ExitCode::SUCCESS)
}
