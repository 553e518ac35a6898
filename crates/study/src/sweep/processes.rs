//! The folder of a sweep, which several processes may share.

use std::collections::hash_map::RandomState;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::BuildHasher as _;
use std::io::{ErrorKind, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use powerhouse::{Error, FolderError};

use crate::StudyError;

/// Name of the lock file of the folder, that of [`ResultFolder::lock`](powerhouse::ResultFolder::lock).
const LOCK: &str = ".powerhouse-lock";
/// Name of the folder of the locks that the processes of a sweep hold for some of their work.
const LOCKS: &str = ".powerhouse-locks";
/// Name of the lock of the files of all cases: table, list of cases.
const FILES: &str = "files";
/// First word in the lock file of a sweep.
const SWEEP: &str = "sweep";

/// Wall time between two looks at a lock that is held for a moment.
const MOMENT: Duration = Duration::from_millis(20);
/// Wall time after which a lock file without a sweep's name in it is that of another run.
const OF_RUN: Duration = Duration::from_secs(1);
/// Wall time for which another sweep may prepare the folder.
const OF_SWEEP: Duration = Duration::from_secs(60);

/// Presence of this process among those that share the folder of a sweep, until it is dropped.
///
/// # Why so
/// Every process holds the lock of the folder as a shared one, so that a single run, which needs it exclusively, is
/// refused. Cases are distributed by the locks of their own folders. All these locks are the operating system's, which
/// releases them however a process ends; the contents of the files are for people.
#[derive(Debug)]
pub(super) struct SharedFolder {
    folder: PathBuf,
    /// Lock file, locked as long as it is open; not locked where the file system has no locks.
    file: File,
    /// Content of the lock file, that of its first process.
    content: String,
    is_alone: bool,
}

/// Lock of some work of a sweep, released when dropped.
#[derive(Debug)]
pub(super) struct WorkLock {
    _file: File,
}

impl SharedFolder {
    /// Enters a folder, which is created if there is none. `prepare` is called if no other process is there, while none
    /// can enter.
    ///
    /// # Errors
    /// [`FolderError::Busy`] if a run that is no sweep writes into the folder, [`FolderError::Unwritable`]; an error of
    /// `prepare`.
    pub(super) fn enter(
        folder: &Path,
        prepare: impl Fn() -> Result<(), StudyError>,
    ) -> Result<Self, StudyError> {
        let fault = |source| unwritable(folder, source);
        let path = folder.join(LOCK);
        let begun = Instant::now();
        loop {
            let Some(mut file) = open(&path).map_err(fault)? else {
                continue;
            };
            let own = signature();
            let shared = |file, content, is_alone| Self {
                folder: folder.into(),
                file,
                content,
                is_alone,
            };
            let locked = file.try_lock();
            let is_alone = !matches!(locked, Err(TryLockError::WouldBlock));
            if is_alone {
                replace(&mut file, &own).map_err(fault)?;
                // The file may have been removed by its last owner meanwhile.
                if content(&path) != own {
                    continue;
                }
                if let Err(error) = prepare() {
                    let _ = fs::remove_file(&path);
                    return Err(error);
                }
            }
            if let Err(TryLockError::Error(_)) = locked {
                return Ok(shared(file, own, true));
            }
            if is_alone {
                file.unlock().map_err(fault)?;
            }
            let entered = file.try_lock_shared();
            file.rewind().map_err(fault)?;
            let mut found = String::new();
            let _ = file.read_to_string(&mut found);
            match entered {
                Ok(()) => {
                    // Between the two locks another process may have taken the place of the first.
                    let is_first = is_alone && found == own;
                    if (is_first || !is_alone) && !found.is_empty() && content(&path) == found {
                        return Ok(shared(file, found, is_first));
                    }
                }
                Err(TryLockError::Error(source)) => return Err(fault(source)),
                Err(TryLockError::WouldBlock) => {
                    let patience = if found.starts_with(SWEEP) {
                        OF_SWEEP
                    } else {
                        OF_RUN
                    };
                    if begun.elapsed() > patience {
                        let folder = folder.into();
                        let holder = match found.lines().next() {
                            None | Some("") => "another run".to_owned(),
                            Some(holder) => format!("another run ({holder})"),
                        };
                        return Err(Error::from(FolderError::Busy { folder, holder }).into());
                    }
                    std::thread::sleep(MOMENT);
                }
            }
        }
    }

    /// Whether no other process was in the folder when this one entered.
    pub(super) fn is_alone(&self) -> bool {
        self.is_alone
    }

    /// Waits for the lock of the files of all cases.
    ///
    /// # Errors
    /// A lock file that cannot be created.
    pub(super) fn files(&self) -> Result<WorkLock, StudyError> {
        self.work(FILES, || {
            std::thread::sleep(MOMENT);
            Ok(())
        })
    }

    /// Waits for the lock of some work; `waits` is called while another process holds it, and takes some time.
    ///
    /// # Errors
    /// A lock file that cannot be created; an error of `waits`.
    pub(super) fn work(
        &self,
        name: &str,
        mut waits: impl FnMut() -> Result<(), StudyError>,
    ) -> Result<WorkLock, StudyError> {
        let path = self.folder.join(LOCKS).join(name);
        let opened = || loop {
            if let Some(file) = open(&path)? {
                return Ok(file);
            }
        };
        let file = opened().map_err(|source| unwritable(&self.folder, source))?;
        // Where the file system has no locks, the lock of each case has a remark on that.
        while let Err(TryLockError::WouldBlock) = file.try_lock() {
            waits()?;
        }
        Ok(WorkLock { _file: file })
    }

    /// Leaves the folder at the end of a sweep.
    ///
    /// # Errors
    /// [`FolderError::Gone`] if the folder or its lock was removed during the sweep.
    pub(super) fn leave(self) -> Result<(), StudyError> {
        if self.is_there() {
            Ok(())
        } else {
            let folder = self.folder.clone();
            Err(Error::from(FolderError::Gone { folder }).into())
        }
    }

    /// Whether the folder still has the lock file of this sweep.
    pub(super) fn is_there(&self) -> bool {
        content(&self.folder.join(LOCK)) == self.content
    }
}

impl Drop for SharedFolder {
    fn drop(&mut self) {
        // The last process removes the lock files, while no other can enter. Remaining files are harmless.
        let _ = self.file.unlock();
        let is_last = !matches!(self.file.try_lock(), Err(TryLockError::WouldBlock));
        if is_last && self.is_there() {
            let _ = fs::remove_dir_all(self.folder.join(LOCKS));
            let _ = fs::remove_file(self.folder.join(LOCK));
        }
    }
}

/// Waits for a time.
///
/// # Errors
/// [`StudyError::Interrupted`] once the cancellation flag is set.
pub(super) fn pause(time: Duration, stop: Option<&Arc<AtomicBool>>) -> Result<(), StudyError> {
    let begun = Instant::now();
    loop {
        if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return Err(StudyError::Interrupted);
        }
        match time.checked_sub(begun.elapsed()) {
            None | Some(Duration::ZERO) => return Ok(()),
            Some(left) => std::thread::sleep(left.min(MOMENT)),
        }
    }
}

/// Opens a lock file, which is created with its folder if there is none; `None` if its last owner removed the folder
/// meanwhile.
fn open(path: &Path) -> std::io::Result<Option<File>> {
    fs::create_dir_all(path.parent().unwrap_or(Path::new("")))?;
    let opened = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path);
    match opened {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        opened => opened.map(Some),
    }
}

fn replace(file: &mut File, content: &str) -> std::io::Result<()> {
    file.rewind()?;
    file.set_len(0)?;
    file.write_all(content.as_bytes())?;
    file.sync_data()
}

/// The content of a lock file; empty if there is none.
fn content(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_default()
}

fn unwritable(folder: &Path, source: std::io::Error) -> StudyError {
    let folder = folder.to_path_buf();
    Error::from(FolderError::Unwritable { folder, source }).into()
}

/// Signature of a sweep: its first process and a number that no other has.
fn signature() -> String {
    // Processes of several machines may have the same number.
    let unique = RandomState::new().hash_one(std::process::id());
    format!(
        "{SWEEP} begun by process {}\n{unique:x}\n",
        std::process::id()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use powerhouse::ResultFolder;
    use powerhouse_test_support::TestFolder;

    fn enter(folder: &Path) -> Result<SharedFolder, StudyError> {
        SharedFolder::enter(folder, || Ok(()))
    }

    /// Several sweeps share a folder, which a run cannot lock then, and the last one leaves no file; a folder that a run has
    /// locked admits none.
    #[test]
    fn sweeps_share_a_folder_and_runs_do_not() {
        let folder = TestFolder::new("shared-folder");
        let out = folder.join("out");
        let run = ResultFolder::new(&out);
        let first = enter(&out).unwrap();
        let second = enter(&out).unwrap();
        assert!(first.is_alone() && !second.is_alone());
        let refused = run.lock().unwrap_err().to_string();
        assert!(
            refused.contains("another run (sweep begun by process"),
            "{refused}"
        );
        drop(first.files().unwrap());
        first.leave().unwrap();
        assert!(run.lock().is_err());
        second.leave().unwrap();
        assert_eq!(fs::read_dir(&out).unwrap().count(), 0);
        let lock = run.lock().unwrap();
        let refused = enter(&out).unwrap_err().to_string();
        assert!(refused.contains("another run (process"), "{refused}");
        drop(lock);
        enter(&out).unwrap().leave().unwrap();
    }

    /// Of many that enter and leave at once, each is alone or sees what the first one prepared, and work under a lock is
    /// done by one at a time.
    #[test]
    fn many_enter_and_leave_at_once() {
        let folder = TestFolder::new("shared-many");
        let out = folder.join("out");
        let (inside, prepared) = (AtomicBool::new(false), out.join("prepared"));
        let visit = || {
            for _ in 0..20 {
                let prepare = || {
                    fs::write(&prepared, "").unwrap();
                    Ok(())
                };
                let shared = SharedFolder::enter(&out, prepare).unwrap();
                assert!(prepared.exists());
                let lock = shared.files().unwrap();
                assert!(!inside.swap(true, Ordering::SeqCst));
                std::thread::yield_now();
                inside.store(false, Ordering::SeqCst);
                drop(lock);
                shared.leave().unwrap();
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(visit);
            }
        });
        fs::remove_file(&prepared).unwrap();
        assert_eq!(fs::read_dir(&out).unwrap().count(), 0);
    }
}
