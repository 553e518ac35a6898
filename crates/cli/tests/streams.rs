//! Closed standard streams and full disks.

use std::fs::File;
use std::process::{Command, Stdio};

use crate::block::Block;

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_powerhouse"));
    command.args(arguments);
    command
}

/// What a run leaves: the files that a run with both streams open leaves too.
fn has_results(block: &Block) {
    for file in [
        "summary.json",
        "histories.csv",
        "energies.csv",
        "plots/inside.svg",
        "snapshots.pvd",
    ] {
        assert!(block.out().join(file).exists(), "{file}");
    }
    let summary = std::fs::read_to_string(block.out().join("summary.json")).unwrap();
    assert!(summary.contains("\"ended\": \"completed\""), "{summary}");
}

/// A run with one or both standard streams closed continues, writes its files and ends with status 0, without a panic.
#[test]
fn a_closed_pipe_does_not_end_a_run() {
    for (name, closes_stderr) in [("stdout", false), ("both", true)] {
        let block = Block::new(&format!("pipe-{name}"), |scene| scene);
        let mut run = command(&["run", &block.scene(), "--out", &block.out_text()])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(run.stdout.take());
        if closes_stderr {
            drop(run.stderr.take());
        }
        let ended = run.wait_with_output().unwrap();
        let errors = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(0), "{name}: {errors}");
        assert!(!errors.contains("panicked"), "{errors}");
        has_results(&block);
    }
}

/// A full disk behind the output does not end a run either, and is reported on the error stream.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_the_output_does_not_end_a_run() {
    let full = || File::options().write(true).open("/dev/full").unwrap();
    let block = Block::new("full", |scene| scene);
    let run = ["run", &block.scene(), "--out", &block.out_text()];
    let ended = command(&run)
        .stdout(full())
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(0), "{errors}");
    assert!(
        errors.contains("the standard output could not be written"),
        "{errors}"
    );
    has_results(&block);
    let ended = command(&run)
        .stdout(full())
        .stderr(full())
        .status()
        .unwrap();
    assert_eq!(ended.code(), Some(0));
}

/// A command that only prints ends in order with a closed output: status 0, or 2 if the output was lost to a full disk.
/// An error keeps its status if it cannot be printed.
#[cfg(target_os = "linux")]
#[test]
fn commands_that_only_print_do_not_panic() {
    let block = Block::new("prints", |scene| scene);
    let scene = block.scene();
    for (arguments, of_pipe, of_full) in [
        (vec!["schema"], 0, 2),
        // The block has a warning, hence its status.
        (vec!["check", &scene], 1, 2),
        (vec!["check", "no-such-scene.toml"], 2, 2),
    ] {
        let mut child = command(&arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(child.wait().unwrap().code(), Some(of_pipe), "{arguments:?}");
        let full = File::options().write(true).open("/dev/full").unwrap();
        let ended = command(&arguments).stdout(full).output().unwrap();
        let errors = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(
            ended.status.code(),
            Some(of_full),
            "{arguments:?}: {errors}"
        );
        assert!(!errors.contains("panicked"), "{errors}");
    }
}
