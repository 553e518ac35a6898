//! `powerhouse converge`: output and exit status.

use std::path::Path;
use std::process::{Command, Output};

use powerhouse_test_support::TestFolder;

fn powerhouse(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_powerhouse"));
    command.args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A convergence study prints its predicted cost, its meshes, every result with its band, and what the bands do not contain; a
/// band wider than permitted ends with status 1, finished runs are not run again, and the report has the study.
#[test]
fn converge_prints_results_with_their_bands() {
    let folder = TestFolder::new("cli-converge");
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let data = data.canonicalize().unwrap().display().to_string();
    let scene = std::fs::read_to_string(format!("{data}/scenes/cavern_small.toml")).unwrap();
    let scene = scene.replace("\"../", &format!("\"{data}/"));
    std::fs::write(folder.join("scene.toml"), scene).unwrap();
    let path = |name: &str| folder.join(name).display().to_string();
    let (scene, out) = (path("scene.toml"), path("out"));
    let converge = |more: &[&str]| {
        let fixed = ["converge", &scene, "--duration", "0.4", "--out", &out];
        powerhouse(&[&fixed, more].concat())
    };
    let done = converge(&["--error", "100%"]);
    let (printed, errors) = (text(&done.stdout), text(&done.stderr));
    assert!(
        matches!(done.status.code(), Some(0 | 1)),
        "{printed} {errors}"
    );
    for passage in [
        "all runs together take about",
        "case 1 of 2: mesh-1",
        "case 2 of 2: mesh-2",
        "peak of crown.ux: ",
        "(order assumed)",
        "note: two meshes show no order of convergence",
        "note: refined meshes keep the chords",
        "convergence.csv",
    ] {
        assert!(printed.contains(passage), "{passage}: {printed}");
    }
    let again = converge(&["--error", "0.0001%"]);
    let printed = text(&again.stdout);
    assert_eq!(again.status.code(), Some(1), "{printed}");
    assert!(printed.contains("mesh-2: finished before"), "{printed}");
    assert!(
        printed.contains("results have an error band wider than 0.0001 %"),
        "{printed}"
    );
    let report = powerhouse(&["report", &out]);
    assert_eq!(report.status.code(), Some(0), "{}", text(&report.stderr));
    let page = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(page.contains("peak of crown.ux"));
    for wrong in [
        &["--meshes", "5"][..],
        &["--finer", "a.msh", "--meshes", "2"],
    ] {
        assert_eq!(converge(wrong).status.code(), Some(2), "{wrong:?}");
    }
}
