//! Recognition of finished cases, and results of unfinished ones.

use super::*;
use powerhouse::FileScene;

fn steep(folder: &Folder) -> Sweep {
    folder.sweep().only(&["steep".into()]).unwrap()
}

fn reported(folder: &Folder) -> Vec<String> {
    let outcomes = read_outcomes(folder.0.join("out")).unwrap();
    outcomes.into_iter().map(|case| case.name).collect()
}

/// Results that another run has replaced are neither reported nor reused by the sweep.
#[test]
fn replaced_results_count_no_more() {
    let folder = Folder::new("replaced");
    let sweep = || folder.sweep().with_duration(0.01).unwrap();
    sweep().run(None, &mut NoProgress).unwrap();
    assert_eq!(reported(&folder), ["steep", "slanted", "continuous"]);
    // As `powerhouse run` does it, for less time.
    let scene = FileScene::case_from_file_with(folder.scene(), "slanted", &registry()).unwrap();
    let scene = scene.map(|scene| scene.with_duration(0.005));
    let (title, text) = (
        scene.title().to_owned(),
        scene.source().unwrap().text.clone(),
    );
    let simulation = scene.prepare().unwrap();
    let mesh = simulation.mesh().clone();
    let results = simulation.run(RunHooks::default()).unwrap();
    let replaced = ResultFolder::new(folder.0.join("out/slanted"));
    replaced.clear().unwrap();
    assert_eq!(reported(&folder), ["steep", "continuous"]);
    replaced
        .write((&title, &mesh), &results, &RunNotes::default(), Some(&text))
        .unwrap();
    assert_eq!(reported(&folder), ["steep", "continuous"]);
    let mut count = Count::default();
    sweep().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["slanted"]);
    assert_eq!(reported(&folder), ["steep", "slanted", "continuous"]);
}

/// Outcomes of another scene or another duration are not reported with those of a later sweep, before they are replaced.
#[test]
fn pending_cases_are_not_reported() {
    let folder = Folder::new("pending");
    let short = folder.sweep().with_duration(0.01).unwrap();
    short.run(None, &mut NoProgress).unwrap();
    assert_eq!(reported(&folder).len(), 3);
    let longer = steep(&folder).with_duration(0.012).unwrap();
    longer.run(None, &mut NoProgress).unwrap();
    assert_eq!(reported(&folder), ["steep"]);
    let stop = Arc::new(AtomicBool::new(true));
    let all = folder.sweep().with_duration(0.012).unwrap();
    let stopped = all.run(Some(&stop), &mut NoProgress);
    assert!(matches!(stopped, Err(StudyError::Interrupted)));
    assert_eq!(reported(&folder), ["steep"]);
}

/// A case that fails during its run is reported by name, keeps its recorded results, and is not finished; so is one whose
/// free-field error is above its limit. An invalid case leaves earlier files unchanged.
#[test]
fn a_case_that_fails_keeps_what_it_recorded() {
    let folder = Folder::new("failing");
    let write = |text: String| std::fs::write(folder.scene(), text).unwrap();
    let out = folder.0.join("out/steep");
    let run = || {
        let mut count = Count::default();
        let found = steep(&folder).run(None, &mut count);
        (found.map(|found| found.len()), count)
    };
    write(format!("energy_residual = 1e-30\n{SCENE}"));
    let (failed, count) = run();
    let failed = failed.unwrap_err();
    assert!(
        matches!(&failed, StudyError::Case { case, source }
            if case == "steep" && matches!(**source, StudyError::Scene(Error::Run(_)))),
        "{failed:?}"
    );
    assert!(failed.to_string().starts_with("case 'steep': "), "{failed}");
    assert_eq!(count.failed, ["steep"]);
    let histories = read_table(&out.join("histories.csv")).unwrap();
    assert!(!histories[0].values.is_empty() && out.join("summary.json").exists());
    assert!(reported(&folder).is_empty());

    // The check of the free field.
    write(format!("self_check = 0.5\n{SCENE}"));
    let (done, count) = run();
    assert_eq!((done.unwrap(), count.failed.len()), (1, 0));
    let error = count.checked[0];
    assert!(0.0 < error && error < 0.5, "{error}");
    assert_eq!(reported(&folder), ["steep"]);
    // A step beyond the stable one is an error before any file is removed.
    write(SCENE.replace("duration = 0.05", "duration = 0.05\nstep = 0.1"));
    let (refused, _) = run();
    assert!(
        matches!(refused, Err(StudyError::Case { .. })),
        "{refused:?}"
    );
    assert!(out.join("histories.csv").exists());
    write(format!("self_check = {}\n{SCENE}", 0.5 * error));
    let (coarse, _) = run();
    let coarse = coarse.unwrap_err().to_string();
    assert!(coarse.contains("above the scene's self_check"), "{coarse}");
}

/// A case whose files are missing or changed is not finished: a report states it, and a sweep runs it again.
#[test]
fn a_case_whose_files_are_gone_is_run_again() {
    let folder = Folder::new("gone");
    let sweep = || folder.sweep().with_duration(0.01).unwrap();
    sweep().run(None, &mut NoProgress).unwrap();
    let out = folder.0.join("out");
    assert_eq!(report_gaps(&out).unwrap(), Vec::<String>::new());
    std::fs::remove_file(out.join("slanted/histories.csv")).unwrap();
    std::fs::write(out.join("continuous/plots/A.svg"), "").unwrap();
    assert_eq!(reported(&folder), ["steep"]);
    let gaps = report_gaps(&out).unwrap();
    assert!(
        gaps[0].contains("'slanted'") && gaps[0].ends_with(": histories.csv"),
        "{gaps:?}"
    );
    assert!(
        gaps[1].contains("'continuous'") && gaps[1].ends_with("A.svg"),
        "{gaps:?}"
    );
    let page = std::fs::read_to_string(write_report(&out).unwrap()).unwrap();
    assert!(page.contains("files of it are gone or changed: histories.csv"));
    let mut count = Count::default();
    sweep().run(None, &mut count).unwrap();
    assert_eq!(count.kept, ["steep"]);
    assert_eq!(count.ended, ["slanted", "continuous"]);
    assert_eq!(report_gaps(&out).unwrap(), Vec::<String>::new());
}

/// Invalid durations are errors with their value; a folder that another run has locked is an error before a case begins.
#[test]
fn errors_precede_the_first_case() {
    let folder = Folder::new("refused");
    for duration in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        let refused = folder.sweep().with_duration(duration).err().unwrap();
        assert!(matches!(refused, StudyError::Parameter(_)), "{refused:?}");
    }
    let sweep = folder.sweep().with_duration(0.01).unwrap();
    let lock = ResultFolder::new(folder.0.join("out")).lock().unwrap();
    let refused = sweep.run(None, &mut NoProgress).unwrap_err().to_string();
    assert!(refused.contains("another run (process "), "{refused}");
    assert!(!folder.0.join("out/steep").exists());
    drop(lock);
}
