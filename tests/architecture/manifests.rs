//! Who may depend on whom.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::sources::rust_files;

/// The workspace's own directory.
pub(crate) fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The engine that scenes choose.
const ENGINE: &str = "powerhouse-explicit-core";

/// The crate of programs, which the elements use to record theirs.
const PROGRAM: &str = "powerhouse-program";

/// The crate of graphics processors, which compiles programs.
const DEVICE: &str = "powerhouse-device";

/// The crate of materials, in which laws are compiled for elements.
const LAWS: &str = "powerhouse-laws";

/// The crates of scenes, of their files, and of the files of results: what the facade composes.
const SCENE: &str = "powerhouse-scene";
const RESULTS: &str = "powerhouse-results";
const SCENE_FILE: &str = "powerhouse-scene-file";

/// The crate of accelerograms.
const RECORDS: &str = "powerhouse-records";

/// The crate of reports, above the studies.
const REPORT: &str = "powerhouse-report";

/// The crates around the model; none knows another, but elements record programs, a device compiles them, and records
/// are read as other files are.
const AROUND_MODEL: [&str; 12] = [
    ENGINE,
    PROGRAM,
    "powerhouse-elements",
    "powerhouse-observe",
    "powerhouse-wavefield",
    "powerhouse-boundary",
    "powerhouse-contact",
    "powerhouse-material-damage",
    "powerhouse-io",
    RECORDS,
    "powerhouse-mpi",
    DEVICE,
];

/// The packages that are not published, and that no library depends on.
const SHELVES: [&str; 3] = [
    "powerhouse-examples",
    "powerhouse-tests",
    "powerhouse-benches",
];

/// Crates around the model that tests of another one may use besides: an engine is tested with elements, joints and
/// observers, observers with elements, programs of elements with laws, programs of laws, and a device with all that it takes over.
fn permitted_in_tests(package: &str) -> &'static [&'static str] {
    match package {
        "powerhouse-explicit-core" => &[
            "powerhouse-boundary",
            "powerhouse-contact",
            "powerhouse-elements",
            "powerhouse-material-damage",
            "powerhouse-observe",
            "powerhouse-wavefield",
        ],
        "powerhouse-observe" => &["powerhouse-elements"],
        DEVICE => &[ENGINE, "powerhouse-elements", "powerhouse-material-damage"],
        "powerhouse-elements" => &["powerhouse-material-damage"],
        "powerhouse-material-damage" => &[PROGRAM],
        "powerhouse-study" => &[REPORT],
        _ => &[],
    }
}

/// The package of what tests share: not published, and a dependency of tests alone.
const TEST_SUPPORT: &str = "powerhouse-test-support";

/// Packages of the workspace that a package may depend on, in every kind of dependency.
fn permitted(package: &str) -> Vec<&'static str> {
    let model = "powerhouse-model";
    match package {
        "powerhouse-model" | TEST_SUPPORT => vec![],
        "powerhouse" => [
            &[model, LAWS, SCENE, RESULTS, SCENE_FILE][..],
            &AROUND_MODEL,
        ]
        .concat(),
        SCENE => [&[model, LAWS][..], &AROUND_MODEL].concat(),
        RESULTS | SCENE_FILE => [&[model, LAWS, SCENE][..], &AROUND_MODEL].concat(),
        LAWS => vec![model, "powerhouse-elements", "powerhouse-material-damage"],
        "powerhouse-study" => vec!["powerhouse"],
        REPORT => vec!["powerhouse", "powerhouse-study"],
        "powerhouse-wang-2019" => vec!["powerhouse", "powerhouse-study", REPORT],
        "powerhouse-cli" => vec![
            "powerhouse",
            "powerhouse-study",
            REPORT,
            "powerhouse-wang-2019",
        ],
        "powerhouse-elements" | DEVICE => vec![model, PROGRAM],
        // Records are files, read whole as all others are.
        RECORDS => vec!["powerhouse-io"],
        around if AROUND_MODEL.contains(&around) => vec![model],
        shelf if SHELVES.contains(&shelf) => {
            let mut below = [
                &[
                    "powerhouse",
                    "powerhouse-study",
                    REPORT,
                    "powerhouse-wang-2019",
                    model,
                ][..],
                &AROUND_MODEL,
            ]
            .concat();
            // They take the engine from the facade, which chooses it.
            below.retain(|name| *name != ENGINE);
            if shelf == "powerhouse-benches" {
                // The problems that the examples solve are those whose cost is measured.
                below.push("powerhouse-examples");
            }
            below
        }
        other => panic!("the package '{other}' has no place in the star yet"),
    }
}

/// What a package may take from the registry at run time, where that is to stay little; by feature
/// alone where a dependency is optional.
fn permitted_from_registry(package: &str) -> Option<&'static [&'static str]> {
    match package {
        "powerhouse-model" => Some(&["nalgebra", "thiserror", "serde", "postcard"]),
        "powerhouse-boundary" | "powerhouse-material-damage" => Some(&["nalgebra", "thiserror"]),
        "powerhouse-contact" => Some(&["nalgebra", "thiserror", "rayon", "pulp", "serde"]),
        "powerhouse-wavefield" => Some(&["nalgebra", "thiserror", "realfft"]),
        "powerhouse-observe" => Some(&["thiserror", "serde"]),
        PROGRAM => Some(&[]),
        "powerhouse-elements" => Some(&["pulp", "serde"]),
        "powerhouse-mpi" => Some(&["thiserror", "mpi"]),
        DEVICE => Some(&["bytemuck", "libloading", "cudarc"]),
        "powerhouse-explicit-core" => {
            Some(&["nalgebra", "thiserror", "rayon", "pulp", "faer", "serde"])
        }
        _ => None,
    }
}

fn read(path: &Path) -> Table {
    let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    text.parse()
        .unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Name and manifest of every package of the workspace.
pub(crate) fn packages() -> Vec<(String, Table)> {
    let mut directories: Vec<PathBuf> = fs::read_dir(workspace().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    for shelf in ["examples", "tests", "benches"] {
        directories.push(workspace().join(shelf));
    }
    directories.sort();
    directories
        .iter()
        .map(|directory| directory.join("Cargo.toml"))
        .filter(|manifest| manifest.exists())
        .map(|manifest| {
            let table = read(&manifest);
            let name = table["package"]["name"].as_str().unwrap().to_owned();
            (name, table)
        })
        .collect()
}

/// Names of the dependencies in the given tables of a manifest, target-specific ones included.
fn dependencies(manifest: &Table, kinds: &[&str]) -> BTreeSet<String> {
    let targets = manifest.get("target").and_then(Value::as_table);
    let by_target = targets.into_iter().flat_map(Table::values);
    let tables = by_target.filter_map(Value::as_table);
    std::iter::once(manifest)
        .chain(tables)
        .flat_map(|table| kinds.iter().filter_map(|kind| table.get(*kind)))
        .filter_map(Value::as_table)
        .flat_map(Table::iter)
        .map(|(key, value)| {
            let renamed = value.get("package").and_then(Value::as_str);
            renamed.unwrap_or(key).to_owned()
        })
        .collect()
}

const ALL_KINDS: [&str; 3] = ["dependencies", "dev-dependencies", "build-dependencies"];

/// The workspace is a star: each package depends on the packages below it and on no others, and
/// those around the model never on each other, but for tests.
#[test]
fn dependencies_form_a_star() {
    for (package, manifest) in packages() {
        let permitted = permitted(&package);
        let in_tests = permitted_in_tests(&package);
        let compiled = dependencies(&manifest, &["dependencies", "build-dependencies"]);
        assert!(!compiled.contains(TEST_SUPPORT), "{package}");
        for kind in ALL_KINDS {
            for dependency in dependencies(&manifest, &[kind]) {
                let name = dependency.as_str();
                let own = name.starts_with("powerhouse") && name != TEST_SUPPORT;
                let of_tests = kind == "dev-dependencies" && in_tests.contains(&name);
                assert!(
                    !own || of_tests || permitted.contains(&name),
                    "{package} depends on {name}; it may depend on {permitted:?}"
                );
            }
        }
    }
}

/// What parameters are read and documented with where they are keys of scene files: in the feature `keys` alone, which is off
/// by default.
const OF_KEYS: [&str; 2] = ["serde", "schemars"];

/// Whether a dependency is one of the feature `keys`, and of no other.
fn is_of_keys(manifest: &Table, dependency: &str) -> bool {
    let named = format!("dep:{dependency}");
    let takes = |list: &Value| {
        list.as_array()
            .is_some_and(|all| all.contains(&named.as_str().into()))
    };
    let features = manifest.get("features").and_then(Value::as_table);
    let mut features = features.into_iter().flat_map(Table::iter);
    let is_optional = manifest["dependencies"][dependency].get("optional");
    OF_KEYS.contains(&dependency)
        && is_optional.and_then(Value::as_bool) == Some(true)
        && features.all(|(name, list)| (name == "keys") == takes(list))
}

/// A code that wants one crate pays for one: the small crates take little from the registry.
#[test]
fn small_crates_stay_small() {
    for (package, manifest) in packages() {
        let Some(permitted) = permitted_from_registry(&package) else {
            continue;
        };
        for dependency in dependencies(&manifest, &["dependencies", "build-dependencies"]) {
            assert!(
                dependency.starts_with("powerhouse")
                    || permitted.contains(&dependency.as_str())
                    || is_of_keys(&manifest, &dependency),
                "{package} takes {dependency} from the registry; it may take {permitted:?}"
            );
        }
    }
}

/// Every package obeys the workspace's lints, which deny undocumented public items and unsafe
/// code.
#[test]
fn lints_hold_everywhere() {
    let root = read(&workspace().join("Cargo.toml"));
    let lints = &root["workspace"]["lints"]["rust"];
    assert_eq!(lints["missing_docs"].as_str(), Some("deny"));
    assert_eq!(lints["unsafe_code"].as_str(), Some("deny"));
    for (package, manifest) in packages() {
        let inherits = manifest
            .get("lints")
            .and_then(|lints| lints.get("workspace"))
            .and_then(Value::as_bool);
        assert_eq!(inherits, Some(true), "{package} does not inherit the lints");
    }
}

/// Libraries have no bench harness (or criterion's flags fail), shelves are not published, what is published says where its
/// documentation is, and everything carries the workspace's licence.
#[test]
fn packages_are_set_up_alike() {
    for (package, manifest) in packages() {
        let licence = &manifest["package"]["license"]["workspace"];
        assert_eq!(licence.as_bool(), Some(true), "{package}");
        let published = manifest["package"].get("publish").and_then(Value::as_bool);
        assert_eq!(
            published == Some(false),
            SHELVES.contains(&package.as_str()) || package == TEST_SUPPORT,
            "{package}"
        );
        let documentation = manifest["package"].get("documentation");
        let expected = format!("https://docs.rs/{package}");
        assert_eq!(
            documentation.and_then(Value::as_str),
            (published != Some(false)).then_some(expected.as_str()),
            "{package}"
        );
        if !SHELVES.contains(&package.as_str()) && package != "powerhouse-cli" {
            let bench = manifest["lib"].get("bench").and_then(Value::as_bool);
            assert_eq!(bench, Some(false), "{package}");
        }
    }
}

/// A package with tests has them in one program: each program is linked with all that it tests.
#[test]
fn packages_have_one_program_of_tests() {
    let mut count = 0;
    for (package, manifest) in packages() {
        let programs = manifest.get("test").and_then(Value::as_array);
        let programs = programs.map_or(0, Vec::len);
        let found = manifest["package"]
            .get("autotests")
            .and_then(Value::as_bool);
        assert!(programs < 2, "{package}");
        assert_eq!(found == Some(false), programs == 1, "{package}");
        count += programs;
    }
    assert!(count > 12, "{count}");
}

/// One file chooses the engine, and the facade re-exports it: no other one outside the engine's crate names it, but tests and examples of
/// devices.
#[test]
fn one_file_chooses_the_engine() {
    let name = ENGINE.replace('-', "_");
    let own = Path::new("crates").join("explicit-core");
    let of_devices = ["crates/device/tests", "crates/device/examples"];
    let naming: Vec<PathBuf> = rust_files()
        .into_iter()
        .filter(|(_, text)| text.contains(&name))
        .map(|(path, _)| path.strip_prefix(workspace()).unwrap().to_path_buf())
        .filter(|path| {
            !path.starts_with(&own) && !of_devices.iter().any(|folder| path.starts_with(folder))
        })
        .collect();
    let [facade, chooser] =
        ["powerhouse", "scene"].map(|name| format!("crates/{name}/src/engine.rs"));
    assert_eq!(naming, [Path::new(&facade), Path::new(&chooser)]);
}

/// A library whose sources have tests runs them, and one whose sources have none does not link a program for them.
#[test]
fn tests_in_libraries_are_run() {
    let files = rust_files();
    let mut libraries = 0;
    for entry in fs::read_dir(workspace().join("crates")).unwrap() {
        let directory = entry.unwrap().path();
        let manifest = read(&directory.join("Cargo.toml"));
        let Some(library) = manifest.get("lib") else {
            continue;
        };
        libraries += 1;
        let runs = library.get("test").and_then(Value::as_bool) != Some(false);
        let sources = directory.join("src");
        let has_tests = files.iter().any(|(path, text)| {
            path.starts_with(&sources) && text.lines().any(|line| line.trim() == "#[test]")
        });
        assert_eq!(runs, has_tests, "{}", directory.display());
    }
    assert!(libraries > 15, "{libraries}");
}
