//! Checkpoint files: two generations, and what is refused by name.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use powerhouse::engine::{Precision, SavedRun, SavedSection};
use powerhouse::io::parse_sections;
use powerhouse::material::LinearElastic;
use powerhouse::model::{Mesh, Vec3, decode, encode};
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
    let inputs = RunInputs::of_composed(&scene(4.0));
    assert!(matches!(files.read(), Err(CheckpointError::None { .. })));
    for done in [10, 20] {
        files.write_run(&inputs, &state(done)).unwrap();
    }
    (folder, files, inputs)
}

fn latest(folder: &TestFolder) -> PathBuf {
    folder.join("checkpoint/latest.run")
}

/// Where the content of each section of a file begins, behind name, length and checksum.
fn within_sections<const N: usize>(whole: &[u8], names: [&str; N]) -> [usize; N] {
    names.map(|name| {
        let head = [&(name.len() as u16).to_le_bytes()[..], name.as_bytes()].concat();
        let start = whole.windows(head.len()).position(|at| at == head);
        start.unwrap() + head.len() + 16
    })
}

/// A file cut within each section, or with one bit of it flipped, and the reason for which it is refused.
fn damages<const N: usize>(whole: &[u8], names: [&str; N]) -> Vec<(Vec<u8>, String)> {
    let mut damages = Vec::new();
    for (name, within) in names.iter().zip(within_sections(whole, names)) {
        let reason = format!("is incomplete: it ends in the section '{name}'");
        damages.push((whole[..within].to_vec(), reason));
        let mut flipped = whole.to_vec();
        flipped[within] ^= 4;
        damages.push((flipped, format!("damaged in the section '{name}'")));
    }
    damages
}

/// A file of a kind with the version after its own, whole otherwise.
fn newer(whole: &[u8], kind: &str) -> (Vec<u8>, String) {
    let mut places = whole.windows(kind.len());
    let end = kind.len() + places.position(|at| at == kind.as_bytes()).unwrap();
    let mut newer = whole.to_vec();
    let version = newer[end] + 1;
    newer[end] = version;
    let sum = powerhouse::model::Checksum::of(&newer[..end + 4]);
    newer[end + 4..][..8].copy_from_slice(&sum.value().to_le_bytes());
    (newer, format!("has the format version {version}"))
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
    let kind = "checkpoint of a run";
    let mut damages = damages(&whole, names);
    damages.push(newer(&whole, kind));
    damages.push((b"PK".to_vec(), "is not a file of this program".into()));
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
    assert!(parse_sections(&whole, (kind, 7)).is_ok());
}

/// A run of another mesh is refused by name, and a file that cannot be written leaves the state before.
#[test]
fn another_run_is_refused_and_a_failed_write_loses_nothing() {
    let (folder, files, inputs) = written("checkpoints-other");
    files
        .check(&inputs, &RunInputs::of_composed(&scene(4.0)))
        .unwrap();
    let other = files.check(&inputs, &RunInputs::of_composed(&scene(5.0)));
    let text = other.unwrap_err().to_string();
    assert!(text.contains("another run; changed since: mesh"), "{text}");
    // A folder with the name of the file is in its way.
    fs::remove_file(latest(&folder)).unwrap();
    fs::create_dir(latest(&folder)).unwrap();
    fs::write(latest(&folder).join("x"), b"x").unwrap();
    assert!(files.write_run(&inputs, &state(30)).is_err());
    assert_eq!(files.read().unwrap().run, Some(state(10)));
}

/// A body of a stage with damage in any section, or of a newer version, is not used, and the one before is.
#[test]
fn the_older_body_is_used_where_the_last_is_damaged() {
    let (folder, files, inputs) = written("checkpoints-older-body");
    let bodies = [12, 8]
        .map(|nodes| EquilibratedBody::new(powerhouse::model::State::at_rest(nodes), Vec::new()));
    for body in &bodies {
        files.write_body(&inputs, body).unwrap();
    }
    let file = folder.join("checkpoint/latest.stage");
    let whole = fs::read(&file).unwrap();
    assert_eq!(files.read().unwrap().body.as_ref(), Some(&bodies[1]));
    let mut damages = damages(&whole, ["inputs", "state", "stages"]);
    damages.push(newer(&whole, "checkpoint of a stage"));
    for (bytes, reason) in damages {
        fs::write(&file, bytes).unwrap();
        let found = files.read().unwrap();
        assert_eq!(found.body.as_ref(), Some(&bodies[0]), "{reason}");
        assert!(
            found.unused[0].contains(&reason),
            "{reason}: {:?}",
            found.unused
        );
    }
}

/// A checkpoint of another program version, precision or duration is refused by the name of what differs.
#[test]
fn what_differs_is_named() {
    type Fields = (
        Option<PathBuf>,
        Option<String>,
        Vec<String>,
        Option<String>,
        Vec<(String, String)>,
    );
    let (_folder, files, inputs) = written("checkpoints-inputs");
    let (path, case, changes, origin, items): Fields = decode(&encode(&inputs).unwrap()).unwrap();
    for name in ["program version", "precision", "duration"] {
        let mut items = items.clone();
        let item = items.iter_mut().find(|(other, _)| other == name);
        item.unwrap().1 += "1";
        let changed = encode(&(&path, &case, &changes, &origin, items)).unwrap();
        let changed: RunInputs = decode(&changed).unwrap();
        let refused = files.check(&changed, &inputs).unwrap_err().to_string();
        assert!(
            refused.contains(&format!("belongs to another run; changed since: {name}")),
            "{refused}"
        );
    }
    let mixed = RunInputs::of_composed(&scene(4.0).with_precision(Precision::Mixed));
    assert_eq!(inputs.differences(&mixed), ["precision"]);
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
