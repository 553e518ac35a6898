//! One run at a time in a folder.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use powerhouse_io::IoError;
use thiserror::Error;

use crate::Error;

/// The file that a run holds locked in its folder.
pub(super) const LOCK: &str = ".powerhouse-lock";
/// How often a lock is tried anew that somebody removed between two operations.
const TRIES: usize = 8;

/// Why a folder does not take the files of a run, or lost them.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FolderError {
    /// Another run writes there.
    #[error(
        "{}: {holder} writes into this folder; wait for its end or give another one (--out)",
        folder.display()
    )]
    Busy {
        /// The folder.
        folder: PathBuf,
        /// The run that does: its process and when it started.
        holder: String,
    },
    /// The folder was removed, or another one put in its place, while the run wrote there.
    #[error(
        "{}: this folder, or its lock, was removed while the run went on; what the run still held was written there anew, what it had written before (snapshots, stages) may be missing",
        folder.display()
    )]
    Gone {
        /// The folder.
        folder: PathBuf,
    },
    /// The files of the run do not fit on the disk.
    #[error(
        "{}: the run may write up to {:.3} GB, {:.3} GB are free; ask for fewer snapshots or give another folder (--out)",
        folder.display(), *needed as f64 / 1e9, *free as f64 / 1e9
    )]
    NoRoom {
        /// The folder.
        folder: PathBuf,
        /// Predicted size of the files, at most (bytes).
        needed: u64,
        /// Free on the disk (bytes).
        free: u64,
    },
    /// A folder stands where a file of results is to go.
    #[error("{}: a folder stands where the run writes this file", file.display())]
    InTheWay {
        /// The file.
        file: PathBuf,
    },
}

/// A folder that one run holds until this is dropped.
///
/// # Why so
/// The operating system holds the lock for the process, and lets it go when the process ends however it ends: a
/// lock file that is left behind after a kill hinders nobody. What stands in the file only names the run.
#[derive(Debug)]
pub struct FolderLock {
    folder: PathBuf,
    /// Locked as long as it is open; none where the file system has no locks.
    _file: Option<File>,
    /// What stands in the file, unlike that of any other run.
    content: String,
    remark: Option<String>,
}

impl FolderLock {
    /// Takes a folder, which is made if there is none.
    ///
    /// # Errors
    /// [`FolderError::Busy`] if another run holds it, [`Error::Write`] if the file cannot be made.
    pub(super) fn take(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(LOCK);
        let fault = |source| {
            let file = path.clone();
            Error::Write(IoError::File { file, source })
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
                // Another run that ended removed the folder's lock, or the folder.
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
                        "the file system of {} has no locks ({error}): take care that no other run writes there",
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
            // The file may be one that its last owner has just removed.
            if lock.is_held() {
                return Ok(lock);
            }
        }
        let (folder, holder) = (folder.into(), "another run".into());
        Err(FolderError::Busy { folder, holder }.into())
    }

    /// What a user should know of how the lock was taken: that of a run that was killed was taken over, or
    /// the file system has no locks.
    pub fn remark(&self) -> Option<&str> {
        self.remark.as_deref()
    }

    /// Whether the folder and the lock in it are still those that were taken.
    pub fn is_held(&self) -> bool {
        let found = fs::read_to_string(self.folder.join(LOCK));
        found.is_ok_and(|found| found == self.content)
    }

    /// Lets the folder go at the end of a run.
    ///
    /// # Errors
    /// [`FolderError::Gone`] if it vanished meanwhile.
    pub fn release(self) -> Result<(), Error> {
        match self.is_held() {
            true => Ok(()),
            false => {
                let folder = self.folder.clone();
                Err(FolderError::Gone { folder }.into())
            }
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // Before the lock is let go, so that it is nobody else's. Nothing is lost if the file stays.
        if self.is_held() {
            let _ = fs::remove_file(self.folder.join(LOCK));
        }
    }
}

/// Process, start and a number of its own.
fn signature() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now = now.unwrap_or_default();
    format!(
        "process {}, since {} UTC\n{}.{}\n",
        std::process::id(),
        date(now.as_secs()),
        now.as_nanos(),
        COUNT.fetch_add(1, Ordering::Relaxed)
    )
}

/// The line of a signature that names a run.
fn named(content: &str) -> &str {
    content.lines().next().unwrap_or(content)
}

/// Seconds since 1970 as date and time, by the calendar of Howard Hinnant's `civil_from_days`.
fn date(seconds: u64) -> String {
    let (days, rest) = (seconds / 86400 + 719_468, seconds % 86400);
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year + 400 * era + u64::from(month <= 2);
    let [hour, minute, second] = [rest / 3600, rest / 60 % 60, rest % 60];
    format!("{year}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("powerhouse-lock-{name}-{}", std::process::id()))
    }

    /// A folder has one run at a time, which is named to the second; after it the next may come, and nothing is
    /// left of the lock.
    #[test]
    fn a_folder_has_one_run_at_a_time() {
        let folder = folder("one");
        let first = FolderLock::take(&folder).unwrap();
        let refused = FolderLock::take(&folder).unwrap_err().to_string();
        let own = format!("another run (process {}, since 20", std::process::id());
        assert!(refused.contains(&own), "{refused}");
        first.release().unwrap();
        let second = FolderLock::take(&folder).unwrap();
        assert_eq!(second.remark(), None);
        drop(second);
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        fs::remove_dir_all(folder).unwrap();
    }

    /// The lock of a run that was killed is taken over, and its run is named.
    #[test]
    fn the_lock_of_a_dead_run_is_taken_over() {
        let folder = folder("dead");
        fs::create_dir_all(&folder).unwrap();
        fs::write(
            folder.join(LOCK),
            "process 1234, since 2001-02-03 04:05:06 UTC\n1.0\n",
        )
        .unwrap();
        let lock = FolderLock::take(&folder).unwrap();
        let remark = lock.remark().unwrap();
        assert!(
            remark.ends_with("(process 1234, since 2001-02-03 04:05:06 UTC)"),
            "{remark}"
        );
        drop(lock);
        fs::remove_dir_all(folder).unwrap();
    }

    /// A folder that vanishes, or is replaced by that of another run, is noticed.
    #[test]
    fn a_folder_that_vanishes_is_noticed() {
        let folder = folder("gone");
        let lock = FolderLock::take(&folder).unwrap();
        fs::remove_dir_all(&folder).unwrap();
        assert!(!lock.is_held());
        let other = FolderLock::take(&folder).unwrap();
        let refused = lock.release().unwrap_err();
        assert!(matches!(refused, Error::Folder(FolderError::Gone { .. })));
        // What the first one left to do did not touch the lock of the other.
        assert!(other.is_held());
        drop(other);
        fs::remove_dir_all(folder).unwrap();
    }

    /// Dates are those of the calendar.
    #[test]
    fn dates_are_those_of_the_calendar() {
        for (seconds, wanted) in [
            (0, "1970-01-01 00:00:00"),
            (951_782_399, "2000-02-28 23:59:59"),
            (951_782_400, "2000-02-29 00:00:00"),
            (1_735_689_599, "2024-12-31 23:59:59"),
            (4_107_542_400, "2100-03-01 00:00:00"),
        ] {
            assert_eq!(date(seconds), wanted);
        }
    }
}
