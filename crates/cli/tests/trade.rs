//! `powerhouse trade`: output and exit status.

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

/// A folder with the coarse cavern in it.
struct Folder(TestFolder);

impl Folder {
    fn new() -> Self {
        let folder = TestFolder::new("cli-trade");
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        let data = data.canonicalize().unwrap().display().to_string();
        let scene = std::fs::read_to_string(format!("{data}/scenes/cavern_small.toml")).unwrap();
        let scene = scene.replace("\"../", &format!("\"{data}/"));
        std::fs::write(folder.join("scene.toml"), scene).unwrap();
        Self(folder)
    }
    fn path(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }
}

/// A trade study prints its factors and its predicted cost, prints the Pareto front and writes a valid scene of the chosen
/// run; nothing is run twice; a goal that no run meets ends with status 1, an invalid goal with status 2.
#[test]
fn trade_writes_the_scene_that_meets_a_goal() {
    let folder = Folder::new();
    let (scene, out) = (folder.path("scene.toml"), folder.path("out"));
    let trade = |goal: &[&str]| {
        let fixed = ["trade", &scene, "--window", "0.15", "--out", &out];
        powerhouse(&[&fixed, goal].concat())
    };
    let done = trade(&["--budget", "100h"]);
    let (printed, errors) = (text(&done.stdout), text(&done.stderr));
    assert_eq!(done.status.code(), Some(0), "{printed} {errors}");
    for passage in [
        "kernel: hex8-eas | hex8-full and hex8-one-point | hex8-natural | hex8-one-point",
        "precision: f64 | mixed | f32",
        "runs of 0.15 s",
        "run 1: reference",
        "Pareto front, the cheapest first",
        "chosen: reference",
        "trade.svg",
    ] {
        assert!(printed.contains(passage), "{passage}: {printed}");
    }
    let chosen = folder.path("scene_trade.toml");
    let written = std::fs::read_to_string(&chosen).unwrap();
    assert!(written.starts_with("# scene.toml: reference."), "{written}");
    assert!(written.contains("kernel = \"hex8-eas\"") && written.contains("safety = 0.5"));
    assert!(Path::new(&out).join("trade.csv").is_file());

    let again = trade(&["--error", "1e-9"]);
    assert_eq!(again.status.code(), Some(1), "{}", text(&again.stderr));
    let printed = text(&again.stdout);
    assert!(printed.contains("finished before") && printed.contains("no run meets the goal"));
    assert_eq!(trade(&["--error", "-2%"]).status.code(), Some(2));
}
