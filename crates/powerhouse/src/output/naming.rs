//! Names of results, and the files that are named after them.

use std::collections::BTreeMap;

use thiserror::Error;

use super::drawing::file_name;

/// The longest name, in bytes, of which files can be named: file systems permit 255, and names get
/// beginnings and ends.
const LONGEST: usize = 200;

/// Why results cannot have a name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum NameError {
    /// A name without a letter that shows.
    #[error("a {what} has an empty name")]
    Empty {
        /// What is named.
        what: &'static str,
    },
    /// A name with a line break, a NUL or another control character.
    #[error("the name {name:?} has a control character")]
    Control {
        /// The name.
        name: String,
    },
    /// A name that is too long for a file.
    #[error("the name '{}...' has {length} bytes, files are named by at most {LONGEST}", name.chars().take(20).collect::<String>())]
    Long {
        /// The name.
        name: String,
        /// Its length in bytes.
        length: usize,
    },
    /// A case of which no folder can be named.
    #[error("no folder can have the name '{name}'")]
    Folder {
        /// The name.
        name: String,
    },
    /// Two results of one name.
    #[error("two results are called '{name}'")]
    Twice {
        /// The name.
        name: String,
    },
    /// Two names whose files would be one, where the case of letters does not count.
    #[error("the names '{first}' and '{second}' would share the file {file}")]
    Shared {
        /// The first name.
        first: String,
        /// The second one.
        second: String,
        /// The file.
        file: String,
    },
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NamedThing {
    /// A history, a relative displacement or a section.
    Result,
    /// A joint.
    Joint,
    /// Part of a joint.
    JointZone,
    /// Bolts.
    Bolts,
    /// A stage.
    Stage,
    /// A case of a sweep, of which a folder is named.
    Case,
}

impl NamedThing {
    fn words(self) -> &'static str {
        match self {
            Self::Result => "result",
            Self::Joint => "joint",
            Self::JointZone => "part of a joint",
            Self::Bolts => "make of bolts",
            Self::Stage => "stage",
            Self::Case => "case",
        }
    }
    /// The files of a name. Those of stages begin with the stage's number.
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

/// Sees that each name can be that of a file, and that no two share one; returns the place of the name at
/// fault with what is wrong.
pub(crate) fn check_names<'n>(
    names: impl IntoIterator<Item = (NamedThing, &'n str)>,
) -> Result<(), (usize, NameError)> {
    let mut taken: BTreeMap<String, &str> = BTreeMap::new();
    taken.insert("plots/energies.svg".into(), "energies");
    for (place, (named, name)) in names.into_iter().enumerate() {
        check_name(named.words(), name).map_err(|error| (place, error))?;
        let leaves = name.contains(['/', '\\']) || [".", ".."].contains(&name);
        if named == NamedThing::Case && leaves {
            let name = name.into();
            return Err((place, NameError::Folder { name }));
        }
        for file in named.files(name) {
            let key = file.to_lowercase();
            match taken.get(&key) {
                Some(first) if *first == name => {
                    let name = name.into();
                    return Err((place, NameError::Twice { name }));
                }
                Some(first) => {
                    let error = NameError::Shared {
                        first: (*first).into(),
                        second: name.into(),
                        file,
                    };
                    return Err((place, error));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two names never share a file, whatever they name and however they are written.
    #[test]
    fn two_names_never_share_a_file() {
        use NamedThing::{Bolts, Case, Joint, JointZone, Result as Results, Stage};
        for (first, second) in [
            ((Results, "a b"), (Results, "a-b")),
            ((Results, "Crown"), (Results, "crown")),
            ((Joint, "seam"), (Results, "joint-seam")),
            ((JointZone, "seam."), (Joint, "seam-")),
            ((Bolts, "roof"), (Results, "bolts roof")),
            ((Case, "SV"), (Case, "sv")),
        ] {
            let (place, error) = check_names([first, second]).unwrap_err();
            assert_eq!(place, 1);
            assert!(matches!(error, NameError::Shared { .. }), "{error}");
            let alone = [first, (second.0, "another")];
            assert_eq!(check_names(alone), Ok(()));
        }
        let twice = check_names([(Joint, "x"), (JointZone, "x")]).unwrap_err().1;
        assert!(matches!(twice, NameError::Twice { .. }), "{twice}");
        assert!(check_names([(Results, "Energies")]).is_err());
        assert_eq!(check_names([(Stage, "a b"), (Stage, "a-b")]), Ok(()));
        assert_eq!(check_names([(Results, "crown, left \"x\"")]), Ok(()));
    }

    /// A name of which no file can be named is refused.
    #[test]
    fn a_name_is_one_line_that_shows() {
        for name in ["", "  ", "a\nb", "a\0b", &"x".repeat(300)] {
            assert!(
                check_names([(NamedThing::Result, name)]).is_err(),
                "{name:?}"
            );
        }
        for name in ["..", "../up", "a\\b"] {
            assert!(check_names([(NamedThing::Case, name)]).is_err(), "{name:?}");
            assert!(
                check_names([(NamedThing::Result, name)]).is_ok(),
                "{name:?}"
            );
        }
    }
}
