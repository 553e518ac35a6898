//! What counts as finished, and what is left of a case that is not.

use super::*;

fn steep(folder: &Folder) -> Sweep {
    folder.sweep().only(&["steep".into()]).unwrap()
}

fn reported(folder: &Folder) -> Vec<String> {
    let outcomes = read_outcomes(folder.0.join("out")).unwrap();
    outcomes.into_iter().map(|case| case.name).collect()
}

/// Results that another run has replaced are neither reported nor taken for those of the sweep.
#[test]
fn replaced_results_count_no_more() {
    let folder = Folder::new("replaced");
    let sweep = || folder.sweep().lasting(0.01).unwrap();
    sweep().run(None, &mut Silent).unwrap();
    assert_eq!(reported(&folder), ["steep", "slanted", "continuous"]);
    // As `powerhouse run` does it, for less time.
    let scene = Scene::case_from_file_with(folder.scene(), "slanted", &registry()).unwrap();
    let scene = scene.duration(0.005);
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
        .write((&title, &mesh), &results, &[], Some(&text))
        .unwrap();
    assert_eq!(reported(&folder), ["steep", "continuous"]);
    let mut count = Count::default();
    sweep().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["slanted"]);
    assert_eq!(reported(&folder), ["steep", "slanted", "continuous"]);
}

/// Outcomes of another scene, or of another duration, are not reported beside those of a sweep that was
/// begun since, though they are still to be replaced.
#[test]
fn pending_cases_are_not_reported() {
    let folder = Folder::new("pending");
    let short = folder.sweep().lasting(0.01).unwrap();
    short.run(None, &mut Silent).unwrap();
    assert_eq!(reported(&folder).len(), 3);
    let longer = steep(&folder).lasting(0.012).unwrap();
    longer.run(None, &mut Silent).unwrap();
    assert_eq!(reported(&folder), ["steep"]);
    let stop = Arc::new(AtomicBool::new(true));
    let all = folder.sweep().lasting(0.012).unwrap();
    let stopped = all.run(Some(&stop), &mut Silent);
    assert!(matches!(stopped, Err(StudyError::Interrupted)));
    assert_eq!(reported(&folder), ["steep"]);
}

/// A case that fails on its way is told by its name, keeps what it recorded, and is not finished; so is one
/// whose free field errs by more than its scene permits, and one that is refused leaves what was there.
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
    // A step beyond the stable one is refused before anything is removed.
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
