//! File of a body in static equilibrium, to the last bit.

use std::path::Path;

use powerhouse_io::{FileSection, SectionFileError, read_sections, write_sections};
use powerhouse_model::{StateError, decode, encode};

use super::EquilibratedBody;
use crate::Error;

/// Kind and version of the file; the version changes with the fields.
const KIND: (&str, u32) = ("equilibrated body", 3);
const STATE: &str = "state";
const STAGES: &str = "stages";

impl EquilibratedBody {
    /// Writes the body as a file, whole or not at all.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), Error> {
        let [state, stages] = self.sections().map_err(|source| Error::SavedState {
            path: file.into(),
            part: "body".into(),
            source,
        })?;
        let sections = [(STATE, state.as_slice()), (STAGES, stages.as_slice())];
        Ok(write_sections(file, KIND, sections)?)
    }

    /// Reads a body that was [written](Self::write): the same to the last bit.
    ///
    /// # Errors
    /// A file that cannot be read, [`Error::UnreadableBody`] for one that holds no whole body.
    pub fn read(file: &Path) -> Result<Self, Error> {
        let sections = read_sections(file, KIND).map_err(|error| match error {
            SectionFileError::Read { file, source } => Error::Read { path: file, source },
            _ => Error::UnreadableBody { path: file.into() },
        })?;
        let body = Self::of_sections(&sections);
        body.map_err(|_| Error::UnreadableBody { path: file.into() })
    }

    /// State and reports of the stages as bytes.
    pub fn sections(&self) -> Result<[Vec<u8>; 2], StateError> {
        Ok([encode(&self.state)?, encode(&self.stages)?])
    }

    /// The body of the sections of a file.
    pub fn of_sections(sections: &[FileSection]) -> Result<Self, StateError> {
        let of = |name: &str| {
            let section = sections.iter().find(|section| section.name == name);
            section
                .map(|section| &section.bytes[..])
                .ok_or(StateError::Missing)
        };
        Ok(Self {
            state: decode(of(STATE)?)?,
            stages: decode(of(STAGES)?)?,
        })
    }

    /// Names of the sections of a body.
    pub const SECTIONS: [&str; 2] = [STATE, STAGES];
}
