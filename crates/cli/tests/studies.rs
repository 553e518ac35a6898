//! Sweeps and trade studies that are killed at any moment go on inside their cases to the same files.

use std::path::Path;
use std::time::{Duration, Instant};

use crate::killed::{Noise, assert_same_files, files, scene, start};
use powerhouse_test_support::TestFolder;

/// Two cases, which share their stages.
const CASES: &str = r#"
[[case]]
name = "steep"
[[case]]
name = "slanted"
wave = [{ kind = "sv", incidence = 10, azimuth = 40, record = "el-centro-ns" }]
"#;

/// Runs a study without an interruption; returns the wall time that it took.
fn run_whole(arguments: &[String], printed: &Path) -> Duration {
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let begun = Instant::now();
    assert!(start(&arguments, 2, printed).wait().unwrap().success());
    begun.elapsed()
}

/// Starts a study anew after each of a number of kills, and of some more until it has printed that it was resumed, each
/// time with another number of threads, until it ends by itself; its life before each kill is at most a time. Returns what
/// all of it printed.
fn kill_and_start_again(
    arguments: &[String],
    (kills, resumed): (u32, &str),
    within: Duration,
    printed: &Path,
) -> String {
    let all_printed = || std::fs::read_to_string(printed).unwrap();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut noise = Noise(11);
    let mut done = 0;
    loop {
        let mut study = start(&arguments, 1 + done as usize % 3, printed);
        let more = done < kills || (done < 10 * kills && !all_printed().contains(resumed));
        if more && noise.kill(&mut study, within) {
            done += 1;
            continue;
        }
        assert!(study.wait().unwrap().success());
        assert!(done * 2 > kills, "{done} of {kills} kills");
        return all_printed();
    }
}

/// A sweep that is killed several times, also in its stages, goes on inside its cases, at the interval of checkpoints that
/// its scene requests: all files are those of a sweep
/// without an interruption but for wall times, and no checkpoint is left.
#[test]
fn a_killed_sweep_goes_on_inside_its_cases() {
    let folder = TestFolder::new("cli-sweep-killed");
    let more = format!("[checkpoint]\nevery = \"0.1s\"\n{CASES}");
    let scene = scene(&folder, 0.2, &more).display().to_string();
    let [whole, killed] = ["whole", "killed"].map(|name| folder.join(name));
    let sweep = |out: &Path| -> Vec<String> {
        let out = out.display().to_string();
        ["sweep", &scene, "--out", &out].map(String::from).into()
    };
    let within = run_whole(&sweep(&whole), &folder.join("printed")) / 4;
    let resumed = "steep: resumed after";
    let file = folder.join("printed-killed");
    let printed = kill_and_start_again(&sweep(&killed), (5, resumed), within, &file);
    assert!(printed.contains(resumed), "{printed}");
    assert!(printed.contains("steps, at t = "), "{printed}");
    assert!(!printed.contains("warning: a checkpoint"), "{printed}");
    assert_same_files(&killed, &whole);
    for case in ["steep", "slanted"] {
        assert!(!killed.join(case).join("checkpoint").exists());
    }
    assert!(files(&whole).len() > 60);
}

/// A trade study that is killed several times goes on inside its runs: their histories are those of a study without an
/// interruption, and nothing but results is left.
#[test]
fn a_killed_trade_study_goes_on_inside_its_runs() {
    let folder = TestFolder::new("cli-trade-killed");
    let scene = scene(&folder, 0.2, "").display().to_string();
    let trade = |out: &Path| -> Vec<String> {
        let out = out.display().to_string();
        let every = [
            "--checkpoint-every",
            "0.02s",
            "--every-history",
            "--every-combination",
        ];
        let fixed = [
            "trade",
            &scene,
            "--window",
            "0.1",
            "--factors",
            "precision",
            "--out",
            &out,
        ];
        fixed.into_iter().chain(every).map(String::from).collect()
    };
    let [whole, killed] = ["whole", "killed"].map(|name| folder.join(name));
    let within = run_whole(&trade(&whole), &folder.join("printed")) / 4;
    let resumed = "  resumed after";
    let file = folder.join("printed-killed");
    let printed = kill_and_start_again(&trade(&killed), (4, resumed), within, &file);
    assert!(printed.contains(resumed), "{printed}");
    let histories = |folder: &Path| {
        let mut of_runs = files(folder);
        of_runs.retain(|name, _| name.ends_with("histories.csv"));
        of_runs
    };
    let [of_whole, of_killed] = [histories(&whole), histories(&killed)];
    assert_eq!(of_whole.len(), 3);
    assert!(of_killed == of_whole);
    let names = |folder: &Path| -> Vec<_> { files(folder).into_keys().collect() };
    assert_eq!(names(&killed), names(&whole));
}
