//! Sets of records, which a scene file expands into records and cases.

use std::fs;
use std::path::{Path, PathBuf};

use powerhouse::spec::At;
use powerhouse::{Error, FileScene, FirstOfSet, Registry, Remark, SceneFile, SceneSpec};
use powerhouse_test_support::TestFolder;

use super::support::*;

const SCENE: &str = r#"title = "set"
mesh = { file = "none.msh" }
material = [{ name = "rock", law = "elastic", young = 9e9, poisson = 0.25, density = 2700 }]
part = [{ set = "rock", material = "rock" }]
time = { duration = 1 }
[[wave]]
kind = "sv"
incidence = 0
record = "motions"
"#;
const SET: &str = "[[record_set]]\nname = \"motions\"\nconvention = \"outcrop\"\nunits = \"g\"\n";

fn read(folder: &TestFolder, text: &str) -> Result<SceneFile, Error> {
    SceneFile::parse(text, folder.join("scene.toml"))
}

fn names(file: &SceneFile) -> Vec<String> {
    let spec = file.spec(None).unwrap();
    spec.cases
        .iter()
        .map(|case| case.name.to_string())
        .collect()
}

fn text_of(spec: &SceneSpec) -> String {
    toml::to_string(&spec.to_table().unwrap()).unwrap()
}

/// A set of files has a case for each record in the order of the list, and scale in rising order, beside the cases of the scene; each
/// is, key by key, the scene with this record and factor written by hand, and the scene itself that of the first.
#[test]
fn cases_are_those_written_by_hand() {
    let folder = TestFolder::new("record-set-files");
    let set = format!(
        "{SET}files = [\"b/kobe.at2\", \"a.b.txt\"]\nscales = [2, 0.25]\n\
             spectrum = {{ target = {{ kind = \"asce-7\", short = 9, one_second = 4, long_period = 6 }}, periods = [0.1, 2] }}\n\
             [[case]]\nname = \"own\"\n"
    );
    let file = read(&folder, &format!("{SCENE}{set}")).unwrap();
    let all = ["own", "kobe-x0.25", "kobe-x2", "a.b-x0.25", "a.b-x2"];
    assert_eq!(names(&file), all);
    let by_hand = |record: &str, factor: f64| {
        let record = format!(
            "[[record]]\nname = \"motions\"\nconvention = \"outcrop\"\nunits = \"g\"\nfile = \"{record}\"\nfactor = {factor}\n\
                 spectrum = {{ target = {{ kind = \"asce-7\", short = 9, one_second = 4, long_period = 6 }}, periods = [0.1, 2] }}\n"
        );
        let file = read(&folder, &format!("{SCENE}{record}")).unwrap();
        text_of(&file.spec(None).unwrap())
    };
    for (case, record, factor) in [
        (None, "b/kobe.at2", 0.25),
        (Some("own"), "b/kobe.at2", 0.25),
        (Some("kobe-x2"), "b/kobe.at2", 2.0),
        (Some("a.b-x0.25"), "a.b.txt", 0.25),
    ] {
        let own = file.spec(case).unwrap();
        assert_eq!(text_of(&own), by_hand(record, factor), "{case:?}");
    }
    let of_set: Vec<_> = file
        .record_cases()
        .iter()
        .map(|case| (case.record.as_str(), case.scale))
        .collect();
    assert_eq!(
        of_set,
        [("kobe", 0.25), ("kobe", 2.0), ("a.b", 0.25), ("a.b", 2.0)]
    );
}

/// A set of a folder has the files with its ending in the order of their names, without folders and hidden files; without scales the
/// cases have the names of the records, and these no factor.
#[test]
fn folders_are_read_in_order() {
    let folder = TestFolder::new("record-set-folder");
    fs::create_dir_all(folder.join("motions/c.txt")).unwrap();
    for name in ["b.txt", "B.txt", "a.txt", ".d.txt", "readme.md", "e.TXT"] {
        fs::write(folder.join("motions").join(name), "").unwrap();
    }
    let set = format!("{SET}folder = \"motions\"\n");
    let file = read(&folder, &format!("{SCENE}{set}ending = \".txt\"\n")).unwrap();
    assert_eq!(names(&file), ["B", "a", "b"]);
    let spec = file.spec(Some("a")).unwrap();
    assert_eq!(
        *spec.records[0].file.as_deref().unwrap(),
        *Path::new("motions/a.txt")
    );
    assert!(spec.records[0].factor.is_none());
    let whole = read(&folder, &format!("{SCENE}{set}")).unwrap();
    assert_eq!(whole.record_cases().len(), 5);
}

/// Components are one record, with the name given or that of the first file.
#[test]
fn components_are_one_record() {
    let folder = TestFolder::new("record-set-components");
    let set = format!(
        "{SET}components = [{{ x = \"a-000.at2\", y = \"a-090.at2\" }}, {{ name = \"loma\", y = \"b.at2\", z = \"c.at2\" }}]\n"
    );
    let file = read(&folder, &format!("{SCENE}{set}")).unwrap();
    assert_eq!(names(&file), ["a-000", "loma"]);
    let spec = file.spec(Some("loma")).unwrap();
    let components = spec.records[0].components.as_deref().unwrap();
    let of = |file: &Option<At<PathBuf>>| file.as_ref().map(|file| file.display().to_string());
    assert_eq!(
        [of(&components.x), of(&components.y), of(&components.z)],
        [None, Some("b.at2".into()), Some("c.at2".into())]
    );
}

/// What is no set is refused with its line and key.
#[test]
fn what_is_no_set_is_refused() {
    let folder = TestFolder::new("record-set-refused");
    fs::create_dir_all(folder.join("empty")).unwrap();
    let files = "files = [\"a.txt\", \"b.txt\"]\n";
    let line = SCENE.lines().count() + 1;
    for (set, at, expected) in [
        (
            SET.to_string(),
            line + 1,
            "exactly one of folder, files, components must be given, found 0",
        ),
        (
            format!("{SET}{files}folder = \"empty\"\n"),
            line + 1,
            "found 2",
        ),
        (format!("{SET}files = []\n"), line + 4, "found no record"),
        (
            format!("{SET}folder = \"empty\"\n"),
            line + 4,
            "found no record",
        ),
        (format!("{SET}folder = \"lost\"\n"), line + 4, "lost: "),
        (
            format!("{SET}{files}ending = \".txt\"\n"),
            line + 5,
            "'folder' is missing",
        ),
        (
            format!("{SET}files = [\"a.txt\", \"c/a.at2\"]\n"),
            line + 4,
            "the record of the set 'a' is defined twice",
        ),
        (
            format!("{SET}{files}scales = []\n"),
            line + 5,
            "found no scale",
        ),
        (
            format!("{SET}{files}scales = [1, 2, 1.0]\n"),
            line + 5,
            "repeats an earlier one of the list 'scales'",
        ),
        (format!("{SET}{files}scales = [-1]\n"), line + 5, "above 0"),
        (
            format!("{SET}{files}file = \"c.txt\"\n"),
            line + 5,
            "in the place of `file`",
        ),
        (
            format!("{SET}{files}factor = 2\n"),
            line + 5,
            "`scales` in that of `factor`",
        ),
        (
            format!("{SET}{files}scale = [2]\n"),
            line + 5,
            "unknown key 'scale'",
        ),
        (
            format!("{SET}{files}baseline = {{ kind = \"none-such\" }}\n"),
            line + 5,
            "'none-such' is not permitted",
        ),
        (
            format!("{SET}components = [{{ name = \"a\" }}]\n"),
            line + 4,
            "'x' is missing",
        ),
        (
            format!("{SET}{files}[[record_set]]\nname = \"others\"\n"),
            line + 5,
            "one set of records",
        ),
        (
            format!(
                "{SET}{files}fragility = [{{ name = \"a\", figure = \"f\", limit = 1 }}, {{ name = \"a\", figure = \"g\", limit = 1 }}]\n"
            ),
            line + 5,
            "the fragility 'a' is defined twice",
        ),
        (
            "[[record_set]]\nname = \"motions\"\nfiles = [\"a.txt\"]\n".into(),
            line + 1,
            "'convention' is missing",
        ),
    ] {
        let refused = read(&folder, &format!("{SCENE}{set}"))
            .unwrap_err()
            .to_string();
        assert!(refused.contains(expected), "{set}\n{refused}");
        assert!(
            refused.contains(&format!("scene.toml:{at}:")),
            "{set}\n{refused}"
        );
    }
    // A case by hand with the name of one of the set, and a record with the name of the set.
    let twice = format!("{SCENE}{SET}{files}[[case]]\nname = \"b\"\n");
    let refused = |text: &str| {
        let file = folder.join("scene.toml");
        fs::write(&file, text).unwrap();
        let refused = FileScene::check_keys(file, &[], &Registry::default());
        refused.unwrap_err().to_string()
    };
    assert!(refused(&twice).contains("the case 'b' is defined twice"));
    let record = "[[record]]\nname = \"motions\"\nfile = \"r.txt\"\nconvention = \"outcrop\"\n";
    let both = refused(&format!("{SCENE}{record}{SET}{files}"));
    assert!(
        both.contains("the record 'motions' is defined twice"),
        "{both}"
    );
}

/// Without a case, and in a case by hand, a scene has the motion of the first case of the set, its factor behind all other processing,
/// and a remark says so; a case of the set has its own motion and no such remark.
#[test]
fn a_scene_itself_has_the_first_record() {
    let variants = Variants::new("record-set-first");
    for (name, sign) in [("a", 1.0), ("b", -1.0)] {
        let row = |(index, a): (usize, f64)| format!("{} {}", 0.01 * index as f64, sign * a);
        let rows = [0.0, 1.0, -2.0, 1.0, 0.0].into_iter().enumerate();
        let rows: Vec<String> = rows.map(row).collect();
        fs::write(variants.0.join(format!("{name}.txt")), rows.join("\n")).unwrap();
    }
    let pulse = "pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }";
    let set = "record = \"m\"\n[[record_set]]\nname = \"m\"\nfiles = [\"b.txt\", \"a.txt\"]\nunits = \"m/s2\"\npeak = 1.5\n\
               convention = \"incident\"\nscales = [4, 2]\n[[case]]\nname = \"own\"\n";
    let expected = Remark::FirstOfRecordSet(FirstOfSet {
        set: "m".into(),
        first: "b-x2".into(),
        cases: 4,
    });
    let scene = variants.read(pulse, set).unwrap();
    let read = |case| {
        FileScene::of_case(scene.spec().unwrap().file(), case, &Registry::default()).unwrap()
    };
    for (case, peak, is_said) in [
        (None, 3.0, true),
        (Some("own"), 3.0, true),
        (Some("a-x4"), -6.0, false),
        (Some("b-x4"), 6.0, false),
    ] {
        let scene = read(case);
        let history = &scene.records()["m"];
        // The third sample is the greatest.
        assert!((history.acceleration()[2] - peak).abs() < 1e-12, "{case:?}");
        let remarks = scene.remarks().iter();
        let said = remarks.filter(|remark| **remark == expected);
        assert_eq!(said.count(), usize::from(is_said), "{case:?}");
        let processed = scene
            .spec()
            .unwrap()
            .processed_records(&Registry::default())
            .unwrap();
        assert_eq!(processed["m"].acceleration(), history.acceleration());
    }
}

/// A permanent displacement at the end of a record is that before its factor.
#[test]
fn a_factor_multiplies_the_end_displacement() {
    let variants = Variants::new("record-factor");
    // An acceleration that leaves 0.4 mm behind.
    let row = |(index, a): (usize, f64)| format!("{} {a}", 0.01 * index as f64);
    let rows = [0.0, 1.0, 2.0, -2.0, -2.0, 0.0, 2.0, -1.0, 0.0];
    let rows: Vec<String> = rows.into_iter().enumerate().map(row).collect();
    fs::write(variants.0.join("r.txt"), rows.join("\n")).unwrap();
    let pulse = "pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }";
    let record = |end: f64| {
        format!(
            "record = \"r\"\n[[record]]\nname = \"r\"\nfile = \"r.txt\"\nunits = \"m/s2\"\nconvention = \"incident\"\n\
             end_displacement = {end}\nfactor = 3\n"
        )
    };
    let scene = variants.read(pulse, &record(4e-4)).unwrap();
    let end = scene.records()["r"].report().end_displacement;
    assert!((end - 1.2e-3).abs() < 1e-12, "{end}");
    assert!(variants.read(pulse, &record(1.2e-3)).is_err());
}
