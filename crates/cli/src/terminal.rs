//! Output to the standard streams; no other module writes to them.
//!
//! # Why so
//! The standard output may be closed during a run (`powerhouse run scene.toml | head -1`), or its disk may be full. This
//! must not abort a computation: text that cannot be written is dropped, the result files are written nevertheless, and
//! [`settle`] reports lost output at the end. The macros of the standard library panic instead, and are forbidden in
//! this crate by lints.

use std::collections::BTreeSet;
use std::fmt::Arguments;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::FAILED;

/// Whether nothing is written, because another process writes it.
static MUTE: AtomicBool = AtomicBool::new(false);

/// Whether only warnings and errors are written, on the error stream.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Warnings that a quiet command has written.
static WARNINGS: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// File that receives all text, if one was requested.
static LOG: Mutex<Option<File>> = Mutex::new(None);

/// First error of the standard output, if there was one.
static LOST: Mutex<Option<(ErrorKind, String)>> = Mutex::new(None);

/// Writes a line to the standard output; see [`say`].
macro_rules! say {
    ($($text:tt)*) => { $crate::terminal::write_out(format_args!($($text)*), true) };
}
/// Writes text without a line break to the standard output.
macro_rules! say_on {
    ($($text:tt)*) => { $crate::terminal::write_out(format_args!($($text)*), false) };
}
/// Writes a line that begins with `warning: ` to the standard output, and to the error stream of a quiet command.
macro_rules! say_warning {
    ($($text:tt)*) => { $crate::terminal::write_warning(format_args!($($text)*)) };
}
/// Writes a line to the error stream.
macro_rules! warn_aside {
    ($($text:tt)*) => {
        if !$crate::terminal::is_mute() {
            $crate::terminal::aside(format_args!($($text)*))
        }
    };
}
pub(crate) use {say, say_on, say_warning, warn_aside};

/// Drops all further text of this process but that of [`aside`].
#[cfg_attr(
    not(feature = "mpi"),
    expect(dead_code, reason = "one process writes all text")
)]
pub(crate) fn mute() {
    MUTE.store(true, Ordering::Relaxed);
}

/// Whether text of this process is dropped.
pub(crate) fn is_mute() -> bool {
    MUTE.load(Ordering::Relaxed)
}

/// Writes only warnings and errors from now on.
pub(crate) fn quieten() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether progress is not shown.
pub(crate) fn is_quiet() -> bool {
    is_mute() || QUIET.load(Ordering::Relaxed)
}

/// Writes all further text to a file, too.
///
/// # Errors
/// A file that cannot be created, or that exists and is no log by its name.
pub(crate) fn log_to(path: &Path) -> Result<(), String> {
    let is_log = path.extension().is_some_and(|extension| extension == "log");
    if let Ok(found) = path.symlink_metadata()
        && !(is_log && found.is_file())
    {
        return Err(format!(
            "{} exists and is kept: a log replaces files with names that end with .log alone",
            path.display()
        ));
    }
    let file = File::create(path)
        .map_err(|error| format!("cannot write the log {}: {error}", path.display()))?;
    *LOG.lock().unwrap_or_else(PoisonError::into_inner) = Some(file);
    Ok(())
}

/// Writes text to the log; a log that cannot be written ends, and says so once.
fn log(text: Arguments, end: &str) {
    let mut log = LOG.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(Err(error)) = log.as_mut().map(|file| write!(file, "{text}{end}")) else {
        return;
    };
    *log = None;
    let _ = writeln!(
        std::io::stderr().lock(),
        "warning: the log ends here, since it cannot be written: {error}"
    );
}

/// Writes a warning; see [`say_warning`]. A quiet command writes each once, since there is nothing between them.
pub(crate) fn write_warning(text: Arguments) {
    if is_mute() || !is_quiet() {
        write_out(format_args!("warning: {text}"), true);
        return;
    }
    let mut written = WARNINGS.lock().unwrap_or_else(PoisonError::into_inner);
    if written.insert(text.to_string()) {
        aside(format_args!("warning: {text}"));
    }
}

/// Writes text to the standard output, with a line break if `line`; after an error nothing more is written.
pub(crate) fn write_out(text: Arguments, line: bool) {
    let end = if line { "\n" } else { "" };
    if !is_mute() {
        log(text, end);
    }
    let mut lost = LOST.lock().unwrap_or_else(PoisonError::into_inner);
    if lost.is_some() || is_quiet() {
        return;
    }
    let mut out = std::io::stdout().lock();
    let written = write!(out, "{text}{end}").and_then(|()| out.flush());
    if let Err(error) = written {
        *lost = Some((error.kind(), error.to_string()));
    }
}

/// Writes a line to the error stream; a line that cannot be written is dropped.
pub(crate) fn aside(text: Arguments) {
    log(text, "\n");
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// The exit status of a command after all its output.
///
/// A closed standard output has no effect. Output that was lost for another reason, such as a full disk, is reported on
/// the error stream, and the command fails if that output is its only product.
pub(crate) fn settle(status: ExitCode, only_prints: bool) -> ExitCode {
    let lost = LOST.lock().unwrap_or_else(PoisonError::into_inner);
    match &*lost {
        Some((kind, reason)) if *kind != ErrorKind::BrokenPipe => {
            aside(format_args!(
                "the standard output could not be written: {reason}"
            ));
            if only_prints {
                ExitCode::from(FAILED)
            } else {
                status
            }
        }
        _ => status,
    }
}
