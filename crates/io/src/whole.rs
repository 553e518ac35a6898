//! Files read whole, up to a size.

use std::fs::File;
use std::io::{Error, Read};
use std::path::Path;

use thiserror::Error as ThisError;

/// A file that is not read.
#[derive(Clone, Debug, PartialEq, Eq, ThisError)]
#[non_exhaustive]
pub enum Unread {
    /// A folder, a device, a pipe: what has no end that is known beforehand.
    #[error("is no regular file")]
    NotRegular,
    /// A file that is larger than what it should be can be.
    #[error("has {size} bytes, more than the {most} that such a file may have")]
    TooLarge {
        /// Its size (bytes).
        size: u64,
        /// The largest permitted size (bytes).
        most: u64,
    },
}

/// Reads a regular file whole.
///
/// # Errors
/// What the operating system refuses; [`Unread`], as the inner error, for what is no regular file, or is
/// larger than `most` bytes, before anything is read of it.
pub fn read_whole(file: &Path, most: u64) -> Result<Vec<u8>, Error> {
    // A pipe would keep whoever opens it waiting.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A file above the permitted size is refused by its size, without being read.
    #[test]
    fn a_file_has_a_largest_size() {
        let name = format!("powerhouse-whole-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let file = File::create(&path).unwrap();
        file.set_len(1 << 40).unwrap();
        let told = read_whole(&path, 1 << 20).unwrap_err().to_string();
        assert!(told.contains("1099511627776 bytes"), "{told}");
        file.set_len(1 << 10).unwrap();
        assert_eq!(read_whole(&path, 1 << 10).unwrap().len(), 1 << 10);
        std::fs::remove_file(path).unwrap();
    }

    /// What is no regular file is refused, a folder and a device without an end.
    #[test]
    fn only_regular_files_are_read() {
        let mut refused = vec![std::env::temp_dir()];
        if cfg!(unix) {
            refused.push("/dev/zero".into());
        }
        for path in refused {
            let told = read_whole(&path, 1 << 20).unwrap_err().to_string();
            assert_eq!(told, "is no regular file");
        }
    }
}
