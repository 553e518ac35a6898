//! Scene files as typed specifications.

use std::path::PathBuf;

use powerhouse::spec::{At, Finite, InitialMotion, Positive, Precision};
use powerhouse::{FileScene, SceneFile, run_inputs};

use super::support::*;

/// The scenes that come with the software; other files beside them are of mesh generators.
fn stored() -> Vec<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes");
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        text.lines().any(|line| line.starts_with("title = "))
    });
    files.sort();
    files
}

/// Every stored scene, and every case of it, that is written and read again has the same keys and values.
#[test]
fn what_is_written_is_read_again() {
    let mut cases = 0;
    for path in stored() {
        let file = SceneFile::read(&path).unwrap();
        let own = file.spec(None).unwrap();
        let names = own.cases.iter().map(|case| Some(case.name.to_string()));
        for case in core::iter::once(None).chain(names) {
            let spec = file.spec(case.as_deref()).unwrap();
            let written = spec.to_table().unwrap();
            let text = toml::to_string(&written).unwrap();
            let again = SceneFile::parse(text, &path).unwrap().spec(None).unwrap();
            assert_eq!(
                again.to_table().unwrap(),
                written,
                "{} {case:?}",
                path.display()
            );
            assert_eq!(again.materials, spec.materials);
            assert_eq!(again.output, spec.output);
            cases += 1;
        }
    }
    assert!(cases > 50, "{cases}");
}

/// Keys that a file does not have, and that have their default values, are not written.
#[test]
fn default_values_are_not_written() {
    let file = SceneFile::parse(CUBE, "cube.toml").unwrap();
    let written = file.spec(None).unwrap().to_table().unwrap();
    let read: toml::Table = toml::from_str(CUBE).unwrap();
    let keys = |table: &toml::Table| -> Vec<String> { table.keys().cloned().collect() };
    assert_eq!(keys(&written), keys(&read));
    for key in ["boundary", "material", "part", "wave", "output", "mesh"] {
        let as_read = read[key].to_string().replace(".0", "");
        assert_eq!(written[key].to_string().replace(".0", ""), as_read);
    }
}

/// A changed specification gives the scene of a text with the same change.
#[test]
fn a_changed_specification_is_a_changed_file() {
    let folder = Folder::new("specs");
    powerhouse::io::write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
    let registry = powerhouse::Registry::default();
    let path = folder.join("scene.toml");
    let mut spec = SceneFile::parse(CUBE, &path).unwrap().spec(None).unwrap();
    spec.precision = Precision::Mixed;
    spec.time.duration = Positive::new(0.3).unwrap();
    spec.time.initial = InitialMotion::Field.into();
    spec.waves[0].factor = Finite::new(3.0);
    spec.output.every = Positive::new(0.02).map(At::from);
    spec.parts[0].kernel = Some("hex8-eas".to_owned().into());
    let changed = FileScene::from_spec(spec, &registry).unwrap();
    let text = format!("precision = \"mixed\"\n{CUBE}")
        .replace("duration = 0.6", "duration = 0.3\ninitial = \"field\"")
        .replace("azimuth = 30", "azimuth = 30\nfactor = 3")
        .replace("every = 0.01", "every = 0.02")
        .replace("hex8-full", "hex8-eas");
    let expected = FileScene::from_toml(text, &path, &registry).unwrap();
    assert_eq!(run_inputs(&changed), run_inputs(&expected));
    assert_eq!(changed.output(), expected.output());
    assert_eq!(
        changed.parts()[0].kernel.as_ref().unwrap().name(),
        "hex8-eas"
    );
    let differ = run_inputs(&FileScene::from_toml(CUBE, &path, &registry).unwrap());
    let differ = differ.differences(&run_inputs(&expected));
    let expected = [
        "duration",
        "key 'output.every'",
        "key 'part'",
        "key 'time.initial'",
        "key 'wave'",
        "precision",
    ];
    let mut differ = differ;
    differ.sort_unstable();
    assert_eq!(differ, expected);
}

/// Names of materials and records are checked with the keys, without a mesh, also those that a case changes.
#[test]
fn names_are_checked_with_the_keys() {
    let folder = Folder::new("specs-names");
    let path = folder.join("scene.toml");
    let check = |text: &str| {
        std::fs::write(&path, text).unwrap();
        let registry = powerhouse::Registry::default();
        let checked = FileScene::check_keys(&path, &[], &registry);
        checked.map_err(|error| error.to_string())
    };
    assert_eq!(check(CUBE), Ok(0));
    let record = "[[record]]\nname = \"quake\"\nfile = \"quake.txt\"\nunits = \"g\"\nconvention = \"incident\"\n";
    let pulse = "pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }";
    let shaken = |name: &str| CUBE.replace(pulse, &format!("record = \"{name}\"")) + record;
    assert_eq!(check(&shaken("quake")), Ok(0));
    let material = "material = \"granite\"";
    let of_case =
        "[[case]]\nname = \"other\"\n[[case.part]]\nset = \"rock\"\nmaterial = \"granit\"\n";
    for (text, expected) in [
        (
            CUBE.replace(material, "material = \"granit\""),
            "there is no material 'granit'",
        ),
        (format!("{CUBE}{of_case}"), "there is no material 'granit'"),
        (shaken("quack"), "there is no record 'quack'"),
        (
            shaken("quake") + record,
            "the record 'quake' is defined twice",
        ),
    ] {
        let found = check(&text).unwrap_err();
        assert!(found.contains(expected), "{expected}: {found}");
    }
}

/// A fault in a changed value is reported where the file has the former one.
#[test]
fn a_fault_in_a_changed_value_is_where_the_value_was() {
    let folder = Folder::new("specs-fault");
    powerhouse::io::write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
    let mut spec = SceneFile::parse(CUBE, folder.join("scene.toml"))
        .unwrap()
        .spec(None)
        .unwrap();
    **spec.parts[0].kernel.as_mut().unwrap() = "hex9".to_owned();
    let error = FileScene::from_spec(spec, &powerhouse::Registry::default())
        .err()
        .unwrap()
        .to_string();
    let line = CUBE
        .lines()
        .position(|line| line.starts_with("kernel"))
        .unwrap()
        + 1;
    assert!(
        error.contains("hex9") && error.contains(&format!(":{line}:10")),
        "{error}"
    );
}
