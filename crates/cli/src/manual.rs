//! `powerhouse completions` and `powerhouse man`.

use std::path::Path;
use std::process::ExitCode;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::terminal::{say, say_on};
use crate::{Arguments, Outcome};

/// Name of the command.
const NAME: &str = "powerhouse";

/// Prints the completions of a shell.
pub(crate) fn completions(shell: Shell) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), NAME, &mut script);
    say_on!("{}", String::from_utf8(script)?);
    Ok(ExitCode::SUCCESS)
}

/// Writes the manual pages of the command and its subcommands into a folder.
pub(crate) fn pages(folder: &Path) -> Outcome {
    std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(Arguments::command().name(NAME), folder))
        .map_err(|error| format!("cannot write manual pages to {}: {error}", folder.display()))?;
    say!("manual pages are in {}", folder.display());
    Ok(ExitCode::SUCCESS)
}
