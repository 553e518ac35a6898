//! Result folders: one run at a time, tested before the first step, losses reported.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::block::{self, Block, text};

/// A block that runs until it is interrupted, with snapshots.
fn long(name: &str) -> Block {
    Block::new(name, |scene| {
        scene
            .replace("duration = 0.3", "duration = 1000")
            .replace("every = 0.1", "every = 0.02")
            .replace("every = 0.01", "every = 0.1")
    })
}

/// Starts the run of a block and waits for its first snapshots.
fn start(block: &Block) -> std::process::Child {
    let run = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
        .args(["run", &block.scene(), "--out", &block.out_text()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !block.out().join("snapshots/snapshots_00002.vtu").exists() {
        assert!(begun.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(5));
    }
    run
}

/// A second run into the folder of a running one is an error before its first step, which names it; the first run is not
/// disturbed. A killed run does not prevent another, which names it. Status 2 and 0.
#[cfg(unix)]
#[test]
fn a_folder_has_one_run() {
    let block = long("one-run");
    let first = start(&block);
    let other = Block::new("other", |scene| scene);
    let run = |block: &Block, out: &str| block.powerhouse(&["run", &block.scene(), "--out", out]);
    let refused = run(&other, &block.out_text());
    let errors = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    let holder = format!("another run (process {}, since 20", first.id());
    assert!(errors.contains(&holder), "{errors}");
    block::signal(&first, "-KILL");
    first.wait_with_output().unwrap();
    let left = std::fs::read_to_string(block.out().join("summary.json")).unwrap();
    assert!(left.contains("\"ended\": \"incomplete\""), "{left}");
    let taken = run(&other, &block.out_text());
    let printed = text(&taken.stdout);
    assert_eq!(taken.status.code(), Some(0), "{}", text(&taken.stderr));
    assert!(
        printed.contains("taken over from a run that ended without finishing (process"),
        "{printed}"
    );
    assert!(!block.out().join(".powerhouse-lock").exists());
}

/// A folder that is removed during a run is an error, status 2, that states what may be missing; the remaining results are
/// written there anew, and the collection of snapshots lists the existing ones.
#[cfg(unix)]
#[test]
fn a_folder_that_vanishes_is_an_error() {
    let block = long("vanishes");
    let mut run = start(&block);
    // At once, while the run goes on writing.
    std::fs::rename(block.out(), block.folder.join("elsewhere")).unwrap();
    let begun = Instant::now();
    // The collection may be written anew before the next snapshot.
    let lists_one = || {
        let collection = std::fs::read_to_string(block.out().join("snapshots.pvd"));
        let collection = collection.unwrap_or_default();
        let mut names = collection
            .split("file=\"")
            .skip(1)
            .filter_map(|rest| rest.split('"').next());
        names.any(|name| block.out().join(name).exists())
    };
    // A folder that vanishes while a snapshot is written ends the run at once.
    let mut ended_itself = false;
    while !ended_itself && !lists_one() {
        ended_itself = run.try_wait().unwrap().is_some();
        assert!(begun.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(5));
    }
    if !ended_itself {
        block::signal(&run, "-INT");
    }
    let ended = run.wait_with_output().unwrap();
    let errors = text(&ended.stderr);
    assert_eq!(ended.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("was removed while the run went on"),
        "{errors}"
    );
    for file in ["summary.json", "histories.csv", "plots/inside.svg"] {
        assert!(block.out().join(file).exists(), "{file}");
    }
    let collection = std::fs::read_to_string(block.out().join("snapshots.pvd")).unwrap();
    let shots: Vec<&str> = collection.split("file=\"").skip(1).collect();
    assert!(ended_itself || !shots.is_empty());
    for shot in shots {
        let name = shot.split('"').next().unwrap();
        assert!(block.out().join(name).exists(), "{name}");
    }
}

/// Everything that the end of a run needs is tested before its first step: a folder with the name of a file, a path that is
/// too long for the system, and files without space on the disk are errors at once, status 2, and leave no files.
#[test]
fn writing_is_tested_before_the_first_step() {
    let block = Block::new("tried", |scene| scene);
    let refused = |block: &Block, wanted: &str| {
        let ended = block.powerhouse(&["run", &block.scene(), "--out", &block.out_text()]);
        let (printed, errors) = (text(&ended.stdout), text(&ended.stderr));
        assert_eq!(ended.status.code(), Some(2), "{errors}");
        assert!(errors.contains(wanted), "{errors}");
        assert!(!printed.contains("completed"), "{printed}");
    };
    std::fs::create_dir_all(block.out().join("histories.csv")).unwrap();
    refused(
        &block,
        "there is a folder of this name, which a result file needs",
    );
    std::fs::remove_dir(block.out().join("histories.csv")).unwrap();
    // As much as it may be before the ending of a plot.
    let name = "x".repeat(252);
    let long = Block::new("long", |scene| scene.replace("inside", &name));
    let ended = long.powerhouse(&["run", &long.scene(), "--out", &long.out_text()]);
    assert_eq!(ended.status.code(), Some(2));
    assert!(
        !text(&ended.stdout).contains("completed"),
        "{}",
        text(&ended.stdout)
    );
    // A snapshot of every step of a year.
    let large = Block::new("large", |scene| {
        scene
            .replace("duration = 0.3", "duration = 3e7")
            .replace("every = 0.01", "every = 1e3")
            .replace("every = 0.1", "every = 1e-5")
            .replace("title", "allow = [\"magnitudes\"]\ntitle")
    });
    refused(&large, "GB are free");
    for block in [block, large] {
        assert_eq!(std::fs::read_dir(block.out()).unwrap().count(), 0);
    }
}

/// All warnings of a run are in its summary and in its report; the summary states that the run is completed when all its
/// files exist, and a report with missing files warns, status 1.
#[test]
fn warnings_and_files_are_in_summary_and_report() {
    let block = Block::new("printed", |scene| {
        // A side that is forgotten, and a fast pulse on a coarse mesh.
        scene
            .replace("\"left\", \"right\", ", "\"left\", ")
            .replace("duration = 0.25 }", "duration = 0.04 }")
    });
    let ended = block.powerhouse(&["run", &block.scene(), "--out", &block.out_text()]);
    let printed = text(&ended.stdout);
    assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
    let warned: Vec<&str> = printed
        .lines()
        .filter_map(|line| line.strip_prefix("warning: "))
        .collect();
    assert!(warned.len() >= 2, "{printed}");
    let read = |file: &str| std::fs::read_to_string(block.out().join(file)).unwrap();
    let summary = read("summary.json");
    let report = block.powerhouse(&["report", &block.out_text()]);
    assert_eq!(report.status.code(), Some(0), "{}", text(&report.stdout));
    let page = read("report.html");
    let escaped = |text: &str| {
        text.replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('>', "&gt;")
            .replace('"', "&quot;")
    };
    for warning in warned {
        let quoted = warning.replace('\\', "\\\\").replace('"', "\\\"");
        assert!(summary.contains(&quoted), "{warning}\n{summary}");
        assert!(page.contains(&escaped(warning)), "{warning}");
    }
    assert!(summary.contains("\"ended\": \"completed\""));
    assert!(summary.contains("\"histories.csv\"") && summary.contains("\"plots/inside.svg\""));
    std::fs::remove_file(block.out().join("histories.csv")).unwrap();
    let report = block.powerhouse(&["report", &block.out_text()]);
    assert_eq!(report.status.code(), Some(1));
    assert!(text(&report.stdout).contains("warning: histories.csv is gone"));
    assert!(read("report.html").contains("histories.csv is gone"));
}

/// A peak of rounding errors is printed as zero beside the others, and marked in the summary.
#[test]
fn rounding_is_no_peak() {
    let block = Block::new("rounding", |scene| scene);
    let ended = block.powerhouse(&["run", &block.scene(), "--out", &block.out_text()]);
    let printed = text(&ended.stdout);
    let line = |name: &str| {
        let mut lines = printed.lines();
        lines
            .find(|line| line.starts_with(name))
            .unwrap_or_else(|| panic!("{printed}"))
    };
    // The wave travels along x: y does not move.
    assert!(
        line("inside.uy").contains(" 0 m      below rounding"),
        "{printed}"
    );
    assert!(!line("inside.ux").contains("below rounding"));
    let summary = std::fs::read_to_string(block.out().join("summary.json")).unwrap();
    // Its displacement, its acceleration and the instants of that.
    assert_eq!(
        summary.matches("\"below_rounding\": true").count(),
        3,
        "{summary}"
    );
}

/// Invalid durations are errors in every option, before anything is read.
#[test]
fn invalid_durations_are_errors() {
    for duration in ["nan", "inf", "-1", "0", "ten"] {
        for arguments in [
            ["sweep", "none.toml", "--duration"],
            ["trade", "none.toml", "--window"],
        ] {
            let block = format!("{}={duration}", arguments[2]);
            let ended = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
                .args([arguments[0], arguments[1], &block])
                .output()
                .unwrap();
            let errors = text(&ended.stderr);
            assert_eq!(ended.status.code(), Some(2), "{errors}");
            assert!(
                errors.contains("a time in seconds, finite and above 0"),
                "{errors}"
            );
        }
    }
}

/// A run of the same scene in the folder of an interrupted one is refused, unless it begins anew on purpose; one of another
/// scene says which checkpoint it removes.
#[cfg(unix)]
#[test]
fn an_interrupted_run_is_not_discarded_silently() {
    let block = long("discarded");
    let first = start(&block);
    block::signal(&first, "-INT");
    let ended = first.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(130), "{}", text(&ended.stderr));
    let (scene, out) = (block.scene(), block.out_text());
    let refused = block.powerhouse(&["run", &scene, "--out", &out]);
    let errors = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    for passage in [
        "ended before its time in",
        "--resume",
        "from t = ",
        "`--restart`",
    ] {
        assert!(errors.contains(passage), "{passage}: {errors}");
    }
    assert!(block.out().join("checkpoint").is_dir());
    let set = ["--set", "time.duration=0.02"];
    let other = block.powerhouse(&["run", &scene, "--out", &out, set[0], set[1]]);
    let printed = text(&other.stdout);
    assert_eq!(other.status.code(), Some(0), "{}", text(&other.stderr));
    assert!(
        printed.contains("the checkpoint of another run in"),
        "{printed}"
    );
    assert!(!block.out().join("checkpoint").exists());
    let again = start(&block);
    block::signal(&again, "-INT");
    again.wait_with_output().unwrap();
    let mut run = Command::new(env!("CARGO_BIN_EXE_powerhouse"));
    run.args(["run", &scene, "--out", &out, "--restart"]);
    let run = run
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let snapshot = block.out().join("snapshots/snapshots_00002.vtu");
    let begun = Instant::now();
    // Those of the interrupted run are removed first.
    while snapshot.exists() || !block.out().join("summary.json").exists() {
        assert!(begun.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(1));
    }
    block::signal(&run, "-INT");
    let run = run.wait_with_output().unwrap();
    assert_eq!(run.status.code(), Some(130), "{}", text(&run.stderr));
}

/// A run in the folder of a sweep warns of it.
#[test]
fn a_run_among_the_cases_of_a_sweep_is_warned_of() {
    let cases = "\n[[case]]\nname = \"straight\"\nwave = [{ kind = \"sv\", incidence = 0, pulse = { kind = \"smooth\", displacement = 0.02, duration = 0.25 } }]\n";
    let block = Block::new("among-cases", |scene| scene + cases);
    let (scene, out) = (block.scene(), block.out_text());
    let duration = ["--duration", "0.02"];
    let none = block.powerhouse(&["run", &scene, "--out", &out, duration[0], duration[1]]);
    assert!(!text(&none.stdout).contains("has the results of a sweep"));
    let swept = block.powerhouse(&["sweep", &scene, "--out", &out, duration[0], duration[1]]);
    assert_eq!(swept.status.code(), Some(0), "{}", text(&swept.stderr));
    let among = block.powerhouse(&["run", &scene, "--out", &out, duration[0], duration[1]]);
    let printed = text(&among.stdout);
    assert!(printed.contains("has the results of a sweep"), "{printed}");
    // Results of another duration are replaced with a word, those of the same one are taken.
    let longer = block.powerhouse(&["sweep", &scene, "--out", &out, "--duration", "0.03"]);
    let printed = text(&longer.stdout);
    assert!(
        printed.contains("straight: its finished results are those of other inputs"),
        "{printed}"
    );
    let same = block.powerhouse(&["sweep", &scene, "--out", &out, "--duration", "0.03"]);
    let printed = text(&same.stdout);
    assert!(
        !printed.contains("other inputs") && printed.contains("finished before"),
        "{printed}"
    );
}
