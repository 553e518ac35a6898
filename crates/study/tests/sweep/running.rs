//! Runs of cases, shared stages and parallel execution.

use super::*;
use powerhouse::FileScene;

/// Cases run sequentially; the stages are computed once for cases that share joints and faces; finished cases are not run
/// again until an input changes.
#[test]
fn finished_cases_are_kept_and_stages_are_shared() {
    let folder = Folder::new("sweep");
    let mut count = Count::default();
    let first = folder.sweep().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["steep", "slanted", "continuous"]);
    assert_eq!(count.at_rest, ["steep", "continuous"]);
    assert_eq!((first[0].joints.len(), first[2].joints.len()), (1, 0));
    assert_eq!(first[0].relative[0].name, "A-O1");
    assert!(first.iter().all(|case| case.relative[0].value > 1e-4));

    let mut count = Count::default();
    let again = folder.sweep().run(None, &mut count).unwrap();
    assert_eq!((count.kept.len(), count.ended.len()), (3, 0));
    assert_eq!(again, first);

    // A lost case alone is run again, with the same motion.
    std::fs::remove_file(folder.0.join("out/slanted/finished.json")).unwrap();
    let mut count = Count::default();
    let mended = folder.sweep().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["slanted"]);
    assert_eq!(mended[1].relative, first[1].relative);
    // From the body that the first sweep left.
    assert!(count.at_rest.is_empty(), "{:?}", count.at_rest);

    // An added case shares a body only if nothing differs that acts before the motion.
    let softer = "[[case]]\nname = \"softer\"\nmaterial = [{ name = \"rock\", young = 8e9 }]\n\
                  [[case]]\nname = \"stiffer\"\nboundary = { amplitude_ratio = 0.5 }\n";
    std::fs::write(folder.scene(), format!("{SCENE}{softer}")).unwrap();
    let mut count = Count::default();
    let sweep = folder
        .sweep()
        .only(&["softer", "stiffer"].map(str::to_owned));
    sweep.unwrap().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["softer", "stiffer"]);
    assert_eq!(count.at_rest, ["softer"]);
    // The table contains all finished cases.
    let table = std::fs::read_to_string(folder.0.join("out/sweep.csv")).unwrap();
    let named = |line: &str| line.split(',').next().unwrap().to_owned();
    let names: Vec<String> = table.lines().map(named).collect();
    let all = ["steep", "slanted", "continuous", "softer", "stiffer"];
    assert_eq!(names[0], "case");
    assert_eq!(names[1..], all);

    // Added cases, a comment and another number of threads do not change a case.
    let same = format!("threads = 1\n# A remark.\n{SCENE}{softer}");
    std::fs::write(folder.scene(), same).unwrap();
    let mut count = Count::default();
    folder.sweep().run(None, &mut count).unwrap();
    assert_eq!(
        (count.kept, count.ended.len()),
        (all.map(str::to_owned).to_vec(), 0)
    );
    // A key of a case changes that case alone.
    let stiffer = softer.replace("amplitude_ratio = 0.5", "amplitude_ratio = 0.6");
    std::fs::write(folder.scene(), format!("{SCENE}{stiffer}")).unwrap();
    let mut count = Count::default();
    folder.sweep().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["stiffer"]);

    // An edited mesh changes all cases.
    write_gmsh(folder.0.join("mesh.msh"), &slice(1.1)).unwrap();
    let mut count = Count::default();
    let only = folder.sweep().only(&["steep".into()]).unwrap();
    only.run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["steep"]);
    assert_eq!(count.at_rest, ["steep"]);
}

/// Parallel cases have the same bits as sequential ones, compute shared stages once, and are in the table in the order
/// of the scene.
#[test]
fn cases_run_in_parallel() {
    let folder = Folder::new("side-by-side");
    let mut count = Count::default();
    let together = folder.sweep().side_by_side(NonZeroUsize::new(2).unwrap());
    let together = together.run(None, &mut count).unwrap();
    assert_eq!((count.ended.len(), count.at_rest.len()), (3, 2));
    let table = std::fs::read(folder.0.join("out/sweep.csv")).unwrap();
    let alone = Folder::new("one-by-one");
    let apart = alone.sweep().run(None, &mut NoProgress).unwrap();
    let timeless = |outcomes: Vec<CaseOutcome>| -> Vec<CaseOutcome> {
        let with_time = |case| CaseOutcome {
            wall_time: 0.0,
            ..case
        };
        outcomes.into_iter().map(with_time).collect()
    };
    assert_eq!(timeless(together), timeless(apart));
    let names = |table: &[u8]| -> Vec<String> {
        let lines = String::from_utf8_lossy(table);
        let named = |line: &str| line.split(',').next().unwrap().to_owned();
        lines.lines().map(named).collect()
    };
    let other = std::fs::read(alone.0.join("out/sweep.csv")).unwrap();
    assert_eq!(names(&table), names(&other));
}

/// Cases may change keys in the tables of a scene; they are the scene with these keys, with stages and runs of their own.
/// An unknown table, key or value is reported with its position when the sweep begins.
#[test]
fn a_case_may_change_keys_of_tables() {
    let folder = Folder::new("changed");
    let case = r#"
[[case]]
name = "other"
varies = "many things"
material = [{ name = "rock", young = 8e9 }]
part = [{ set = "structure", damping = { kind = "rayleigh", ratio = 0.05, frequencies = [2, 20] } }]
joint = [{ name = "seam", cohesion = 1e3, dynamic_friction = 0.2 }]
bolt = [{ name = "pins", diameter = 0.05 }]
stage = [{ name = "opening", tolerance = 2e-3 }]
boundary = { amplitude_ratio = 0.5 }
time = { duration = 0.02, safety = 0.5 }
"#;
    let text = format!("{SCENE}{case}");
    std::fs::write(folder.scene(), &text).unwrap();
    let of =
        |name: &str| FileScene::case_from_file_with(folder.scene(), name, &registry()).unwrap();
    let (own, scene) = (of("other"), of("steep"));
    let young = |scene: &Scene| scene.parts()[0].material.medium().young;
    assert_eq!((young(&own), young(&scene)), (8e9, 9e9));
    assert_eq!((own.duration(), scene.duration()), (0.02, 0.05));
    // All of it: the case moves as the scene with these keys written out, to the last bit.
    let written_out = SCENE
        .replace("young = 9e9", "young = 8e9")
        .replace("cohesion = 1e6", "cohesion = 1e3")
        .replace("dynamic_friction = 0.7", "dynamic_friction = 0.2")
        .replace("diameter = 0.025", "diameter = 0.05")
        .replace("tolerance = 1e-3", "tolerance = 2e-3")
        .replace("duration = 0.05", "duration = 0.02\nsafety = 0.5")
        .replace(
            "kind = \"viscous-spring\"",
            "kind = \"viscous-spring\"\namplitude_ratio = 0.5",
        )
        .replace(
            "set = \"structure\"\nmaterial = \"rock\"",
            "set = \"structure\"\nmaterial = \"rock\"\n\
             damping = { kind = \"rayleigh\", ratio = 0.05, frequencies = [2, 20] }",
        );
    let run = |scene: FileScene| scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let changed = run(own);
    std::fs::write(folder.scene(), written_out).unwrap();
    let twin = run(of("steep"));
    assert_eq!(changed.histories(), twin.histories());
    assert_eq!(changed.bolts, twin.bolts);
    assert_ne!(
        changed.histories(),
        run(scene.map(|scene| scene.with_duration(0.02))).histories()
    );

    let refused = |change: &dyn Fn(&str) -> String| {
        std::fs::write(folder.scene(), change(&text)).unwrap();
        let refused = Sweep::of_file(folder.scene(), None).err().unwrap();
        refused.to_string()
    };
    let lost =
        refused(&|text| text.replace("name = \"seam\", cohesion", "name = \"gap\", cohesion"));
    assert!(lost.contains("no joint 'gap'"), "{lost}");
    let key = refused(&|text| text.replace("young = 8e9", "yong = 8e9"));
    assert!(key.contains("unknown key 'yong'"), "{key}");
    let value = refused(&|text| text.replace("young = 8e9", "young = -8e9"));
    let line = text
        .lines()
        .position(|line| line.contains("young = 8e9"))
        .unwrap()
        + 1;
    assert!(value.contains(&format!("scene.toml:{line}:")), "{value}");
    let nameless = refused(&|text| text.replace("name = \"pins\", diameter", "diameter"));
    assert!(nameless.contains("'name'"), "{nameless}");
}

/// A case may have a mesh and supports of its own: here a longer body that is supported by absorbing faces alone.
#[test]
fn a_case_may_have_another_mesh_and_other_supports() {
    let folder = Folder::new("block");
    std::fs::write(folder.0.join("block.txt"), "3").unwrap();
    let case = "[[case]]\nname = \"block\"\nsupport = []\n\
         mesh = { generator = \"layers\", file = \"block.txt\" }\n\
         faces = [\"left\", \"right\", \"front\", \"back\", \"bottom\"]\n";
    std::fs::write(folder.scene(), format!("{}{case}", Folder::generated())).unwrap();
    let of = |name| FileScene::case_from_file_with(folder.scene(), name, &registry()).unwrap();
    let (slice, block) = (of("steep"), of("block"));
    let elements = |scene: &Scene| scene.mesh().element_count();
    assert_eq!(elements(&block) * 2, elements(&slice) * 3);
    assert_eq!((slice.supports().len(), block.supports().len()), (2, 0));
    let faces = |scene: &Scene| scene.boundary().unwrap().faces.len();
    assert_eq!((faces(&slice), faces(&block)), (3, 5));
}

/// A case on request is left out of a sweep unless it is requested by name.
#[test]
fn a_case_on_request_runs_only_on_request() {
    let folder = Folder::new("request");
    let text = SCENE.replace("name = \"steep\"", "name = \"steep\"\non_request = true");
    std::fs::write(folder.scene(), text).unwrap();
    let sweep = folder.sweep();
    assert!(!sweep.cases().is_empty());
    assert!(!sweep.cases().contains(&"steep".to_owned()));
    let asked = sweep.only(&["steep".into()]).unwrap();
    assert_eq!(asked.cases(), ["steep"]);
    let unknown = folder.sweep().only(&["steeper".into()]).err().unwrap();
    let text = unknown.to_string();
    assert!(
        text.contains("steeper") && text.contains("steep,"),
        "{text}"
    );
}

/// A cancelled sweep reports it, and continues where it was.
#[test]
fn a_cancelled_sweep_continues() {
    let folder = Folder::new("stopped");
    let stop = Arc::new(AtomicBool::new(true));
    let stopped = folder.sweep().run(Some(&stop), &mut NoProgress);
    assert!(matches!(stopped, Err(StudyError::Interrupted)));
    // Not with another scene, though.
    let sweep = folder.sweep();
    std::fs::write(
        folder.scene(),
        SCENE.replace("lateral = 0.37", "lateral = 0.4"),
    )
    .unwrap();
    let edited = sweep.run(None, &mut NoProgress);
    assert!(matches!(edited, Err(StudyError::Changed { .. })));
    std::fs::write(folder.scene(), SCENE).unwrap();
    let only = folder.sweep().only(&["steep".into()]).unwrap();
    let done = only
        .with_duration(0.01)
        .unwrap()
        .run(None, &mut NoProgress)
        .unwrap();
    let past = done[0].end - 0.01;
    assert!((0.0..=2.0 * done[0].step).contains(&past), "{past}");
}

/// Unknown and duplicate cases and unknown mesh generators are errors; so is a sweep of a scene without cases.
#[test]
fn invalid_cases_are_errors() {
    let folder = Folder::new("refused");
    let write = |change: &dyn Fn(&str) -> String| {
        std::fs::write(folder.scene(), change(&Folder::generated())).unwrap();
        Sweep::of_file_with(folder.scene(), None, &registry())
            .err()
            .map(|error| error.to_string())
    };
    let twice = write(&|text| text.replace("name = \"slanted\"", "name = \"steep\"")).unwrap();
    assert!(
        twice.contains("the case 'steep' is defined twice"),
        "{twice}"
    );
    let unknown = write(&|text| text.replace("generator = \"layers\"", "generator = \"cave\""));
    let unknown = unknown.unwrap();
    assert!(
        unknown.contains("there is no mesh generator 'cave'"),
        "{unknown}"
    );
    let bad = write(&|text| text.replace("layers.txt", "scene.toml")).unwrap();
    assert!(bad.contains("invalid digit"), "{bad}");
    let none = write(&|text| text[..text.find("[[case]]").unwrap()].into()).unwrap();
    assert!(none.contains("has no [[case]]"), "{none}");
    assert_eq!(write(&|text| text.into()), None);
    let other = folder.sweep().only(&["flat".into()]).err().unwrap();
    assert!(other.to_string().contains("no case 'flat'"), "{other}");
    let lost = FileScene::case_from_file_with(Path::new("lost.toml"), "steep", &registry());
    assert!(matches!(lost, Err(Error::Read { .. })));
}
