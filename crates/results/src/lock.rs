//! Lock of a results folder against concurrent runs.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use powerhouse_io::utc_date;
use powerhouse_scene::{Error, FolderError};

/// Name of the lock file in the results folder.
pub(crate) const LOCK: &str = ".powerhouse-lock";
/// Number of attempts at a file or folder that another run removes between two operations.
pub(crate) const TRIES: usize = 8;

/// Lock of a results folder by one run, released when dropped.
///
/// # Why so
/// The operating system holds the lock for the process and releases it however the process ends: a lock file that is
/// left after a killed run blocks no other run. The content of the file only identifies the run.
#[derive(Debug)]
pub struct FolderLock {
    folder: PathBuf,
    /// Lock file, locked as long as it is open; not locked where the file system has no locks.
    _file: Option<File>,
    /// Content of the lock file, unique to the run.
    content: String,
    remark: Option<String>,
}

impl FolderLock {
    /// Locks a folder, which is created if there is none.
    ///
    /// # Errors
    /// [`FolderError::Busy`] if another run holds the lock, [`FolderError::Unwritable`] if the file cannot be created.
    pub(crate) fn take(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(LOCK);
        let fault = |source| {
            let folder = folder.to_path_buf();
            FolderError::Unwritable { folder, source }
        };
        for _ in 0..TRIES {
            fs::create_dir_all(folder).map_err(fault)?;
            let opened = OpenOptions::new()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(&path);
            let mut file = match opened {
                // A run that just ended removed the lock file or the folder.
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
                opened => opened.map_err(fault)?,
            };
            let mut before = String::new();
            let mut remark = None;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => {
                    let _ = file.read_to_string(&mut before);
                    let holder = match before.trim() {
                        "" => "another run".to_owned(),
                        holder => format!("another run ({})", named(holder)),
                    };
                    let folder = folder.into();
                    return Err(FolderError::Busy { folder, holder }.into());
                }
                Err(TryLockError::Error(error)) => {
                    remark = Some(format!(
                        "the file system of {} has no locks ({error}): make sure that no other run writes there",
                        folder.display()
                    ));
                }
                Ok(()) => {
                    let _ = file.read_to_string(&mut before);
                    if !before.trim().is_empty() {
                        remark = Some(format!(
                            "{}: taken over from a run that ended without finishing ({})",
                            folder.display(),
                            named(before.trim())
                        ));
                    }
                }
            }
            let content = signature();
            let written = file
                .rewind()
                .and_then(|()| file.set_len(0))
                .and_then(|()| file.write_all(content.as_bytes()))
                .and_then(|()| file.sync_data());
            written.map_err(fault)?;
            let lock = Self {
                folder: folder.into(),
                _file: Some(file),
                content,
                remark,
            };
            // The file may have been removed by its last owner meanwhile.
            if lock.is_held() {
                return Ok(lock);
            }
        }
        let (folder, holder) = (folder.into(), "another run".into());
        Err(FolderError::Busy { folder, holder }.into())
    }

    /// Removes the lock file that a killed run has left in a folder, if there is one and no run holds it.
    pub fn remove_left(folder: &Path) {
        if folder.join(LOCK).exists() {
            // One that another run holds, or that cannot be removed, is harmless.
            drop(Self::take(folder));
        }
    }

    /// Remark for the user: the lock of a killed run was taken over, or the file system has no locks.
    pub fn remark(&self) -> Option<&str> {
        self.remark.as_deref()
    }

    /// Returns whether the folder still contains the lock file of this run.
    pub fn is_held(&self) -> bool {
        let found = fs::read_to_string(self.folder.join(LOCK));
        found.is_ok_and(|found| found == self.content)
    }

    /// Releases the lock at the end of a run.
    ///
    /// # Errors
    /// [`FolderError::Gone`] if the folder or its lock was removed during the run.
    pub fn release(self) -> Result<(), Error> {
        if self.is_held() {
            Ok(())
        } else {
            let folder = self.folder.clone();
            Err(FolderError::Gone { folder }.into())
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // Removed before the lock is released, so that it is not that of another run. A remaining file is harmless.
        if self.is_held() {
            let _ = fs::remove_file(self.folder.join(LOCK));
        }
    }
}

/// Signature of a run: process, start time and a unique number.
fn signature() -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let seconds = now.unwrap_or_default().as_secs();
    format!(
        "process {}, since {} UTC\n{}\n",
        std::process::id(),
        utc_date(seconds),
        unique()
    )
}

/// Text that no other call returns, in this process or another: process, time (ns) and number of calls.
pub(crate) fn unique() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let nanoseconds = now.unwrap_or_default().as_nanos();
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    format!("{}.{nanoseconds}.{count}", std::process::id())
}

/// Line of a signature that identifies the run.
fn named(content: &str) -> &str {
    content.lines().next().unwrap_or(content)
}
