//! Faults of a scene file, with their byte range.

mod text;

use core::ops::Range;

use thiserror::Error;

use crate::magnitude::Magnitude;

pub use text::{SceneFault, SceneText};

/// Hint on how to accept quantities outside their usual range.
const ALLOW_MAGNITUDES: &str = "if the value is intended, `allow = [\"magnitudes\"]` at the top of the scene turns this error into a warning";

/// Type of a fault in a scene file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Problem {
    /// The text is not TOML.
    #[error("{message}")]
    Syntax {
        /// Message of the parser.
        message: String,
    },
    /// Unknown key.
    #[error("unknown key '{key}'")]
    UnknownKey {
        /// The key.
        key: String,
        /// Permitted keys of the table.
        permitted: Vec<String>,
    },
    /// Missing required key.
    #[error("the key '{key}' is missing")]
    MissingKey {
        /// The key.
        key: String,
    },
    /// Text that is not one of the permitted choices.
    #[error("'{found}' is not permitted here")]
    UnknownChoice {
        /// Text in the file.
        found: String,
        /// Permitted choices.
        permitted: Vec<String>,
    },
    /// Value of a wrong type, or outside its permitted range, or two values in the wrong order.
    #[error("found {found}, expected {expected}")]
    Value {
        /// Value in the file.
        found: String,
        /// Permitted type or range.
        expected: String,
    },
    /// Reference to a name that is not defined.
    #[error("there is no {what} '{name}'")]
    NoSuchName {
        /// Kind of the named object, such as a material or a facet set.
        what: &'static str,
        /// The name.
        name: String,
        /// Defined names of this kind.
        available: Vec<String>,
    },
    /// Name that is defined twice for objects of one kind.
    #[error("the {what} '{name}' is defined twice")]
    Duplicate {
        /// Kind of the named object.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// Text that is repeated in a list.
    #[error("'{entry}' is repeated in the list '{list}'")]
    Repeated {
        /// The key of the list.
        list: String,
        /// Repeated text.
        entry: String,
    },
    /// Entry of a list that equals an earlier one.
    #[error("the entry repeats an earlier one of the list '{list}'")]
    SameEntry {
        /// The key of the list.
        list: String,
    },
    /// Quantity outside its usual range, in a scene that does not allow such quantities (`allow = ["magnitudes"]`).
    #[error(transparent)]
    Magnitude(Magnitude),
    /// Text that is not encoded in UTF-8.
    #[error("found {found}, expected text in UTF-8")]
    Encoding {
        /// Invalid bytes.
        found: String,
    },
    /// Group of keys of which exactly one must be given.
    #[error("exactly one of {} must be given, found {found}", keys.join(", "))]
    OneOf {
        /// The keys.
        keys: &'static [&'static str],
        /// Number of keys that are given.
        found: usize,
    },
    /// Solid element that belongs to no part, or element that belongs to several.
    #[error(
        "element {element} belongs to {count} parts, but must belong to exactly one; {}",
        owners(*count, sets)
    )]
    PartCount {
        /// Number of the first such element in the mesh file.
        element: u64,
        /// Number of parts to which it belongs: 0, or 2 for several.
        count: usize,
        /// Element sets of these parts; of an element without a part, all element sets that contain it.
        sets: Vec<String>,
    },
    /// Absorbing faces on several media; the free field needs one medium.
    #[error(
        "the elements along the absorbing faces have {count} different elastic media, but the free field needs exactly one: {media}"
    )]
    SeveralMedia {
        /// Number of media.
        count: usize,
        /// Parts of each medium, with their faces.
        media: String,
    },
    /// Value that another crate rejected; its error is the source.
    #[error("{0}")]
    Refused(Box<dyn std::error::Error + Send + Sync>),
}

/// Parts of an element that belongs to several, or the sets of one that belongs to none.
pub(crate) fn owners(count: usize, sets: &[String]) -> String {
    let quoted: Vec<String> = sets.iter().map(|set| format!("'{set}'")).collect();
    let quoted = quoted.join(", ");
    match (count, sets) {
        (0, []) => "no element set contains it".into(),
        (0, _) => format!("it is in {quoted}, of which the scene has no part"),
        _ => format!("it is in {quoted}"),
    }
}

/// Fault of a scene file: its type, byte range and an optional hint.
#[derive(Debug)]
pub struct Fault {
    span: Range<usize>,
    problem: Problem,
    help: Option<&'static str>,
}

impl Fault {
    /// Fault at a byte range.
    pub fn new(span: Range<usize>, problem: Problem) -> Self {
        Self {
            span,
            problem,
            help: None,
        }
    }
    /// Adds a hint on how to correct the fault.
    #[must_use]
    pub fn with_help(mut self, help: &'static str) -> Self {
        self.help = Some(help);
        self
    }
    /// Fault at a byte range from an error of another crate.
    pub fn refused(
        span: Range<usize>,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        Self::new(span, Problem::Refused(source.into()))
    }
    /// Fault of a quantity outside its usual range, with a hint on how to accept it.
    pub fn of_magnitude(span: Range<usize>, magnitude: Magnitude) -> Self {
        Self::new(span, Problem::Magnitude(magnitude)).with_help(ALLOW_MAGNITUDES)
    }
    /// Byte range of the fault.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }
    /// Type of the fault.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }
    /// Adds permitted keys to the fault of an unknown key.
    #[must_use]
    pub fn with_permitted(mut self, more: &[&str]) -> Self {
        if let Problem::UnknownKey { permitted, .. } = &mut self.problem {
            permitted.extend(more.iter().map(|&key| key.to_owned()));
        }
        self
    }
}
