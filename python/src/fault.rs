//! Errors as exceptions of Python, with the text and place of the command's messages.

use std::path::Path;

use powerhouse::{Error, RenderFault as _};
use powerhouse_study::StudyError;
use pyo3::prelude::*;
use pyo3::types::PyType;

/// Module with the classes of exceptions.
const MODULE: &str = "powerhouse_fe.errors";
/// What the command's messages begin with, which a class of exceptions says already.
const PREFIX: &str = "error: ";

/// An exception of a class of the package with a message.
pub(crate) fn exception(py: Python<'_>, class: &str, message: &str) -> PyErr {
    let found = py
        .import(MODULE)
        .and_then(|module| module.getattr(class))
        .and_then(|class| Ok(class.cast_into::<PyType>()?));
    match found {
        Ok(class) => PyErr::from_type(class, (message.to_owned(),)),
        Err(error) => error,
    }
}

/// Sets an attribute of an exception.
pub(crate) fn with<'py>(
    py: Python<'py>,
    error: PyErr,
    name: &str,
    value: impl IntoPyObject<'py>,
) -> PyErr {
    match error.value(py).setattr(name, value) {
        Ok(()) => error,
        Err(failed) => failed,
    }
}

/// The exception of an error of the facade.
pub(crate) fn of(py: Python<'_>, error: &Error) -> PyErr {
    let class = match error {
        Error::Scene(fault) => {
            let text = fault.render(false);
            let message = text.strip_prefix(PREFIX).unwrap_or(&text);
            let (line, column) = fault.position();
            let found = exception(py, "SceneError", message);
            let found = with(py, found, "problem", fault.problem().to_string());
            let found = with(py, found, "path", text_of(fault.path()));
            let found = with(py, found, "line", line);
            return with(py, found, "column", column);
        }
        Error::Read { .. } | Error::NoSuchCase { .. } => "InputError",
        Error::Write(_) | Error::Folder(_) | Error::SavedState { .. } => "FolderError",
        Error::Checkpoint(_) | Error::UnreadableBody { .. } => "FolderError",
        Error::Run(_) | Error::Failed { .. } | Error::Stage(_) | Error::HandOver { .. } => {
            "RunError"
        }
        _ => "InputError",
    };
    exception(py, class, &error.to_string())
}

/// The exception of an error of a study.
pub(crate) fn of_study(py: Python<'_>, error: &StudyError) -> PyErr {
    match error {
        StudyError::Scene(error) => of(py, error),
        StudyError::Unfinished { .. } | StudyError::UnreadableCheckpoint { .. } => {
            let message = error.to_string().replace("`--restart`", "`restart=True`");
            exception(py, "FolderError", &message)
        }
        error => exception(py, "InputError", &error.to_string()),
    }
}

/// An error of scene or study, which is made an exception where the interpreter is at hand.
pub(crate) enum Failure {
    /// Error of scene, run or files.
    Scene(Error),
    /// Error of a study.
    Study(StudyError),
}

impl Failure {
    /// The exception.
    pub(crate) fn exception(&self, py: Python<'_>) -> PyErr {
        match self {
            Self::Scene(error) => of(py, error),
            Self::Study(error) => of_study(py, error),
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Scene(error)
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        Self::Study(error)
    }
}

/// A path as text.
pub(crate) fn text_of(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
