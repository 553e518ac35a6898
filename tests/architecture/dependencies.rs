//! How much a code takes along with one crate.

use std::collections::BTreeSet;
use std::process::Command;

use crate::manifests::workspace;

/// Crates that a package pulls in by default, itself and what builds it included, by `cargo tree`.
fn crates_of(package: &str) -> BTreeSet<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let listed = Command::new(cargo)
        .current_dir(workspace())
        .args(["tree", "--locked", "--offline"])
        .args(["--edges", "normal,build", "--prefix", "none"])
        .args(["--format", "{p}", "--package", package])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&listed.stderr);
    assert!(listed.status.success(), "{errors}");
    let text = String::from_utf8(listed.stdout).unwrap();
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
