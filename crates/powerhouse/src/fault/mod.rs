//! What is wrong with a scene file, and where.

mod message;
mod text;

use core::ops::Range;

use thiserror::Error;

use crate::magnitude::Magnitude;

pub use text::{SceneFault, SceneText};

/// What lets a scene with unusual magnitudes pass.
const ALLOW_MAGNITUDES: &str =
    "where it is meant, `allow = [\"magnitudes\"]` at the top of the scene makes it a warning";

/// What is wrong at one place of a scene file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Problem {
    /// The text is not TOML.
    #[error("{message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// A key that the format does not know.
    #[error("unknown key '{key}'")]
    UnknownKey {
        /// The key.
        key: String,
        /// Keys that may stand here.
        permitted: Vec<String>,
    },
    /// A key that must be given.
    #[error("the key '{key}' is missing")]
    MissingKey {
        /// The key.
        key: String,
    },
    /// A word that is none of the permitted ones.
    #[error("'{found}' is not permitted here")]
    UnknownChoice {
        /// The word.
        found: String,
        /// Permitted words.
        permitted: Vec<String>,
    },
    /// A value of a wrong type, or outside its range.
    #[error("found {found}, expected {expected}")]
    Value {
        /// What stands in the file.
        found: String,
        /// What may stand there.
        expected: String,
    },
    /// A name that refers to nothing.
    #[error("there is no {what} '{name}'")]
    NoSuchName {
        /// What the name should be: a material, a facet set.
        what: &'static str,
        /// The name.
        name: String,
        /// Names that exist.
        available: Vec<String>,
    },
    /// A name that stands twice.
    #[error("the {what} '{name}' is defined twice")]
    Duplicate {
        /// What it names.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A text that stands twice in a list.
    #[error("'{entry}' stands twice in the list '{list}'")]
    Repeated {
        /// The key of the list.
        list: String,
        /// The text.
        entry: String,
    },
    /// An entry of a list that is the same as an earlier one.
    #[error("an earlier entry of the list '{list}' is the same")]
    SameEntry {
        /// The key of the list.
        list: String,
    },
    /// A quantity beyond what is usual.
    #[error(transparent)]
    Magnitude(Magnitude),
    /// A text that is not in UTF-8.
    #[error("found {found}, expected text in UTF-8")]
    Encoding {
        /// What stands there.
        found: String,
    },
    /// Keys that do not go together, or one of which is needed.
    #[error("exactly one of {} must be given, found {found}", keys.join(", "))]
    OneOf {
        /// The keys.
        keys: &'static [&'static str],
        /// How many are given.
        found: usize,
    },
    /// Elements without a part, or with several.
    #[error("element {element} belongs to {count} parts, it must belong to one")]
    PartCount {
        /// The user's number of the first such element.
        element: u64,
        /// Parts that it belongs to.
        count: usize,
    },
    /// Absorbing faces in front of several media, where the free field needs one.
    #[error(
        "the absorbing faces stand before {count} different media; the free field needs one: {media}"
    )]
    SeveralMedia {
        /// How many.
        count: usize,
        /// The parts of each medium, with the faces before them.
        media: String,
    },
    /// Another crate refused what stands here; its error is the source.
    #[error("{0}")]
    Refused(Box<dyn std::error::Error + Send + Sync>),
}

/// A problem and the bytes of the scene file that it concerns.
#[derive(Debug)]
pub struct Fault {
    span: Range<usize>,
    problem: Problem,
    help: Option<&'static str>,
}

impl Fault {
    /// A problem at a range of bytes.
    pub fn new(span: Range<usize>, problem: Problem) -> Self {
        Self {
            span,
            problem,
            help: None,
        }
    }
    /// The same with a hint at what would put it right.
    #[must_use]
    pub fn with_help(mut self, help: &'static str) -> Self {
        self.help = Some(help);
        self
    }
    /// What another crate refused at a range of bytes.
    pub fn refused(
        span: Range<usize>,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        Self::new(span, Problem::Refused(source.into()))
    }
    /// A quantity beyond what is usual, with the way to let it pass.
    pub(crate) fn of_magnitude(span: Range<usize>, magnitude: Magnitude) -> Self {
        Self::new(span, Problem::Magnitude(magnitude)).with_help(ALLOW_MAGNITUDES)
    }
    /// What is wrong.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }
    pub(crate) fn from_toml(error: toml::de::Error) -> Self {
        Self::new(
            error.span().unwrap_or(0..0),
            Problem::from_serde(error.message()),
        )
    }
    /// Adds keys that may also stand where an unknown key was found.
    pub(crate) fn with_permitted(mut self, more: &[&str]) -> Self {
        if let Problem::UnknownKey { permitted, .. } = &mut self.problem {
            permitted.extend(more.iter().map(|&key| key.to_owned()));
        }
        self
    }
}
