//! Checkpoints of cases whose states do not fit the body.

use std::sync::atomic::Ordering;

use powerhouse::ProgressHook;
use powerhouse::io::{read_sections, write_sections};
use powerhouse_study::CheckpointEvent;

use super::*;

/// Cancels the sweep after some steps of a case, if at all, and collects what is reported of checkpoints.
#[derive(Default)]
struct Cancelling {
    stop: Arc<AtomicBool>,
    after: Option<u64>,
    events: Vec<String>,
}

impl SweepWatch for Cancelling {
    fn checkpoint(&mut self, _case: &str, event: CheckpointEvent) {
        self.events.push(event.to_string());
    }
    fn progress(&mut self, _case: &str) -> Option<ProgressHook<'static>> {
        let (stop, after) = (self.stop.clone(), self.after?);
        Some(Box::new(move |progress| {
            stop.fetch_or(progress.done >= after, Ordering::Relaxed);
        }))
    }
}

/// A case that was cancelled, and whose checkpoint lacks the state of a part of the body, as one of another build of the
/// program may, says so and begins anew to the outcome of a case that was not cancelled.
#[test]
fn a_case_begins_anew_without_a_state_that_fits() {
    let whole = Folder::new("checkpoint-whole");
    let steep = |folder: &Folder| folder.sweep().only(&["steep".into()]).unwrap();
    let expected = steep(&whole).run(None, &mut NoProgress).unwrap();

    let folder = Folder::new("checkpoint-foreign");
    let mut watch = Cancelling {
        after: Some(10),
        ..Cancelling::default()
    };
    let stop = watch.stop.clone();
    let cancelled = steep(&folder).run(Some(&stop), &mut watch);
    assert!(matches!(cancelled, Err(StudyError::Interrupted)));
    let file = folder.0.join("out/steep/checkpoint/latest.run");
    let kind = ("checkpoint of a run", 7);
    let mut sections = read_sections(&file, kind).unwrap();
    let lost = sections.pop().unwrap().name;
    let parts = sections.iter();
    let parts = parts.map(|section| (section.name.as_str(), section.bytes.as_slice()));
    write_sections(&file, kind, parts).unwrap();

    let mut watch = Cancelling::default();
    let found = steep(&folder).run(None, &mut watch).unwrap();
    let [resumed, unused, ..] = &watch.events[..] else {
        panic!("{:?}", watch.events);
    };
    assert!(resumed.starts_with("resumed after "), "{resumed}");
    assert!(
        unused.starts_with("warning: a checkpoint is not used: ") && unused.contains(&lost),
        "{lost}: {unused}"
    );
    assert_eq!(found[0].relative, expected[0].relative);
    assert_eq!(found[0].joints, expected[0].joints);
    assert!(!folder.0.join("out/steep/checkpoint").exists());
}
