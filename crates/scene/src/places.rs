//! Places of the values of a scene in the file that it was read from.

use std::sync::Arc;

use crate::Error;

/// What of a scene an error is about, where the error alone does not say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Subject {
    /// What the error names.
    OfError,
    /// The kind of the absorbing boundary.
    Boundary,
    /// The region of a domain reduction.
    Region,
    /// A symmetry plane, by its index.
    Mirror(usize),
}

/// Places of the values of a scene in what its user wrote, such as a file.
pub trait Places: Send + Sync {
    /// An error about a subject with its place; unchanged if its place is not known.
    fn placed(&self, subject: Subject, error: Error) -> Error;
}

/// An error with its place, if there are places and its own is known.
pub(crate) fn placed(places: Option<&Arc<dyn Places>>, subject: Subject, error: Error) -> Error {
    match places {
        Some(places) => places.placed(subject, error),
        None => error,
    }
}
