//! Sweeps that share a folder.

use std::sync::Mutex;
use std::sync::atomic::Ordering;

use super::*;
use powerhouse::FolderLock;

/// Two sweeps that run simultaneously compute each case and each body once, and return the outcomes of all.
#[test]
fn sweeps_share_a_folder() {
    let folder = Folder::new("shared-folder");
    let sweep = || {
        let mut count = Count::default();
        let found = folder.sweep().run(None, &mut count).unwrap();
        (found, count)
    };
    let [(first, one), (second, other)] = std::thread::scope(|scope| {
        let both = [scope.spawn(sweep), scope.spawn(sweep)];
        both.map(|sweep| sweep.join().unwrap())
    });
    assert_eq!(first, second);
    let all = |of: [Vec<String>; 2]| {
        let mut all = of.concat();
        all.sort();
        all
    };
    assert_eq!(
        all([one.ended, other.ended]),
        ["continuous", "slanted", "steep"]
    );
    assert_eq!(all([one.at_rest, other.at_rest]).len(), 2);
    assert_eq!(one.kept.len() + other.kept.len(), 3);
    assert_eq!(report_gaps(folder.0.join("out")).unwrap(), [""; 0]);
    let left = std::fs::read_dir(folder.0.join("out")).unwrap();
    let mut names = left.map(|entry| entry.unwrap().file_name());
    assert!(names.all(|name| !name.to_string_lossy().starts_with('.')));
}

/// Holds the lock of a case until the sweep waits for it.
struct Holder(Option<FolderLock>, Vec<String>);

impl SweepWatch for Holder {
    fn begins(&mut self, case: &str, _number: usize, _of: usize) {
        self.1.push(case.into());
    }
    fn waits(&mut self, cases: &[&str]) {
        assert_eq!(cases, ["steep"]);
        self.0 = None;
    }
}

/// A case that a run computes in its folder is passed over, and is computed when the run has left it; a sweep that waits
/// for it can be cancelled.
#[test]
fn a_case_that_is_held_comes_last() {
    let folder = Folder::new("held");
    let hold = || {
        ResultFolder::new(folder.0.join("out/steep"))
            .lock()
            .unwrap()
    };
    let short = || folder.sweep().with_duration(0.01).unwrap();
    let mut holder = Holder(Some(hold()), Vec::new());
    let found = short().run(None, &mut holder).unwrap();
    assert_eq!(holder.1, ["slanted", "continuous", "steep"]);
    let names: Vec<&str> = found.iter().map(|case| &*case.name).collect();
    assert_eq!(names, ["steep", "slanted", "continuous"]);

    /// Cancels the sweep that waits.
    struct Cancel(Arc<AtomicBool>);
    impl SweepWatch for Cancel {
        fn waits(&mut self, _cases: &[&str]) {
            self.0.store(true, Ordering::Relaxed);
        }
    }
    std::fs::remove_file(folder.0.join("out/steep/finished.json")).unwrap();
    let _lock = hold();
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = short().run(Some(&stop), &mut Cancel(stop.clone()));
    assert!(matches!(stopped, Err(StudyError::Interrupted)));
}

/// A lock file that a killed process has left in the folder of a finished case is removed by the next sweep, and one that a run holds
/// is not.
#[test]
fn left_locks_are_removed() {
    let folder = Folder::new("left-lock");
    let run = || {
        let sweep = folder.sweep().only(&["steep".into()]).unwrap();
        let sweep = sweep.with_duration(0.01).unwrap();
        sweep.run(None, &mut NoProgress).unwrap()
    };
    let first = run();
    let case = folder.0.join("out/steep");
    let lock = case.join(".powerhouse-lock");
    assert!(!lock.exists());
    std::fs::write(&lock, "sweep begun by process 1").unwrap();
    assert_eq!(run(), first);
    assert!(!lock.exists());
    let held = ResultFolder::new(&case).lock().unwrap();
    assert_eq!(run(), first);
    assert!(held.is_held());
}

/// A sweep with other inputs is refused while one runs in the folder.
#[test]
fn another_sweep_is_refused() {
    let folder = Folder::new("other-sweep");
    /// Starts the other sweep when a case has ended.
    struct Other<'f>(&'f Folder, Mutex<Vec<StudyError>>);
    impl SweepWatch for Other<'_> {
        fn ends(&mut self, _outcome: &CaseOutcome) {
            let other = self.0.sweep().with_duration(0.02).unwrap();
            let refused = other.run(None, &mut NoProgress).unwrap_err();
            self.1.lock().unwrap().push(refused);
        }
    }
    let mut other = Other(&folder, Mutex::default());
    let sweep = folder.sweep().only(&["steep".into()]).unwrap();
    let sweep = sweep.with_duration(0.01).unwrap();
    assert_eq!(sweep.run(None, &mut other).unwrap().len(), 1);
    let refused = other.1.into_inner().unwrap();
    assert!(matches!(&refused[..], [StudyError::OtherSweep { .. }]));
}
