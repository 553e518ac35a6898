//! Errors of changes of keys.

use thiserror::Error;

/// Change of a key that cannot be made.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum KeyChangeError {
    /// Text that is not a key and a value.
    #[error(
        "'{text}' is not a change of a key; expected KEY=VALUE, such as time.duration=5, with names that have spaces or points in quotes: part.\"rock mass\".kernel=hex8-eas"
    )]
    Syntax {
        /// The text.
        text: String,
    },
    /// Key on the way whose value is not a table.
    #[error("'{text}': '{key}' is a value of the scene file, not a table")]
    NotATable {
        /// The change.
        text: String,
        /// Key on the way.
        key: String,
    },
    /// Table among several of one kind that does not exist, or that is not named.
    #[error(
        "'{text}': the scene file has no single '{key}' of that name; expected {}a position from 1 to {count}",
        any_of(names)
    )]
    NoSuchTable {
        /// The change.
        text: String,
        /// Kind of the tables.
        key: String,
        /// Names of the tables; empty for those without one.
        names: Vec<String>,
        /// Number of the tables.
        count: usize,
    },
}

/// The beginning of an alternative: names, if there are any.
fn any_of(names: &[String]) -> String {
    if names.is_empty() {
        String::new()
    } else {
        format!("one of {}, or ", names.join(", "))
    }
}
