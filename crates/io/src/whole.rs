//! Reading of complete files up to a size.

use std::fs::File;
use std::io::{BufRead, BufReader, Error, Read};
use std::path::Path;

use powerhouse_model::Checksum;
use thiserror::Error as ThisError;

/// Reason for which a file is not read.
#[derive(Clone, Debug, PartialEq, Eq, ThisError)]
#[non_exhaustive]
pub enum Unread {
    /// The file is not a regular file but a folder, a device or a pipe, without a known end.
    #[error("is not a regular file")]
    NotRegular,
    /// The file is larger than permitted.
    #[error("has {size} bytes, more than the permitted {most}")]
    TooLarge {
        /// Size of the file (bytes).
        size: u64,
        /// Greatest permitted size (bytes).
        most: u64,
    },
}

/// Reads a regular file completely.
///
/// # Errors
/// The operating system's error, or [`Unread`] as the inner error if the file is not regular or is
/// larger than `most` bytes, before any of it is read.
pub fn read_whole(file: &Path, most: u64) -> Result<Vec<u8>, Error> {
    // Opening a pipe would block.
    if !std::fs::metadata(file)?.is_file() {
        return Err(Error::other(Unread::NotRegular));
    }
    let opened = File::open(file)?;
    let size = opened.metadata()?.len();
    if size > most {
        return Err(Error::other(Unread::TooLarge { size, most }));
    }
    let mut bytes = Vec::with_capacity(size as usize);
    // A file may grow while it is read.
    opened.take(most + 1).read_to_end(&mut bytes)?;
    match bytes.len() as u64 {
        size if size > most => Err(Error::other(Unread::TooLarge { size, most })),
        _ => Ok(bytes),
    }
}

/// Checksum of a file, of which a small part at a time is in memory.
///
/// # Errors
/// The operating system's error.
pub fn file_checksum(file: &Path) -> Result<Checksum, Error> {
    let mut reader = BufReader::with_capacity(1 << 16, File::open(file)?);
    let mut sum = Checksum::default();
    loop {
        let bytes = reader.fill_buf()?;
        if bytes.is_empty() {
            return Ok(sum);
        }
        sum.add_bytes(bytes);
        let length = bytes.len();
        reader.consume(length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file above the permitted size is an error with its size, without being read.
    #[test]
    fn a_file_has_a_largest_size() {
        let name = format!("powerhouse-whole-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let file = File::create(&path).unwrap();
        file.set_len(1 << 40).unwrap();
        let message = read_whole(&path, 1 << 20).unwrap_err().to_string();
        assert!(message.contains("1099511627776 bytes"), "{message}");
        file.set_len(1 << 10).unwrap();
        assert_eq!(read_whole(&path, 1 << 10).unwrap().len(), 1 << 10);
        std::fs::remove_file(path).unwrap();
    }

    /// What is not a regular file is an error: a folder, and a device without an end.
    #[test]
    fn only_regular_files_are_read() {
        let mut refused = vec![std::env::temp_dir()];
        if cfg!(unix) {
            refused.push("/dev/zero".into());
        }
        for path in refused {
            let message = read_whole(&path, 1 << 20).unwrap_err().to_string();
            assert_eq!(message, "is not a regular file");
        }
    }
}
