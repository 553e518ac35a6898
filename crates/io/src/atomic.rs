//! Atomic writing of files.

use std::fs::{self, File};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;

use crate::IoError;

/// Writes a file atomically: under a temporary name beside it, which is then renamed, so that an
/// interrupted run leaves no incomplete file. It is on the disk before it is renamed, so that a power failure leaves
/// either the old or the new file. Creates the folder if it does not exist.
///
/// # Errors
/// [`IoError::File`], with the path.
pub fn write_whole(file: &Path, content: &[u8]) -> Result<(), IoError> {
    write_whole_by(file, |out| out.write_all(content))
}

/// Writes a file as [`write_whole`], with a content that `write` writes piece by piece.
pub(crate) fn write_whole_by(
    file: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), IoError> {
    if let Some(folder) = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        fs::create_dir_all(folder).map_err(IoError::file(folder))?;
    }
    let mut name = file.file_name().unwrap_or_default().to_os_string();
    name.push(format!(".{}.part", std::process::id()));
    let part = file.with_file_name(name);
    let to_disk = || {
        let mut out = BufWriter::new(File::create(&part)?);
        write(&mut out)?;
        synced(&out.into_inner().map_err(|error| error.into_error())?)?;
        fs::rename(&part, file)?;
        sync_folder(file);
        Ok(())
    };
    let written = to_disk();
    if written.is_err() {
        // The first error is returned; the temporary file is removed if possible.
        let _ = fs::remove_file(&part);
    }
    written.map_err(IoError::file(file))
}

/// Waits until a file is on the disk, where its file system can say so.
fn synced(file: &File) -> std::io::Result<()> {
    match file.sync_all() {
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::Unsupported | ErrorKind::InvalidInput
            ) =>
        {
            Ok(())
        }
        synced => synced,
    }
}

/// Waits until the name of a file is on the disk: the file is whole in any case, under its old or its new name.
#[cfg(unix)]
fn sync_folder(file: &Path) {
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    if let Ok(folder) = File::open(folder.unwrap_or(Path::new("."))) {
        let _ = folder.sync_all();
    }
}

#[cfg(not(unix))]
fn sync_folder(_file: &Path) {}

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
