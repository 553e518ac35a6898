//! Atomic writing of files.

use std::fs;
use std::path::Path;

use crate::IoError;

/// Writes a file atomically: under a temporary name beside it, which is then renamed, so that an
/// interrupted run leaves no incomplete file. Creates the folder if it does not exist.
///
/// # Errors
/// [`IoError::File`], with the path.
pub fn write_whole(file: &Path, content: &[u8]) -> Result<(), IoError> {
    if let Some(folder) = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        fs::create_dir_all(folder).map_err(IoError::file(folder))?;
    }
    let mut name = file.file_name().unwrap_or_default().to_os_string();
    name.push(format!(".{}.part", std::process::id()));
    let part = file.with_file_name(name);
    let written = fs::write(&part, content).and_then(|()| fs::rename(&part, file));
    if written.is_err() {
        // The first error is returned; the temporary file is removed if possible.
        let _ = fs::remove_file(&part);
    }
    written.map_err(IoError::file(file))
}

/// Free space for files in an existing folder (bytes); `None` if the system does not report it.
#[cfg(all(unix, feature = "free-space"))]
pub fn free_space(folder: &Path) -> Option<u64> {
    let found = nix::sys::statvfs::statvfs(folder).ok()?;
    // The types of both differ between systems.
    #[allow(clippy::unnecessary_cast)]
    let [blocks, size] = [
        found.blocks_available() as u64,
        found.fragment_size() as u64,
    ];
    Some(blocks.saturating_mul(size))
}

/// Free space for files in an existing folder (bytes); `None` if the system does not report it.
#[cfg(all(not(unix), feature = "free-space"))]
pub fn free_space(_folder: &Path) -> Option<u64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder that does not exist is created; only the file is left in it.
    #[test]
    fn a_file_is_written_whole() {
        let folder = std::env::temp_dir().join(format!("powerhouse-atomic-{}", std::process::id()));
        let file = folder.join("deep/er/file.txt");
        write_whole(&file, b"one").unwrap();
        write_whole(&file, b"two").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"two");
        assert_eq!(fs::read_dir(file.parent().unwrap()).unwrap().count(), 1);
        fs::remove_dir_all(folder).unwrap();
    }

    /// An error names the file that could not be written.
    #[test]
    fn an_error_names_the_file() {
        let folder =
            std::env::temp_dir().join(format!("powerhouse-atomic-e-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let error = write_whole(&folder, b"a folder has this name").unwrap_err();
        assert!(
            error.to_string().contains("powerhouse-atomic-e-"),
            "{error}"
        );
        fs::remove_dir_all(folder).unwrap();
    }
}
