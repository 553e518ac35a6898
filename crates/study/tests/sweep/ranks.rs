//! Cases that several ranks compute together.

use std::collections::BTreeMap;

use powerhouse::engine::ExplicitOnRanks;
use powerhouse::model::ThreadRanks;

use super::*;
use powerhouse_test_support::{motion_text, synthetic_motion};

/// What rank 0 has of a sweep: its outcomes or its error, and the counts of its callbacks.
struct Led {
    outcomes: Result<Vec<CaseOutcome>, String>,
    count: Count,
}

/// Runs the sweep of a folder on a number of ranks; the others than rank 0 return no outcomes.
fn on_ranks(folder: &Folder, ranks: usize, stop: &Arc<AtomicBool>) -> Led {
    let found = ThreadRanks::run(ranks, |ranks| {
        let engine = Arc::new(ExplicitOnRanks::new(Box::new(ranks)));
        let leads = engine.rank() == 0;
        let mut count = Count::default();
        let sweep = folder.sweep().on_ranks(engine);
        let found = sweep.run(Some(stop), &mut count);
        if leads {
            let outcomes = found.map_err(|error| error.to_string());
            Ok(Some(Led { outcomes, count }))
        } else {
            assert_eq!(found.unwrap(), []);
            assert!(count.ended.is_empty() && count.failed.is_empty());
            Ok(None)
        }
    });
    let found = found.into_iter().map(Result::unwrap);
    found.flatten().next().unwrap()
}

/// The files of a folder by their names; those of its folders are left out.
fn files_in(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    let files = entries.filter(|entry| entry.path().is_file());
    let named = files.map(|entry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        (name, std::fs::read(entry.path()).unwrap())
    });
    named.collect()
}

fn timeless(outcomes: &[CaseOutcome]) -> Vec<CaseOutcome> {
    let with_time = |case: &CaseOutcome| CaseOutcome {
        wall_time: 0.0,
        ..case.clone()
    };
    outcomes.iter().map(with_time).collect()
}

/// Cases have the outcomes and tables of one process, bodies after the stages are shared as there, and finished cases are not
/// run again.
#[test]
fn ranks_compute_a_case_together() {
    let never = Arc::new(AtomicBool::new(false));
    let alone = Folder::new("ranks-alone");
    let expected = alone.sweep().run(None, &mut NoProgress).unwrap();
    // The excavated body has two blocks.
    let folder = Folder::new("ranks-two");
    let led = on_ranks(&folder, 2, &never);
    assert_eq!(timeless(&led.outcomes.unwrap()), timeless(&expected));
    assert_eq!(led.count.ended, ["steep", "slanted", "continuous"]);
    assert_eq!(led.count.at_rest, ["steep", "continuous"]);
    for case in ["steep", "slanted", "continuous"] {
        let files = |folder: &Folder| files_in(&folder.0.join("out").join(case));
        let (found, expected) = (files(&folder), files(&alone));
        assert!(expected.len() > 5 && found.keys().eq(expected.keys()));
        for (name, content) in &expected {
            // Wall times.
            let timed = ["summary.json", "outcome.json", "finished.json"];
            assert!(
                timed.contains(&&**name) || found[name] == *content,
                "{case}/{name}"
            );
        }
    }
    // A lost case alone is run again, from the body in its file.
    std::fs::remove_file(folder.0.join("out/slanted/finished.json")).unwrap();
    let led = on_ranks(&folder, 2, &never);
    assert_eq!(led.count.ended, ["slanted"]);
    assert!(led.count.at_rest.is_empty());
    assert_eq!(timeless(&led.outcomes.unwrap()), timeless(&expected));
}

/// A case that cannot be run is the failure of the sweep, with the message of one process, and no rank is left waiting; nor
/// is one after an interruption, from which another number of ranks goes on.
#[test]
fn failures_and_interruptions_end_all_ranks() {
    let never = Arc::new(AtomicBool::new(false));
    for (from, to) in [
        // When the step is chosen, in the free-field check, which rank 0 makes alone, and in the stage.
        ("duration = 0.05", "duration = 0.05\nstep = 0.5"),
        ("title = \"bay\"", "title = \"bay\"\nself_check = 1e-9"),
        ("    { kind = \"roller\", set = \"bottom\" },\n", ""),
    ] {
        let folder = Folder::new("ranks-failure");
        assert!(SCENE.contains(from), "{from}");
        std::fs::write(folder.scene(), SCENE.replacen(from, to, 1)).unwrap();
        let expected = folder
            .sweep()
            .run(None, &mut NoProgress)
            .unwrap_err()
            .to_string();
        let led = on_ranks(&folder, 2, &never);
        assert_eq!(led.outcomes.unwrap_err(), expected);
        assert_eq!(led.count.failed, ["steep"]);
    }
    let folder = Folder::new("ranks-interrupted");
    let stop = Arc::new(AtomicBool::new(true));
    let led = on_ranks(&folder, 2, &stop);
    assert!(led.outcomes.unwrap_err().contains("interrupted"));
    let alone = Folder::new("ranks-uninterrupted");
    let expected = alone.sweep().run(None, &mut NoProgress).unwrap();
    let found = folder.sweep().run(None, &mut NoProgress).unwrap();
    assert_eq!(timeless(&found), timeless(&expected));
    // More ranks than blocks.
    let folder = Folder::new("ranks-too-many");
    let led = on_ranks(&folder, 3, &never);
    let refused = led.outcomes.unwrap_err();
    assert!(
        refused.contains("case 'steep': model: 3 ranks need as many blocks"),
        "{refused}"
    );
}

/// A set of records under which a joint slips, computed by two ranks together, has the files, the statistics and the fragility of one
/// process.
#[test]
fn ranks_compute_a_set_of_records() {
    let never = Arc::new(AtomicBool::new(false));
    let cases = SCENE.find("[[case]]").unwrap();
    let mut scene = SCENE[..cases].to_owned();
    for (old, new) in [
        (
            "kind = \"p\"\nincidence = 0\npulse = { kind = \"smooth\", displacement = 0.01, duration = 0.1 }",
            "kind = \"sv\"\nincidence = 20\nrecord = \"motions\"",
        ),
        ("cohesion = 1e6\ntensile_strength = 1e6\n", ""),
        ("duration = 0.05", "duration = 1"),
    ] {
        assert!(scene.contains(old), "{old}");
        scene = scene.replace(old, new);
    }
    scene += "[[record_set]]\nname = \"motions\"\nfolder = \"motions\"\nunits = \"m/s2\"\nconvention = \"incident\"\n\
              scales = [1, 4]\n[[record_set.fragility]]\nname = \"slip\"\nfigure = \"joint seam slip\"\nlimit = 1e-4\n";
    let folder = |name: &str| {
        let folder = Folder::new(name);
        std::fs::create_dir(folder.0.join("motions")).unwrap();
        for number in 1..=3 {
            let text = motion_text(&synthetic_motion(number));
            std::fs::write(folder.0.join(format!("motions/r{number}.txt")), text).unwrap();
        }
        std::fs::write(folder.scene(), &scene).unwrap();
        folder
    };
    let alone = folder("ranks-set-alone");
    let expected = alone.sweep().run(None, &mut NoProgress).unwrap();
    assert!(expected.iter().any(|case| case.joints[0].slip > 1e-5));
    let together = folder("ranks-set-two");
    let led = on_ranks(&together, 2, &never);
    assert_eq!(timeless(&led.outcomes.unwrap()), timeless(&expected));
    let timed = [
        "summary.json",
        "outcome.json",
        "finished.json",
        "sweep.csv",
        "cases.json",
    ];
    let mut compared = 0;
    for case in expected.iter().map(|case| case.name.as_str()).chain([""]) {
        let files = |folder: &Folder| files_in(&folder.0.join("out").join(case));
        let (found, expected) = (files(&together), files(&alone));
        assert!(found.keys().eq(expected.keys()));
        for (name, content) in &expected {
            assert!(
                timed.contains(&&**name) || found[name] == *content,
                "{case}/{name}"
            );
            compared += 1;
        }
    }
    assert!(compared > 40, "{compared}");
}
