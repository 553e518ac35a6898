//! Equilibrated bodies that cases share.

use super::*;
use powerhouse::FileScene;

/// An equilibrated body is read from its file bit by bit; a truncated, damaged or missing file is an error with its
/// name.
#[test]
fn a_body_comes_back_from_its_file() {
    let folder = Folder::new("body");
    let scene = FileScene::case_from_file_with(folder.scene(), "steep", &registry()).unwrap();
    let body = scene.prepare().unwrap().equilibrate(None, None);
    let body = body.unwrap().unwrap();
    let file = folder.0.join("rest.body");
    body.write(&file).unwrap();
    let back = EquilibratedBody::read(&file).unwrap();
    assert_eq!(back, body);
    assert!(!body.state().joints.is_empty() && !body.state().history.is_empty());
    let bytes = std::fs::read(&file).unwrap();
    let mut damaged = bytes.clone();
    damaged[bytes.len() / 2] ^= 1;
    for bad in [&bytes[..bytes.len() - 9], &damaged, b"powerhouse"] {
        std::fs::write(&file, bad).unwrap();
        let refused = EquilibratedBody::read(&file);
        assert!(
            matches!(refused, Err(Error::UnreadableBody { .. })),
            "{refused:?}"
        );
    }
    let none = EquilibratedBody::read(&folder.0.join("none"));
    assert!(matches!(none, Err(Error::Read { .. })));
}

/// A case from the shared equilibrated body has the same motion as the case run alone, bit by bit.
#[test]
fn a_shared_body_moves_as_one_of_its_own() {
    let folder = Folder::new("shared");
    let sweep = folder.sweep().with_duration(0.02).unwrap();
    let cases = ["steep", "slanted"].map(str::to_owned);
    sweep
        .only(&cases)
        .unwrap()
        .run(None, &mut NoProgress)
        .unwrap();
    let scene = FileScene::case_from_file_with(folder.scene(), "slanted", &registry()).unwrap();
    assert_eq!(scene.case(), Some("slanted"));
    let scene = scene.map(|scene| scene.with_duration(0.02));
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let shared = read_table(&folder.0.join("out/slanted/histories.csv")).unwrap();
    for column in &results.histories().columns {
        let found = shared.iter().find(|other| other.name == column.name);
        assert_eq!(found.unwrap().values, column.values, "{}", column.name);
    }
}

/// An equilibrated body of another scene is an error with the numbers that differ.
#[test]
fn a_body_of_another_scene_is_an_error() {
    let folder = Folder::new("foreign");
    let case = |name: &str| {
        let scene = FileScene::case_from_file_with(folder.scene(), name, &registry()).unwrap();
        scene.prepare().unwrap()
    };
    let body = case("continuous").equilibrate(None, None).unwrap();
    let mut hooks = RunHooks::default();
    hooks.equilibrated_body = body;
    let Err(error) = case("steep").run(hooks) else {
        panic!("a body of another mesh went unseen")
    };
    assert!(matches!(error, Error::ForeignBody { .. }), "{error}");
}
