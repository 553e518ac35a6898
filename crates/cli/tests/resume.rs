//! A run that is killed at any moment is resumed to the same files.

use std::process::Command;
use std::time::{Duration, Instant};

use crate::killed::{Noise, assert_same_files, files, scene, start};
use powerhouse_test_support::TestFolder;

/// Kills the run of a scene at so many random moments, stages included, resumes it each time with another number of
/// threads, and compares all files with those of a run without an interruption.
fn kill_and_resume(name: &str, kills: u32) {
    let folder = TestFolder::new(name);
    let scene = scene(&folder, 0.25, "").display().to_string();
    let [whole, killed, printed] = ["whole", "killed", "printed"].map(|name| folder.join(name));
    let [whole_text, killed_text] = [&whole, &killed].map(|path| path.display().to_string());
    let begun = Instant::now();
    let status = start(&["run", &scene, "--out", &whole_text], 2, &printed)
        .wait()
        .unwrap();
    assert!(status.success());
    let duration = begun.elapsed();
    assert!(
        !whole.join("checkpoint").exists(),
        "a complete run keeps no checkpoint"
    );
    let mut noise = Noise(7);
    let (mut done, mut resumed) = (0, 0);
    let every = ["--checkpoint-every", "0.1s"];
    loop {
        let has_checkpoint = killed.join("checkpoint").is_dir();
        let threads = 1 + done as usize % 3;
        let arguments = if has_checkpoint {
            ["run", "--resume", &killed_text, every[0], every[1]].to_vec()
        } else {
            ["run", &scene, "--out", &killed_text, every[0], every[1]].to_vec()
        };
        let mut run = start(&arguments, threads, &printed);
        resumed += u32::from(has_checkpoint);
        if done == kills {
            assert!(run.wait().unwrap().success());
            break;
        }
        // A run that has ended before is one without a kill.
        if !noise.kill(&mut run, duration.mul_f64(0.9)) {
            let _ = std::fs::remove_dir_all(&killed);
            continue;
        }
        done += 1;
    }
    assert!(
        resumed * 2 > kills,
        "{resumed} of {kills} kills were after a checkpoint"
    );
    assert_same_files(&killed, &whole);
    assert!(files(&whole).len() > 30);
}

/// Six kills.
#[test]
fn a_killed_run_is_resumed_to_the_same_files() {
    kill_and_resume("cli-resume", 6);
}

/// Two hundred kills: `cargo test --test cli two_hundred -- --ignored`.
#[test]
#[ignore = "takes a quarter of an hour"]
fn a_run_killed_two_hundred_times_is_resumed_to_the_same_files() {
    kill_and_resume("cli-resume-200", 200);
}

/// A checkpoint of a scene that was edited since, and a damaged one without an older one, are refused by name.
#[test]
fn a_foreign_or_damaged_checkpoint_is_refused() {
    let folder = TestFolder::new("cli-resume-refused");
    let file = scene(&folder, 0.25, "");
    let scene = file.display().to_string();
    let out = folder.join("out");
    let out_text = out.display().to_string();
    let none = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
        .args(["run", "--resume", &out_text])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&none.stderr).into_owned();
    assert!(errors.contains("has no checkpoint"), "{errors}");
    let mut run = start(
        &["run", &scene, "--out", &out_text],
        2,
        &folder.join("printed"),
    );
    let latest = out.join("checkpoint/latest.stage");
    let begun = Instant::now();
    while !latest.exists() {
        assert!(begun.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(5));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    let resume = || {
        let resumed = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
            .args(["run", "--resume", &out_text])
            .output()
            .unwrap();
        assert_eq!(resumed.status.code(), Some(2));
        String::from_utf8_lossy(&resumed.stderr).into_owned()
    };
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("peak = 30", "peak = 31")).unwrap();
    let errors = resume();
    assert!(
        errors.contains("belongs to another run; changed since: key 'record'"),
        "{errors}"
    );
    std::fs::write(&file, text).unwrap();
    for name in [
        "latest.stage",
        "previous.stage",
        "latest.run",
        "previous.run",
    ] {
        let file = out.join("checkpoint").join(name);
        if let Ok(mut bytes) = std::fs::read(&file) {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 16;
            std::fs::write(&file, bytes).unwrap();
        }
    }
    let errors = resume();
    assert!(
        errors.contains("is damaged in the section 'state'"),
        "{errors}"
    );
}
