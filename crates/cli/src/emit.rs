//! `powerhouse emit`.

use std::path::Path;
use std::process::ExitCode;

use powerhouse::SceneChoice;

use crate::terminal::{say, warn_aside};
use crate::{Outcome, WARNED, read};

/// Writes the sources of the programs of a scene's elements into a folder; the exit status is 1 if some elements have none.
pub(crate) fn emit(path: &Path, of_file: &SceneChoice, out: &Path) -> Outcome {
    let sources = read(path, of_file)?.prepare()?.program_sources()?;
    std::fs::create_dir_all(out)
        .and_then(|()| {
            let mut files = sources.files.iter();
            files.try_for_each(|source| std::fs::write(out.join(&source.file), &source.text))
        })
        .map_err(|error| format!("cannot write sources to {}: {error}", out.display()))?;
    say!("programs of elements in steps of {:.4e} s:", sources.step);
    for source in &sources.files {
        let file = out.join(&source.file);
        say!("  {}  {} operations", file.display(), source.operations);
    }
    for reason in &sources.refused {
        warn_aside!("warning: {reason}");
    }
    Ok(if sources.refused.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(WARNED)
    })
}
