//! How much a code takes along with one crate.

use std::collections::BTreeSet;
use std::process::Command;

use serde_json::Value;

use super::manifests::workspace;

/// Output of cargo in the workspace.
fn cargo(arguments: &[&str]) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let ran = Command::new(cargo)
        .current_dir(workspace())
        .args(arguments)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{errors}");
    String::from_utf8(ran.stdout).unwrap()
}

/// Crates that a package pulls in by default, itself and what builds it included, by `cargo tree`.
fn crates_of(package: &str) -> BTreeSet<String> {
    let text = cargo(&[
        "tree",
        "--locked",
        "--offline",
        "--edges",
        "normal,build",
        "--prefix",
        "none",
        "--format",
        "{p}",
        "--package",
        package,
    ]);
    // `name v1.2.3 (where from)`: two versions of one crate are two.
    let names = text.lines().filter(|line| !line.is_empty());
    names
        .map(|line| line.split(" (").next().unwrap_or(line).to_owned())
        .collect()
}

/// A code that wants the constitutive laws, or the wave field, alone compiles no more than 30 crates.
#[test]
fn one_crate_pulls_in_few() {
    for package in ["powerhouse-material-damage", "powerhouse-wavefield"] {
        let crates = crates_of(package);
        assert!(
            crates.iter().any(|name| name.starts_with("nalgebra ")),
            "{crates:?}"
        );
        assert!(
            crates.len() <= 30,
            "{package} takes {}: {crates:?}",
            crates.len()
        );
    }
}

/// Numbers of a version such as `1.92`, of three.
fn version(text: &str) -> [u32; 3] {
    let mut numbers = text.split('.').map(|number| number.parse().unwrap());
    [(); 3].map(|()| numbers.next().unwrap_or(0))
}

/// No dependency requires a newer compiler than the one that the workspace states as its oldest.
#[test]
fn the_oldest_compiler_compiles_the_dependencies() {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let about = Command::new(rustc).arg("-vV").output().unwrap().stdout;
    let about = String::from_utf8(about).unwrap();
    let host = about.lines().find_map(|line| line.strip_prefix("host: "));
    let text = cargo(&[
        "metadata",
        "--locked",
        "--offline",
        "--format-version",
        "1",
        "--filter-platform",
        host.unwrap(),
    ]);
    let metadata: Value = serde_json::from_str(&text).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let stated = |package: &Value| package["rust_version"].as_str().map(version);
    let own = packages
        .iter()
        .find(|package| package["name"] == "powerhouse");
    let oldest = stated(own.unwrap()).unwrap();
    let newer: Vec<&str> = packages
        .iter()
        .filter(|package| stated(package).is_some_and(|needed| needed > oldest))
        .map(|package| package["name"].as_str().unwrap())
        .collect();
    assert!(newer.is_empty(), "{newer:?} need more than {oldest:?}");
    let stating = packages.iter().filter(|package| stated(package).is_some());
    assert!(stating.count() > packages.len() / 2);
}
