//! Keys under their former names.

use std::sync::Arc;

use powerhouse::boundary::Viscous;
use powerhouse::model::AbsorbingBoundary;
use powerhouse::{FileScene, Problem, Registry, Remark, RenderFault as _, Scene, remark};

use super::nonsense::fault;
use super::support::*;

/// The keys of the scene's remarks about former names.
fn remarks(scene: &Scene) -> Vec<(&'static str, [&'static str; 2])> {
    let remarks = scene.remarks().iter();
    let found = remarks.filter_map(|remark| match remark {
        Remark::FormerKey(remark::FormerKey {
            table,
            former,
            present,
        }) => {
            assert!(!remark.is_warning());
            Some((*table, [*former, *present]))
        }
        _ => None,
    });
    found.collect()
}

/// Table, line of the scene after which a key is written, the key with its value, and both of its names.
const KEYS: [(&str, &str, &str, [&str; 2]); 6] = [
    (
        "part",
        "kernel = \"hex8-full\"",
        "{} = 60",
        ["rim", "elastic_rim"],
    ),
    (
        "output.history",
        "at = [150, 150, 0]",
        "{} = \"rock\"",
        ["among", "in_set"],
    ),
    (
        "output.section",
        "every = 0.01",
        "section = [{ name = \"cut\", set = \"rock\", at = [150, 150, -150], normal = [0, 0, 1], along = [1, 0, 0], {} = 1000 }]",
        ["reach", "half_extent"],
    ),
    (
        "boundary",
        "kind = \"viscous-spring\"",
        "{} = 0.5",
        ["a", "amplitude_ratio"],
    ),
    (
        "boundary",
        "kind = \"viscous-spring\"",
        "{} = \"paper\"",
        ["b", "speed_ratio"],
    ),
    (
        "boundary",
        "kind = \"viscous-spring\"",
        "x = { {} = 1.1 }",
        ["b", "speed_ratio"],
    ),
];

/// A former name is read as the present one, with a remark, and has the motion of the present one to the last bit.
#[test]
fn former_names_are_read() {
    let variants = Variants::new("former");
    for (table, old, keys, names) in KEYS {
        let read = |name: &str| {
            let keys = keys.replacen("{}", name, 1);
            variants.read(old, &format!("{old}\n{keys}")).unwrap()
        };
        let [former, present] = names.map(read);
        assert_eq!(remarks(&former), [(table, names)], "{keys}");
        assert_eq!(remarks(&present), [], "{keys}");
        let [former, present] = [former, present].map(run);
        assert_eq!(former.histories(), present.histories(), "{keys}");
        assert_eq!(former.sections(), present.sections(), "{keys}");
        if table == "boundary" {
            assert_ne!(former.histories(), run(cube_scene()).histories(), "{keys}");
        }
    }
}

/// A key under both names is an error at the former one; a value out of range is one at its place.
#[test]
fn a_key_has_one_name() {
    let variants = Variants::new("former-twice");
    for (_, old, keys, [former, present]) in KEYS {
        let (before, value) = keys.split_once("{}").unwrap();
        // The second key follows the first in a table in braces, otherwise on the next line.
        let both = match value.trim_end_matches([' ', '}', ']']) {
            inner if inner.len() < value.len() => {
                format!("{before}{former}{inner}, {present}{value}")
            }
            _ => format!("{former}{value}\n{present}{value}"),
        };
        let fault = fault(&variants, old, &format!("{old}\n{both}"));
        let twice = matches!(fault.problem(), Problem::OneOf { keys, found: 2 } if **keys == [former, present]);
        assert!(twice, "{both}: {fault}");
    }
    let wrong = fault(
        &variants,
        "kind = \"viscous-spring\"",
        "kind = \"viscous-spring\"\na = -1",
    );
    assert!(
        wrong.render(false).contains("| a = -1"),
        "{}",
        wrong.render(false)
    );
}

/// Stages and cases may have former names too.
#[test]
fn stages_and_cases_have_former_names() {
    let variants = Variants::new("former-cases");
    let cases = "[[case]]\nname = \"soft\"\nboundary = { a = 0.5 }\npart = [{ set = \"rock\", rim = 60 }]\n[time]";
    let text = CUBE.replacen("[time]", cases, 1);
    let path = variants.0.join("cube.toml");
    let scene = FileScene::from_toml(&text, &path, &Registry::default()).unwrap();
    let found = [
        ("part", ["rim", "elastic_rim"]),
        ("boundary", ["a", "amplitude_ratio"]),
    ];
    assert_eq!(remarks(&scene), found);
    std::fs::write(&path, &text).unwrap();
    let case = FileScene::case_from_file_with(&path, "soft", &Registry::default()).unwrap();
    assert_eq!(case.parts()[0].rim, Some(60.0));
    let stage = "[[stage]]\nname = \"grout\"\nbonded = [\"seam\"]\n[time]";
    let fault = fault(&variants, "[time]", stage).to_string();
    assert!(fault.contains("'seam'"), "{fault}");
}

/// Keys of the boundary of the test.
#[derive(serde::Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
struct OwnKeys {
    a: f64,
}

/// A boundary of a program's own keeps keys of such names.
#[test]
fn other_boundaries_keep_their_keys() {
    let variants = Variants::new("former-own");
    let mut registry = Registry::default();
    registry.add_boundary("own", |keys: OwnKeys| {
        assert_eq!(keys.a, 3.0);
        Ok(Arc::new(Viscous::default()) as Arc<dyn AbsorbingBoundary>)
    });
    let text = CUBE.replacen("kind = \"viscous-spring\"", "kind = \"own\"\na = 3.0", 1);
    let scene = FileScene::from_toml(text, variants.0.join("cube.toml"), &registry).unwrap();
    assert_eq!(remarks(&scene), []);
}
