//! Checkpoint files: two generations, and what is refused by name.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use powerhouse::engine::{SavedRun, SavedSection};
use powerhouse::io::parse_sections;
use powerhouse::material::LinearElastic;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{
    CheckpointError, CheckpointFiles, CheckpointInterval, EquilibratedBody, IntervalError,
    Material, Part, ResultFolder, RunInputs, Scene,
};
use powerhouse_test_support::TestFolder;

fn scene(width: f64) -> Scene {
    let size = Vec3::new(width, 2.0, 2.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [2, 1, 1], "rock").unwrap();
    let rock = LinearElastic::new(powerhouse::material::media::ROCK);
    Scene::new("block", mesh).part(Part::new("rock", Material::from(rock)))
}

fn state(done: u64) -> SavedRun {
    let mut saved = SavedRun::new(done, done as f64 * 1e-3, 1e-3);
    saved.sections = ["run", "block 0: rock", "observer 0: history"]
        .map(|name| SavedSection {
            name: name.into(),
            bytes: vec![done as u8; 40],
        })
        .into();
    saved
}

/// A folder with the states after 10 and after 20 steps.
fn written(name: &str) -> (TestFolder, CheckpointFiles, RunInputs) {
    let folder = TestFolder::new(name);
    let files = CheckpointFiles::of(&*folder);
    let inputs = RunInputs::of(&scene(4.0));
    assert!(matches!(files.read(), Err(CheckpointError::None { .. })));
    for done in [10, 20] {
        files.write_run(&inputs, &state(done)).unwrap();
    }
    (folder, files, inputs)
}

fn latest(folder: &TestFolder) -> PathBuf {
    folder.join("checkpoint/latest.run")
}

/// The last state is read; one that is cut at any section, or in which a bit of any section is flipped, or of a newer
/// version, is not used, with the reason, and the one before is.
#[test]
fn the_older_generation_is_used_where_the_last_is_damaged() {
    let (folder, files, inputs) = written("checkpoints-older");
    let found = files.read().unwrap();
    assert_eq!(
        (found.run.as_ref(), found.unused.len()),
        (Some(&state(20)), 0)
    );
    assert_eq!(found.inputs, inputs);
    let file = latest(&folder);
    let whole = fs::read(&file).unwrap();
    let names = [
        "inputs",
        "head",
        "run",
        "block 0: rock",
        "observer 0: history",
    ];
    // Within the content of a section: behind its name, length and checksum.
    let ends = names.map(|name| {
        let head = [&(name.len() as u16).to_le_bytes()[..], name.as_bytes()].concat();
        let start = whole.windows(head.len()).position(|at| at == head);
        start.unwrap() + head.len() + 16 + 5
    });
    let mut damages: Vec<(Vec<u8>, String)> = Vec::new();
    for (name, end) in names.iter().zip(ends) {
        damages.push((whole[..end].to_vec(), format!("the section '{name}'")));
        let mut flipped = whole.clone();
        flipped[end] ^= 4;
        damages.push((flipped, format!("damaged in the section '{name}'")));
    }
    let kind = "checkpoint of a run";
    let at = whole
        .windows(kind.len())
        .position(|at| at == kind.as_bytes())
        .unwrap();
    let mut newer = whole.clone();
    newer[at + kind.len()] += 1;
    let sum = powerhouse::model::Checksum::of(&newer[..at + kind.len() + 4]);
    newer[at + kind.len() + 4..][..8].copy_from_slice(&sum.value().to_le_bytes());
    damages.push((newer, "format version 3".into()));
    for (bytes, reason) in damages {
        fs::write(&file, bytes).unwrap();
        let found = files.read().unwrap();
        assert_eq!(found.run, Some(state(10)), "{reason}");
        assert!(
            found.unused[0].contains(&reason),
            "{reason}: {:?}",
            found.unused
        );
    }
    // With both damaged the reasons for both are given.
    fs::write(folder.join("checkpoint/previous.run"), b"").unwrap();
    let both = files.read().unwrap_err();
    assert!(matches!(both, CheckpointError::Both { .. }), "{both}");
    assert!(parse_sections(&whole, (kind, 2)).is_ok());
}

/// A run of another mesh is refused by name, and a file that cannot be written leaves the state before.
#[test]
fn another_run_is_refused_and_a_failed_write_loses_nothing() {
    let (folder, files, inputs) = written("checkpoints-other");
    files.check(&inputs, &RunInputs::of(&scene(4.0))).unwrap();
    let other = files.check(&inputs, &RunInputs::of(&scene(5.0)));
    let text = other.unwrap_err().to_string();
    assert!(
        text.contains("another run; changed since: the mesh"),
        "{text}"
    );
    // A folder with the name of the file is in its way.
    fs::remove_file(latest(&folder)).unwrap();
    fs::create_dir(latest(&folder)).unwrap();
    fs::write(latest(&folder).join("x"), b"x").unwrap();
    assert!(files.write_run(&inputs, &state(30)).is_err());
    assert_eq!(files.read().unwrap().run, Some(state(10)));
}

/// The body at the end of a stage is read back, and removed with the other files.
#[test]
fn bodies_of_stages_are_kept() {
    let (folder, files, inputs) = written("checkpoints-body");
    let body = EquilibratedBody::new(powerhouse::model::State::at_rest(12), Vec::new());
    files.write_body(&inputs, &body).unwrap();
    let found = files.read().unwrap();
    assert_eq!(found.body, Some(body));
    files.remove().unwrap();
    assert!(!folder.join("checkpoint").exists());
}

/// Intervals have units; others are refused.
#[test]
fn intervals_have_units() {
    for (text, seconds) in [
        ("30s", 30.0),
        ("10min", 600.0),
        ("1.5 h", 5400.0),
        ("0.2s", 0.2),
    ] {
        let expected = CheckpointInterval::Every(Duration::from_secs_f64(seconds));
        assert_eq!(text.parse(), Ok(expected), "{text}");
        assert_eq!(expected.to_string().parse(), Ok(expected), "{text}");
    }
    assert_eq!("never".parse(), Ok(CheckpointInterval::Never));
    for text in ["", "10", "min", "-1s", "0s", "nan s", "1e300h", "3 days"] {
        let refused = text.parse::<CheckpointInterval>();
        assert_eq!(refused, Err(IntervalError), "{text}");
    }
}

/// The unfinished files of a killed run are removed, and no others.
#[test]
fn unfinished_files_are_removed() {
    let folder = TestFolder::new("checkpoints-unfinished");
    fs::create_dir(folder.join("snapshots")).unwrap();
    let unfinished = [
        "energies.csv.123.part",
        "snapshots/snapshots_00001.vtu.9.part",
        ".writable-7",
    ];
    let others = [
        "energies.csv",
        "my.part",
        "my.part.csv",
        "notes.v2.part",
        "snapshots/a.vtu",
    ];
    for name in unfinished.iter().chain(&others) {
        fs::write(folder.join(name), b"").unwrap();
    }
    ResultFolder::new(&*folder).remove_unfinished().unwrap();
    assert!(unfinished.iter().all(|name| !folder.join(name).exists()));
    assert!(others.iter().all(|name| folder.join(name).exists()));
}
