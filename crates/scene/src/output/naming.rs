//! Checks of result names and of the files named after them.

use std::collections::BTreeMap;

use thiserror::Error;

/// Largest length of a name in bytes: file systems permit 255, and names get prefixes and suffixes.
const LONGEST: usize = 200;

/// Error of a name in results: of a history, section, joint, zone, bolt group, stage or case. Found when a scene is read
/// or prepared, before any file is written.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum NameError {
    /// Empty name, or one of blanks.
    #[error("a {what} has an empty name")]
    Empty {
        /// Kind of the named object.
        what: &'static str,
    },
    /// Name with a control character, such as a line break or NUL.
    #[error("the name {name:?} contains a control character")]
    Control {
        /// Name.
        name: String,
    },
    /// Name that is too long for a file.
    #[error("the name '{}...' has {length} bytes, at most {LONGEST} are permitted", name.chars().take(20).collect::<String>())]
    Long {
        /// Name.
        name: String,
        /// Length in bytes.
        length: usize,
    },
    /// Name of a case that cannot be that of a folder: `.`, `..`, or with a slash or backslash.
    #[error("'{name}' cannot be the name of a folder")]
    Folder {
        /// Name.
        name: String,
    },
    /// Two results with the same name that would have the same file: of one kind, or a joint and a zone of one.
    #[error("two results have the name '{name}'")]
    Twice {
        /// Name.
        name: String,
    },
    /// Different names of two results, or of one and the energies, with the same file name, ignoring the case of letters.
    #[error("the names '{first}' and '{second}' would both have the file {file}")]
    Shared {
        /// First name.
        first: String,
        /// Second name.
        second: String,
        /// Common file.
        file: String,
    },
}

/// File name of a result name: every character that is not a letter, digit, `-` or `_` is replaced by `-`.
pub fn file_name(name: &str) -> String {
    let plain = |c: char| {
        if c.is_alphanumeric() || "-_".contains(c) {
            c
        } else {
            '-'
        }
    };
    name.chars().map(plain).collect()
}

/// Kind of a named object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedThing {
    /// History, relative displacement or section.
    Result,
    /// Joint.
    Joint,
    /// Zone of a joint.
    JointZone,
    /// Bolt group.
    Bolts,
    /// Construction stage.
    Stage,
    /// Case of a sweep, after which a folder is named.
    Case,
}

impl NamedThing {
    fn words(self) -> &'static str {
        match self {
            Self::Result => "result",
            Self::Joint => "joint",
            Self::JointZone => "zone of a joint",
            Self::Bolts => "bolt group",
            Self::Stage => "stage",
            Self::Case => "case",
        }
    }
    /// Files named after a name; those of stages begin with the number of the stage and are always distinct.
    fn files(self, name: &str) -> Vec<String> {
        let plain = file_name(name);
        match self {
            Self::Result => vec![format!("plots/{plain}.svg")],
            Self::JointZone => vec![format!("plots/joint-{plain}.svg")],
            Self::Joint => vec![
                format!("joints/{plain}.vtu"),
                format!("plots/joint-{plain}.svg"),
            ],
            Self::Bolts => vec![
                format!("bolts/{plain}.csv"),
                format!("plots/bolts-{plain}.svg"),
            ],
            Self::Stage => Vec::new(),
            Self::Case => vec![format!("{name}/")],
        }
    }
}

/// Checks that each name can be that of a file and that no two names have the same file.
///
/// # Errors
/// Index of the invalid name, with the error.
pub fn check_names<'n>(
    names: impl IntoIterator<Item = (NamedThing, &'n str)>,
) -> Result<(), (usize, NameError)> {
    let mut taken: BTreeMap<String, &str> = BTreeMap::new();
    taken.insert("plots/energies.svg".into(), "energies");
    for (index, (named, name)) in names.into_iter().enumerate() {
        check_name(named.words(), name).map_err(|error| (index, error))?;
        let is_path = name.contains(['/', '\\']) || [".", ".."].contains(&name);
        if named == NamedThing::Case && is_path {
            let name = name.into();
            return Err((index, NameError::Folder { name }));
        }
        for file in named.files(name) {
            let key = file.to_lowercase();
            match taken.get(&key) {
                Some(first) if *first == name => {
                    let name = name.into();
                    return Err((index, NameError::Twice { name }));
                }
                Some(first) => {
                    let error = NameError::Shared {
                        first: (*first).into(),
                        second: name.into(),
                        file,
                    };
                    return Err((index, error));
                }
                None => taken.insert(key, name),
            };
        }
    }
    Ok(())
}

fn check_name(what: &'static str, name: &str) -> Result<(), NameError> {
    if name.trim().is_empty() {
        return Err(NameError::Empty { what });
    }
    let (length, name) = (name.len(), name.to_owned());
    if name.chars().any(char::is_control) {
        return Err(NameError::Control { name });
    }
    if length > LONGEST {
        return Err(NameError::Long { name, length });
    }
    Ok(())
}
