//! A scene to begin with, changed keys, quiet runs, logs, checks of keys alone, completions and manual pages.

use std::path::Path;
use std::process::{Command, Output};

use powerhouse_test_support::TestFolder;

fn powerhouse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_powerhouse"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a command that succeeds without a word on the error stream, and returns its standard output.
fn said(folder: &Path, arguments: &[&str]) -> String {
    let done = powerhouse(folder, arguments);
    assert_eq!(
        done.status.code(),
        Some(0),
        "{arguments:?}: {}",
        text(&done.stderr)
    );
    text(&done.stdout)
}

/// From nothing to a report: a new scene has no warnings, runs, and is reported; a folder that has it is kept.
#[test]
fn a_new_scene_runs_to_a_report() {
    let folder = TestFolder::new("cli-new");
    let here = folder.join(".");
    assert!(said(&here, &["new", "my"]).contains("powerhouse run my/scene.toml"));
    let checked = said(&here, &["check", "my/scene.toml"]);
    assert!(checked.contains("no warnings"), "{checked}");
    let scene = std::fs::read_to_string(folder.join("my/scene.toml")).unwrap();
    let again = powerhouse(&here, &["new", "my"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("my/scene.toml exists and is kept"));
    assert_eq!(
        std::fs::read_to_string(folder.join("my/scene.toml")).unwrap(),
        scene
    );

    let run = said(&here, &["run", "my/scene.toml", "--out", "out"]);
    assert!(run.contains("crown.ux"), "{run}");
    said(&here, &["report", "out"]);
    let report = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    for passage in [
        "Arias intensity",
        "crown.ax: response spectrum",
        "crown.az: Fourier amplitude",
    ] {
        assert!(report.contains(passage), "{passage}");
    }

    let listed = said(&here, &["plot", "out"]);
    assert!(
        listed.contains("crown.ax") && listed.contains("m/s2"),
        "{listed}"
    );
    let drawn = said(
        &here,
        &[
            "plot",
            "out",
            "crown",
            "--of",
            "response",
            "--damping",
            "5%",
        ],
    );
    assert!(drawn.contains("plots/crown-response.svg"), "{drawn}");
    let table = std::fs::read_to_string(folder.join("out/plots/crown-response.csv")).unwrap();
    assert!(table.contains("crown.ax 5 %"), "{table}");
    let of_floor = [
        "plot",
        "out",
        "crown",
        "--of",
        "floor-spectrum",
        "--damping",
        "5%",
    ];
    let wider = ["--broaden", "15%", "--with", "out"];
    said(&here, &[&of_floor[..], &wider].concat());
    let table = std::fs::read_to_string(folder.join("out/plots/crown-floor-spectrum.csv")).unwrap();
    assert!(
        table.contains("crown.az 5 %, greatest of 2, peaks +-15 %"),
        "{table}"
    );
    let refused = powerhouse(
        &here,
        &["plot", "out", "crown.ax", "--out", "out/histories.svg"],
    );
    assert!(text(&refused.stderr).contains("among the tables of the run"));
    let refused = powerhouse(&here, &["plot", "out", "floor"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("no history 'floor'; expected one of crown.ux"));
}

/// Changed keys act as in the file and are stated in output and summary; a run from a checkpoint keeps them.
#[test]
fn keys_are_changed_for_one_run() {
    let folder = TestFolder::new("cli-set");
    let here = folder.join(".");
    said(&here, &["new", "."]);
    let changes = ["--set", "wave.incidence=35", "--duration", "0.1"];
    let run = |arguments: &[&str]| said(&here, &[&["run", "scene.toml"], arguments].concat());
    let out = run(&[&changes[..], &["--out", "set", "--threads", "1"]].concat());
    let told = "keys of the scene file that are changed here: wave.incidence=35, time.duration=0.1";
    assert!(out.contains(told), "{out}");
    let summary = std::fs::read_to_string(folder.join("set/summary.json")).unwrap();
    assert!(summary.contains("wave.incidence=35"), "{summary}");
    said(&here, &["report", "set"]);
    let report = std::fs::read_to_string(folder.join("set/report.html")).unwrap();
    assert!(report.contains(told));

    let file = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    let file = file.replace("incidence = 20", "incidence = 35");
    std::fs::write(
        folder.join("other.toml"),
        file.replace("duration = 1.0", "duration = 0.1"),
    )
    .unwrap();
    said(&here, &["run", "other.toml", "--out", "file"]);
    let table = |out: &str| std::fs::read(folder.join(out).join("histories.csv")).unwrap();
    assert_eq!(table("set"), table("file"));
    assert_ne!(table("set"), {
        run(&["--duration", "0.1", "--out", "own"]);
        table("own")
    });

    for (set, wanted) in [
        ("wave.incidences=3", "incidences"),
        (
            "part.cavern.kernel=hex8-eas",
            "expected one of rock, lining",
        ),
    ] {
        let refused = powerhouse(&here, &["run", "scene.toml", "--set", set]);
        assert_eq!(refused.status.code(), Some(2), "{set}");
        assert!(
            text(&refused.stderr).contains(wanted),
            "{}",
            text(&refused.stderr)
        );
    }
    let broken = powerhouse(&here, &["run", "scene.toml", "--set", "duration"]);
    assert!(text(&broken.stderr).contains("expected KEY=VALUE"));
}

/// A quiet run says warnings alone, on the error stream, and its log has what another one prints.
#[test]
fn quiet_runs_keep_warnings_and_logs() {
    let folder = TestFolder::new("cli-quiet");
    let here = folder.join(".");
    said(&here, &["new", "."]);
    let quick = ["run", "scene.toml", "--out", "out"];
    let loud = said(&here, &quick);
    let quiet = powerhouse(
        &here,
        &[&quick[..], &["--quiet", "--log", "run.log"]].concat(),
    );
    assert_eq!(quiet.status.code(), Some(0));
    assert_eq!(
        (text(&quiet.stdout), text(&quiet.stderr)),
        (String::new(), String::new())
    );
    let log = std::fs::read_to_string(folder.join("run.log")).unwrap();
    let first = |text: &str| text.lines().next().map(String::from);
    assert_eq!(first(&log), first(&loud));
    assert!(log.lines().count() > 10 && log.contains("crown"), "{log}");

    // A wave across rollers with motion along them.
    let warned = powerhouse(
        &here,
        &[&quick[..], &["--quiet", "--set", "wave.azimuth=90"]].concat(),
    );
    assert_eq!(text(&warned.stdout), "");
    assert!(
        text(&warned.stderr).starts_with("warning: "),
        "{}",
        text(&warned.stderr)
    );
    for file in ["scene.toml", "tunnel.msh"] {
        let before = std::fs::read(folder.join(file)).unwrap();
        let refused = powerhouse(&here, &[&quick[..], &["--log", file]].concat());
        assert_eq!(refused.status.code(), Some(2));
        assert!(text(&refused.stderr).contains("exists and is kept"));
        assert_eq!(std::fs::read(folder.join(file)).unwrap(), before);
    }
    // The results have a copy of the scene, which is not to take its place.
    let refused = powerhouse(
        &here,
        &["run", "scene.toml", "--duration", "0.02", "--out", "."],
    );
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("would take the place of scene.toml"));
    assert!(!folder.join("summary.json").exists());
    let refused = powerhouse(&here, &[&quick[..], &["--log", "missing/run.log"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("cannot write the log missing/run.log"));
}

/// Keys are checked without mesh and records; meshes are described without a scene.
#[test]
fn keys_and_meshes_are_checked_alone() {
    let folder = TestFolder::new("cli-keys");
    let here = folder.join(".");
    said(&here, &["new", "."]);
    let looked = said(&here, &["look", "tunnel.msh", "--picture", "mesh.png"]);
    for passage in [
        "lining",
        "hex8",
        "in the plane z = -90",
        "least scaled Jacobian",
    ] {
        assert!(looked.contains(passage), "{looked}");
    }
    assert!(folder.join("mesh.png").is_file());
    let packed = said(&here, &["pack", "tunnel.msh"]);
    assert!(packed.contains("tunnel.phm: "), "{packed}");
    let description = |text: &str| text.split_once('\n').map(|(_, rest)| rest.to_owned());
    let of_text = said(&here, &["look", "tunnel.msh"]);
    assert_eq!(
        description(&said(&here, &["look", "tunnel.phm"])),
        description(&of_text)
    );
    let refused = powerhouse(&here, &["pack", "tunnel.msh", "--out", "mesh.bin"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("mesh.bin: a packed mesh has the extension .phm"));
    std::fs::remove_file(folder.join("tunnel.msh")).unwrap();
    let checked = said(&here, &["check", "--keys", "scene.toml"]);
    assert!(
        checked.contains("each value is of the right form"),
        "{checked}"
    );
    let wrong = powerhouse(
        &here,
        &["check", "--keys", "scene.toml", "--set", "time.durations=3"],
    );
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("durations"));
    let missing = powerhouse(&here, &["look", "tunnel.msh"]);
    assert_eq!(missing.status.code(), Some(2));
}

/// Completions and manual pages know the commands.
#[test]
fn shells_and_manuals_know_the_commands() {
    let folder = TestFolder::new("cli-manual");
    let here = folder.join(".");
    let script = said(&here, &["completions", "bash"]);
    assert!(script.contains("--checkpoint-every") && script.contains("converge"));
    said(&here, &["man", "pages"]);
    let page = std::fs::read_to_string(folder.join("pages/powerhouse-run.1")).unwrap();
    assert!(page.contains("resume"), "{page}");
}
