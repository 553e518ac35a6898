//! The one place that writes to the standard streams.
//!
//! # Why so
//! A reader may go away while a run computes (`powerhouse run scene.toml | head -1`), and a stream may be a
//! full disk. No text on a stream is worth a computation: what cannot be written is dropped, the files of
//! results are written all the same, and [`settle`] says at the end what became of the output. The macros of
//! the standard library panic instead, and are forbidden in this crate by lints.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use crate::FAILED;

/// Why the standard output took no more, if it did not: the first reason.
static LOST: Mutex<Option<(ErrorKind, String)>> = Mutex::new(None);

/// Writes a line to the standard output; see [`say`].
macro_rules! say {
    ($($text:tt)*) => { $crate::terminal::write_out(format_args!($($text)*), true) };
}
/// Writes text without a line break to the standard output.
macro_rules! say_on {
    ($($text:tt)*) => { $crate::terminal::write_out(format_args!($($text)*), false) };
}
/// Writes a line to the error stream.
macro_rules! warn_aside {
    ($($text:tt)*) => { $crate::terminal::aside(format_args!($($text)*)) };
}
pub(crate) use {say, say_on, warn_aside};

/// Writes text to the standard output, as a line if wanted. Once it could not, nothing more is tried.
pub(crate) fn write_out(text: Arguments, line: bool) {
    let mut lost = LOST.lock().unwrap_or_else(PoisonError::into_inner);
    if lost.is_some() {
        return;
    }
    let end = if line { "\n" } else { "" };
    let mut out = std::io::stdout().lock();
    let written = write!(out, "{text}{end}").and_then(|()| out.flush());
    if let Err(error) = written {
        *lost = Some((error.kind(), error.to_string()));
    }
}

/// Writes a line to the error stream; one that cannot be written is dropped, there is nowhere else to say
/// it.
pub(crate) fn aside(text: Arguments) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// The exit status of a command after all its output. A reader that went away changes nothing. Output that
/// could not be written for another reason, such as a full disk, is said on the error stream, and fails the
/// command if that output is its only product.
pub(crate) fn settle(status: ExitCode, only_prints: bool) -> ExitCode {
    let lost = LOST.lock().unwrap_or_else(PoisonError::into_inner);
    match &*lost {
        Some((kind, reason)) if *kind != ErrorKind::BrokenPipe => {
            aside(format_args!(
                "the standard output could not be written: {reason}"
            ));
            match only_prints {
                true => ExitCode::from(FAILED),
                false => status,
            }
        }
        _ => status,
    }
}
