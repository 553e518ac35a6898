//! Files of named sections, each with its length and checksum.
//!
//! A file begins with [`MAGIC`], its kind and the version of that kind's content; the sections follow, and a mark at the
//! end with their number. Numbers are written the lowest byte first. Whatever is cut off or changed is detected.

use std::path::Path;

use powerhouse_model::Checksum;
use thiserror::Error;

use crate::atomic::write_whole_by;
use crate::{IoError, read_whole};

/// First bytes of every file of sections.
const MAGIC: &[u8; 16] = b"powerhouse file\n";
/// Length of a name that marks the end.
const END: u16 = u16::MAX;
/// Largest file that is read (bytes).
const MOST: u64 = 1 << 40;

/// Named section of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileSection {
    /// Name of the section, up to 1000 bytes.
    pub name: String,
    /// Content of the section.
    pub bytes: Vec<u8>,
}

/// Content of a file that is not a whole file of sections of one kind and version.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SectionFault {
    /// A file of another program or form.
    #[error("is not a file of this program")]
    Foreign,
    /// A file of sections of another kind.
    #[error("is a file of the kind '{found}', not '{expected}'")]
    Kind {
        /// Kind of the file.
        found: String,
        /// Kind that was to be read.
        expected: String,
    },
    /// A file whose content has another version.
    #[error("has the format version {found}; this program reads version {expected}")]
    Version {
        /// Version of the file.
        found: u32,
        /// Version that is read.
        expected: u32,
    },
    /// A file that ends too early.
    #[error("is incomplete: it ends in {place}")]
    Truncated {
        /// Where it ends, such as a section.
        place: String,
    },
    /// A section with a wrong checksum.
    #[error("is damaged in {place}")]
    Damaged {
        /// Where it is damaged, such as a section.
        place: String,
    },
}

/// Error of reading a file of sections.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SectionFileError {
    /// The operating system returned an error.
    #[error("{}: {source}", file.display())]
    Read {
        /// Path of the file.
        file: std::path::PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The content of the file.
    #[error("{} {fault}", file.display())]
    Content {
        /// Path of the file.
        file: std::path::PathBuf,
        /// What is wrong with it.
        fault: SectionFault,
    },
}

/// Writes a file of sections of a kind and version, whole or not at all, and on the disk when the function returns.
///
/// # Errors
/// [`IoError::File`], with the path.
pub fn write_sections<'s>(
    file: &Path,
    (kind, version): (&str, u32),
    sections: impl IntoIterator<Item = (&'s str, &'s [u8])>,
) -> Result<(), IoError> {
    write_whole_by(file, |out| {
        let mut head = MAGIC.to_vec();
        put_name(&mut head, kind);
        head.extend(version.to_le_bytes());
        let sum = Checksum::of(&head);
        out.write_all(&head)?;
        out.write_all(&sum.value().to_le_bytes())?;
        let mut count = 0_u64;
        for (name, bytes) in sections {
            let mut head = Vec::new();
            put_name(&mut head, name);
            head.extend((bytes.len() as u64).to_le_bytes());
            let mut sum = Checksum::of(&head);
            sum.add_bytes(bytes);
            out.write_all(&head)?;
            out.write_all(&sum.value().to_le_bytes())?;
            out.write_all(bytes)?;
            count += 1;
        }
        let mut end = END.to_le_bytes().to_vec();
        end.extend(count.to_le_bytes());
        let sum = Checksum::of(&end);
        out.write_all(&end)?;
        out.write_all(&sum.value().to_le_bytes())
    })
}

/// Writes the length of a name and the name, cut at 1000 bytes.
fn put_name(out: &mut Vec<u8>, name: &str) {
    let bytes = &name.as_bytes()[..name.floor_char_boundary(1000)];
    out.extend((bytes.len() as u16).to_le_bytes());
    out.extend(bytes);
}

/// Reads all sections of a file of a kind and version.
///
/// # Errors
/// A file that cannot be read, and [`SectionFault`] with the section that is incomplete or damaged.
pub fn read_sections(
    file: &Path,
    (kind, version): (&str, u32),
) -> Result<Vec<FileSection>, SectionFileError> {
    let bytes = read_whole(file, MOST).map_err(|source| SectionFileError::Read {
        file: file.into(),
        source,
    })?;
    parse_sections(&bytes, (kind, version)).map_err(|fault| SectionFileError::Content {
        file: file.into(),
        fault,
    })
}

/// All sections among the bytes of a file of a kind and version.
///
/// # Errors
/// [`SectionFault`].
pub fn parse_sections(
    bytes: &[u8],
    (kind, version): (&str, u32),
) -> Result<Vec<FileSection>, SectionFault> {
    let mut rest = Rest {
        bytes,
        place: "its head".into(),
    };
    let start = bytes.len().min(MAGIC.len());
    if bytes[..start] != MAGIC[..start] || bytes.is_empty() {
        return Err(SectionFault::Foreign);
    }
    rest.take(MAGIC.len())?;
    let length = rest.number::<2>()? as u16;
    let found = rest.name(length)?;
    let of_file = rest.number::<4>()? as u32;
    rest.check(bytes)?;
    if found != kind {
        return Err(SectionFault::Kind {
            found,
            expected: kind.into(),
        });
    }
    if of_file != version {
        return Err(SectionFault::Version {
            found: of_file,
            expected: version,
        });
    }
    let mut sections: Vec<FileSection> = Vec::new();
    loop {
        rest.place = match sections.last() {
            Some(section) => format!("what follows the section '{}'", section.name),
            None => "what follows its head".into(),
        };
        let start = rest.bytes;
        let length = rest.number::<2>()? as u16;
        if length == END {
            let count = rest.number::<8>()?;
            rest.place = "its end".into();
            rest.check(start)?;
            let whole = rest.bytes.is_empty() && count == sections.len() as u64;
            return if whole {
                Ok(sections)
            } else {
                Err(rest.damaged())
            };
        }
        let name = rest.name(length)?;
        rest.place = format!("the section '{name}'");
        let size = rest.number::<8>()?;
        let head = &start[..start.len() - rest.bytes.len()];
        let sum = rest.number::<8>()?;
        // A length beyond the end takes no memory.
        let size = usize::try_from(size).unwrap_or(usize::MAX);
        let content = rest.take(size)?;
        let mut found = Checksum::of(head);
        found.add_bytes(content);
        if found.value() != sum {
            return Err(rest.damaged());
        }
        sections.push(FileSection {
            name,
            bytes: content.to_vec(),
        });
    }
}

/// Bytes that are still to be read, and what they belong to.
struct Rest<'a> {
    bytes: &'a [u8],
    place: String,
}

impl<'a> Rest<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], SectionFault> {
        let taken = self.bytes.split_at_checked(count);
        let (taken, rest) = taken.ok_or_else(|| SectionFault::Truncated {
            place: self.place.clone(),
        })?;
        self.bytes = rest;
        Ok(taken)
    }
    /// A number of some bytes.
    fn number<const N: usize>(&mut self) -> Result<u64, SectionFault> {
        let mut all = [0; 8];
        all[..N].copy_from_slice(self.take(N)?);
        Ok(u64::from_le_bytes(all))
    }
    fn name(&mut self, length: u16) -> Result<String, SectionFault> {
        let name = self.take(length.into())?.to_vec();
        String::from_utf8(name).map_err(|_| self.damaged())
    }
    /// Accepts the checksum of what was read since `start`.
    fn check(&mut self, start: &[u8]) -> Result<(), SectionFault> {
        let sum = Checksum::of(&start[..start.len() - self.bytes.len()]);
        if self.number::<8>()? == sum.value() {
            Ok(())
        } else {
            Err(self.damaged())
        }
    }
    fn damaged(&self) -> SectionFault {
        SectionFault::Damaged {
            place: self.place.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: (&str, u32) = ("test", 3);

    /// The bytes of a file with three sections, one of them empty.
    fn written() -> Vec<u8> {
        let folder =
            std::env::temp_dir().join(format!("powerhouse-sections-{}", std::process::id()));
        let name = format!("{:?}", std::thread::current().id());
        let file = folder.join(name);
        let sections: [(&str, &[u8]); 3] = [("one", b"first"), ("none", b""), ("last", &[7; 300])];
        write_sections(&file, KIND, sections).unwrap();
        assert_eq!(read_sections(&file, KIND).unwrap().len(), 3);
        let bytes = std::fs::read(&file).unwrap();
        std::fs::remove_file(file).unwrap();
        bytes
    }

    /// What was written is read, name by name.
    #[test]
    fn sections_are_read_as_written() {
        let sections = parse_sections(&written(), KIND).unwrap();
        let names: Vec<(&str, usize)> = (sections.iter())
            .map(|section| (section.name.as_str(), section.bytes.len()))
            .collect();
        assert_eq!(names, [("one", 5), ("none", 0), ("last", 300)]);
    }

    /// A file that is cut off anywhere, in which any one bit is flipped, or to which something is added, is refused; where
    /// it is a section's, by its name.
    #[test]
    fn any_damage_is_detected() {
        let whole = written();
        for length in 0..whole.len() {
            let refused = parse_sections(&whole[..length], KIND);
            assert!(refused.is_err(), "cut at {length}");
        }
        for bit in 0..8 * whole.len() {
            let mut damaged = whole.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let refused = parse_sections(&damaged, KIND);
            assert!(refused.is_err(), "bit {bit}");
        }
        let longer = [&whole[..], b"x"].concat();
        assert!(parse_sections(&longer, KIND).is_err());
        let last = whole.len() - 40;
        let cut = parse_sections(&whole[..last], KIND);
        let place = "the section 'last'".to_string();
        assert_eq!(
            cut,
            Err(SectionFault::Truncated {
                place: place.clone()
            })
        );
        let mut damaged = whole;
        damaged[last] ^= 1;
        assert_eq!(
            parse_sections(&damaged, KIND),
            Err(SectionFault::Damaged { place })
        );
    }

    /// Another kind, a newer version and another program's file are named as such.
    #[test]
    fn foreign_files_are_named() {
        let whole = written();
        let kind = parse_sections(&whole, ("other", 3))
            .unwrap_err()
            .to_string();
        assert!(kind.contains("'test', not 'other'"), "{kind}");
        let version = parse_sections(&whole, ("test", 2)).unwrap_err();
        assert_eq!(
            version,
            SectionFault::Version {
                found: 3,
                expected: 2
            }
        );
        assert_eq!(parse_sections(b"PK", KIND), Err(SectionFault::Foreign));
        assert_eq!(parse_sections(b"", KIND), Err(SectionFault::Foreign));
    }
}
