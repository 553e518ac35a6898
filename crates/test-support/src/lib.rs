//! What tests of several crates share: temporary folders, a scene, strong motions.

mod motion;

use std::ffi::OsStr;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

pub use motion::{MOTION_STEP, motion_text, part_of_motion, synthetic_motion};

/// Scene (TOML) with everything that a run can have, with paths as from `data/scenes`.
pub const EVERYTHING: &str = include_str!("everything.toml");

/// Temporary folder of a test, removed with its files when it is dropped. It is used like its path.
#[derive(Debug)]
pub struct TestFolder(PathBuf);

impl TestFolder {
    /// Makes an empty folder, which no other test has: tests run in parallel, some under one name.
    ///
    /// # Panics
    /// If the folder cannot be made.
    pub fn new(name: &str) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("powerhouse-{name}-{}-{count}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).expect("a temporary folder can be made");
        Self(path)
    }
}

impl Deref for TestFolder {
    type Target = Path;
    fn deref(&self) -> &Path {
        &self.0
    }
}

impl AsRef<Path> for TestFolder {
    fn as_ref(&self) -> &Path {
        &self.0
    }
}

impl AsRef<OsStr> for TestFolder {
    fn as_ref(&self) -> &OsStr {
        self.0.as_os_str()
    }
}

impl Drop for TestFolder {
    fn drop(&mut self) {
        // A folder that a test has removed itself is no fault.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
