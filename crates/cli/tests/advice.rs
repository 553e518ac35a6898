//! `powerhouse advise`.

use std::path::Path;
use std::process::{Command, Output};

fn advise(scene: &str, error: &str) -> Output {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data/scenes")
        .join(scene);
    Command::new(env!("CARGO_BIN_EXE_powerhouse"))
        .args([
            "advise",
            "boundary",
            &scene.display().to_string(),
            "--error",
            error,
        ])
        .output()
        .unwrap()
}

/// The advice recommends a boundary with its table and status 0, or states why none meets the permitted error with
/// status 1; an invalid error is a usage error.
#[test]
fn advice_ends_with_a_table_or_a_reason() {
    let generous = advise("cavern_small.toml", "90%");
    let printed = String::from_utf8(generous.stdout).unwrap();
    assert_eq!(generous.status.code(), Some(0), "{printed}");
    for wanted in [
        "Lined cavern under El Centro",
        "SV wave at 30.0 degrees",
        "predicted by a circular opening in plane strain",
        "recommended: ",
        "\n[boundary]\nkind = \"visco",
        "faces = [\"left\", \"right\", \"front\", \"back\", \"bottom\"]",
    ] {
        assert!(printed.contains(wanted), "{wanted}: {printed}");
    }
    let refused = advise("cavern_small.toml", "five");
    assert_eq!(refused.status.code(), Some(2));
    let message = String::from_utf8(refused.stderr).unwrap();
    assert!(message.contains("a share above 0 and up to 1"), "{message}");
}
