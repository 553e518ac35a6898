//! Changed keys of scene files: what they change, what they keep, refusals.

use powerhouse::{Error, FileScene, KeyChange, KeyChangeError, Registry, SceneChoice};

use super::support::*;

const SCENE: &str = "\
title = \"two\" # kept
part = [{ set = \"rock\", material = \"a\" }, { set = \"lining\", material = \"b\" }]

[[material]]
name = \"a\" # the first
law = \"elastic\"

[[material]]
name = \"b.c\"
law = \"elastic\"

[[wave]]
kind = \"sv\"
pulse = { kind = \"smooth\", displacement = 0.01 }

[time]
duration = 0.6 # s
";

fn changed(changes: &[&str]) -> Result<String, KeyChangeError> {
    let changes: Vec<KeyChange> = changes.iter().map(|text| text.parse().unwrap()).collect();
    KeyChange::apply(SCENE, None, &changes)
}

/// Keys are found by the names of tables, by position, and in single tables; comments and all else stay.
#[test]
fn keys_are_replaced_where_they_are() {
    for (change, old, new) in [
        ("time.duration=5", "duration = 0.6 # s", "duration = 5 # s"),
        ("time.duration = 1e-1", "0.6 # s", "1e-1 # s"),
        (
            "title=another one",
            "\"two\" # kept",
            "\"another one\" # kept",
        ),
        (
            "material.a.law=mazars",
            "\"a\" # the first\nlaw = \"elastic\"",
            "\"a\" # the first\nlaw = \"mazars\"",
        ),
        (
            "material.\"b.c\".young=9e9",
            "\"b.c\"\nlaw = \"elastic\"",
            "\"b.c\"\nlaw = \"elastic\"\nyoung = 9e9",
        ),
        ("material.2.name=d", "\"b.c\"", "\"d\""),
        ("wave.kind=p", "\"sv\"", "\"p\""),
        ("wave.1.pulse.displacement=0.02", "0.01", "0.02"),
        (
            "wave.pulse={ kind = \"ricker\", f = [1, 2] }",
            "{ kind = \"smooth\", displacement = 0.01 }",
            "{ kind = \"ricker\", f = [1, 2] }",
        ),
    ] {
        assert!(SCENE.contains(old), "{old}");
        assert_eq!(
            changed(&[change]).unwrap(),
            SCENE.replacen(old, new, 1),
            "{change}"
        );
    }
    let added = changed(&["checkpoint.every=5min", "time.step=0.001"]).unwrap();
    let table: toml::Table = added.parse().unwrap();
    assert_eq!(table["checkpoint"]["every"].as_str(), Some("5min"));
    assert_eq!(table["time"]["step"].as_float(), Some(0.001));
    let listed: toml::Table = changed(&["part.lining.kernel=hex8-eas"])
        .unwrap()
        .parse()
        .unwrap();
    let kernels: Vec<_> = (listed["part"].as_array().unwrap().iter())
        .map(|part| part.get("kernel").and_then(|kernel| kernel.as_str()))
        .collect();
    assert_eq!(kernels, [None, Some("hex8-eas")]);
}

/// What cannot be changed is refused with the change, the key and what exists.
#[test]
fn impossible_changes_are_refused() {
    for text in [
        "duration",
        "=5",
        "time.=5",
        "time duration=5",
        "time.duration=",
        "",
    ] {
        let error = text.parse::<KeyChange>().unwrap_err();
        assert!(matches!(error, KeyChangeError::Syntax { .. }), "{text}");
    }
    for (change, wanted) in [
        (
            "title.name=5",
            "'title.name=5': 'title' is a value of the scene file, not a table",
        ),
        (
            "material.d.young=5",
            "no single 'material' of that name; expected one of a, b.c, or a position from 1 to 2",
        ),
        ("material.3.young=5", "a position from 1 to 2"),
        ("material.young=5", "expected one of a, b.c"),
        ("part.0.kernel=x", "expected one of rock, lining"),
        ("wave.2.kind=p", "a position from 1 to 1"),
    ] {
        let error = changed(&[change]).unwrap_err().to_string();
        assert!(error.contains(wanted), "{change}: {error}");
    }
    // The reader of scenes says where such a text is wrong.
    let broken = KeyChange::apply("title = ", None, &["title=x".parse().unwrap()]);
    assert_eq!(broken.as_deref(), Ok("title = "));
}

/// A scene with changed keys is that of a file with these keys, knows them, and states them; faults are those of the file.
#[test]
fn scenes_are_read_with_changed_keys() {
    let folder = Variants::new("key-changes").0;
    let path = folder.join("cube.toml");
    std::fs::write(&path, CUBE).unwrap();
    let read = |changes: &[&str]| {
        let changes = changes.iter().map(|text| text.parse().unwrap()).collect();
        let choice = SceneChoice {
            case: None,
            changes,
        };
        FileScene::from_file_as(&path, &choice, &Registry::default())
    };
    let scene = read(&["wave.incidence=40", "time.duration=0.3"]).unwrap();
    assert_eq!(scene.changes(), ["wave.incidence=40", "time.duration=0.3"]);
    let told = "keys of the scene file that are changed here: wave.incidence=40, time.duration=0.3";
    let simulation = scene.prepare().unwrap();
    let remarks = simulation.remarks();
    let found = remarks.iter().find(|remark| remark.to_string() == told);
    assert!(
        found.is_some_and(|remark| !remark.is_warning()),
        "{remarks:?}"
    );
    let text = CUBE.replace("incidence = 20", "incidence = 40");
    let text = text.replace("duration = 0.6", "duration = 0.3");
    let twin = FileScene::from_toml(text, &path, &Registry::default())
        .unwrap()
        .into_scene();
    let (own, twin) = (
        run(read(&["wave.incidence=40", "time.duration=0.3"]).unwrap()),
        run(twin),
    );
    assert_eq!(own.histories(), twin.histories());
    assert!(
        own.histories()
            .columns
            .iter()
            .any(|column| column.values.iter().any(|&u| u != 0.0))
    );

    assert!(read(&[]).unwrap().changes().is_empty());
    let unknown = read(&["time.durations=3"]).err().unwrap().to_string();
    assert!(
        unknown.contains("durations") && unknown.contains("duration"),
        "{unknown}"
    );
    let error = read(&["part.lining.kernel=x"]).err().unwrap();
    let of_part = error.to_string();
    assert!(of_part.contains("lining"), "{of_part}");
}

/// The keys of a file and its cases are checked without its mesh.
#[test]
fn keys_are_checked_without_the_mesh() {
    let folder = Folder::new("keys-alone");
    let path = folder.join("cube.toml");
    let case = "[[case]]\nname = \"steep\"\nwave = [{ kind = \"p\", incidence = 40, pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 } }]\n";
    std::fs::write(&path, format!("{CUBE}{case}")).unwrap();
    let check = |changes: &[&str]| {
        let changes: Vec<KeyChange> = changes.iter().map(|text| text.parse().unwrap()).collect();
        FileScene::check_keys(&path, &changes, &Registry::default())
    };
    assert!(!folder.join("cube.msh").exists());
    assert_eq!(check(&[]).unwrap(), 1);
    for wrong in [
        "wave.incidence=steep",
        "material.granite.poisson=0.7",
        "time.durations=3",
        "case.steep.wave=5",
    ] {
        assert!(matches!(check(&[wrong]), Err(Error::Scene(_))), "{wrong}");
    }
}

/// A case that names another law has none of the keys of the law of the scene, and must say those that its own needs.
#[test]
fn another_law_of_a_case_has_keys_of_its_own() {
    let folder = Folder::new("other-law");
    let path = folder.join("cube.toml");
    let check = |case: &str| {
        let joint = "[[joint]]\nname = \"seam\"\nbetween = [\"rock\", \"top\"]\nlaw = \"cohesive\"\ntensile_strength = 1e6\ncohesion = 2e6\nopening_energy = 100\nstatic_friction = 0.8\ndynamic_friction = 0.7\n";
        let text = format!("{CUBE}{joint}[[case]]\nname = \"other\"\n{case}\n");
        std::fs::write(&path, text).unwrap();
        FileScene::check_keys(&path, &[], &Registry::default()).map_err(|error| error.to_string())
    };
    for accepted in [
        "material = [{ name = \"granite\", law = \"mohr-coulomb\", preset = \"paper-rock\" }]",
        "material = [{ name = \"granite\", law = \"elastic\", poisson = 0.2 }]",
        "joint = [{ name = \"seam\", law = \"tied\" }]",
        "joint = [{ name = \"seam\", law = \"cohesive\", cohesion = 1e6 }]",
    ] {
        assert_eq!(check(accepted), Ok(1), "{accepted}");
    }
    for (refused, key) in [
        (
            "material = [{ name = \"granite\", law = \"mohr-coulomb\" }]",
            "young",
        ),
        (
            "joint = [{ name = \"seam\", law = \"bonded-coulomb\", cohesion = 1e6 }]",
            "static_friction",
        ),
        (
            "joint = [{ name = \"seam\", law = \"tied\", cohesion = 1e6 }]",
            "cohesion",
        ),
    ] {
        let error = check(refused).unwrap_err();
        assert!(error.contains(key), "{refused}: {error}");
    }
}

/// Keys that a case has for itself are changed there too; what it takes over from the scene is changed in the scene, and a wave
/// that only the scene has is none of a case with waves of its own.
#[test]
fn changes_hold_in_cases() {
    let text = format!(
        "{SCENE}[[case]]\nname = \"soft\"\npart = [{{ set = \"lining\", material = \"a\" }}]\ntime = {{ duration = 2 }}\nwave = [{{ kind = \"p\" }}]\n"
    );
    let changed = |change: &str| KeyChange::apply(&text, Some("soft"), &[change.parse().unwrap()]);
    let case = |change: &str| {
        let table: toml::Table = changed(change).unwrap().parse().unwrap();
        table["case"][0].clone()
    };
    assert_eq!(
        case("time.duration=5")["time"]["duration"].as_integer(),
        Some(5)
    );
    assert_eq!(
        case("part.lining.kernel=x")["part"][0]["kernel"].as_str(),
        Some("x")
    );
    assert_eq!(
        case("part.rock.kernel=x")["part"].as_array().unwrap().len(),
        1
    );
    assert_eq!(
        case("wave.1.kind=sh")["wave"][0]["kind"].as_str(),
        Some("sh")
    );
    let scene: toml::Table = changed("part.rock.kernel=x").unwrap().parse().unwrap();
    assert_eq!(scene["part"][0]["kernel"].as_str(), Some("x"));
    let second = format!("{text}[[wave]]\nkind = \"sh\"\n");
    let refused = KeyChange::apply(&second, Some("soft"), &["wave.2.kind=p".parse().unwrap()]);
    assert!(
        matches!(refused, Err(KeyChangeError::NoSuchTable { .. })),
        "{refused:?}"
    );
}
