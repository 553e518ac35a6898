//! Faults of the system around a run: what is said, what is left on the disk, and how the run goes on.

use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::block::{self, Block, text};
use crate::killed::{assert_same_files, files};
use powerhouse::CheckpointFiles;
use powerhouse_test_support::TestFolder;

/// A checkpoint after every step: none takes less.
const EVERY_STEP: [&str; 2] = ["--checkpoint-every", "0.000001s"];

fn powerhouse(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_powerhouse"));
    command
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// The command under a greatest size of its files (bytes), above which writing fails as on a full disk.
fn limited(most: u64, arguments: &[&str]) -> Command {
    // The signal for a file that is too large would end the command.
    let script = format!("trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"", most / 512);
    let mut command = Command::new("sh");
    command
        .args(["-c", &script, env!("CARGO_BIN_EXE_powerhouse")])
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// A block without snapshots.
fn block(name: &str, duration: &str) -> Block {
    Block::of_cells(name, 10, |scene| {
        let snapshots = scene.find("[output.snapshots]").unwrap();
        scene[..snapshots].replace("duration = 0.3", &format!("duration = {duration}"))
    })
}

fn run_arguments(block: &Block) -> Vec<String> {
    ["run", &block.scene(), "--out", &block.out_text()]
        .map(String::from)
        .into()
}

fn with<'a>(arguments: &'a [String], more: &[&'a str]) -> Vec<&'a str> {
    let arguments = arguments.iter().map(String::as_str);
    arguments.chain(more.iter().copied()).collect()
}

/// Waits until something is the case.
fn wait_until(run: &mut Child, is_time: impl Fn() -> bool) {
    let begun = Instant::now();
    while !is_time() {
        assert!(run.try_wait().unwrap().is_none(), "the run has ended");
        assert!(begun.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn interrupt(run: Child) -> Output {
    block::signal(&run, "-INT");
    run.wait_with_output().unwrap()
}

fn latest(out: &Path) -> PathBuf {
    out.join("checkpoint/latest.run")
}

/// The number of steps of the checkpoint that is used.
fn steps_of_checkpoint(out: &Path) -> u64 {
    CheckpointFiles::of(out).read().unwrap().run.unwrap().done
}

/// A disk that is full only at the checkpoint: the run goes on to all its results, with a warning that names the file, and
/// leaves no part of a file.
#[test]
fn a_disk_that_is_full_at_a_checkpoint_does_not_end_a_run() {
    let block = block("full-checkpoint", "0.3");
    let arguments = run_arguments(&block);
    let whole = powerhouse(&with(&arguments, &["--checkpoint-every", "never"]))
        .output()
        .unwrap();
    assert_eq!(whole.status.code(), Some(0), "{}", text(&whole.stderr));
    let expected = files(&block.out());
    let largest = expected.values().map(Vec::len).max().unwrap() as u64;
    std::fs::remove_dir_all(block.out()).unwrap();
    let most = 2 * largest;
    let ended = limited(most, &with(&arguments, &EVERY_STEP))
        .output()
        .unwrap();
    let printed = text(&ended.stdout);
    assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
    let warning = "warning: a checkpoint could not be written: ";
    let warning = printed.lines().find_map(|line| line.strip_prefix(warning));
    let warning = warning.unwrap_or_else(|| panic!("no checkpoint above {most} bytes: {printed}"));
    assert!(warning.contains("latest.run: File too large"), "{warning}");
    assert!(files(&block.out()) == expected);
}

/// A disk that becomes full during a run: the last checkpoint before that remains, an interrupted run names its time, and
/// goes on from it when there is space again.
#[test]
fn the_checkpoint_before_the_disk_was_full_remains() {
    let block = block("full-later", "1000");
    let arguments = run_arguments(&block);
    let mut first = powerhouse(&with(&arguments, &EVERY_STEP)).spawn().unwrap();
    wait_until(&mut first, || latest(&block.out()).exists());
    first.kill().unwrap();
    first.wait().unwrap();
    let previous = block.out().join("checkpoint/previous.run");
    if !latest(&block.out()).exists() {
        std::fs::rename(&previous, latest(&block.out())).unwrap();
    }
    let before = steps_of_checkpoint(&block.out());
    let out = block.out_text();
    let resume = ["run", "--resume", &out, EVERY_STEP[0], EVERY_STEP[1]];
    // The checkpoints are some hundred kilobytes, all that an interrupted run writes is less.
    let size = std::fs::metadata(latest(&block.out())).unwrap().len();
    let mut full = limited(size - 512, &resume).spawn().unwrap();
    wait_until(&mut full, || {
        previous.exists() && !latest(&block.out()).exists()
    });
    let ended = interrupt(full);
    let printed = text(&ended.stdout);
    assert_eq!(ended.status.code(), Some(130), "{}", text(&ended.stderr));
    assert!(
        printed.contains("warning: a checkpoint could not be written"),
        "{printed}"
    );
    let goes_on = "goes on from t = ";
    let line = printed.lines().find(|line| line.contains(goes_on)).unwrap();
    assert!(line.contains(&format!("after {before} steps")), "{line}");
    assert_eq!(steps_of_checkpoint(&block.out()), before);
    let mut resumed = powerhouse(&resume).spawn().unwrap();
    wait_until(&mut resumed, || latest(&block.out()).exists());
    let ended = interrupt(resumed);
    assert_eq!(ended.status.code(), Some(130));
    assert!(text(&ended.stdout).contains(&format!("resumed after {before} steps")));
    assert!(steps_of_checkpoint(&block.out()) > before);
}

/// A disk that is full when the results are written: an error that names the file, status 2, all files that have space,
/// and a summary that does not claim more; the run is completed from its checkpoint when there is space.
#[test]
fn a_disk_that_is_full_at_the_end_loses_no_result() {
    let envelope = "[output.envelope]\nquantities = [\"displacement\", \"acceleration\"]\n";
    let block = Block::of_cells("full-end", 10, |scene| {
        let snapshots = scene.find("[output.snapshots]").unwrap();
        format!("{}{envelope}", &scene[..snapshots])
    });
    let arguments = run_arguments(&block);
    let whole = powerhouse(&with(&arguments, &[])).output().unwrap();
    assert_eq!(whole.status.code(), Some(0), "{}", text(&whole.stderr));
    let expected = files(&block.out());
    let size = |name: &str| expected[Path::new(name)].len() as u64;
    // A file that is written at the end: those that grow during the run are smaller.
    let late = size("envelope.vtu");
    for table in ["energies.csv", "histories.csv"] {
        assert!(late > size(table) + 4096, "{late}");
    }
    std::fs::remove_dir_all(block.out()).unwrap();
    let ended = limited(late - 512, &with(&arguments, &EVERY_STEP))
        .output()
        .unwrap();
    let errors = text(&ended.stderr);
    assert_eq!(ended.status.code(), Some(2), "{errors}");
    assert!(errors.contains("envelope.vtu: File too large"), "{errors}");
    assert!(
        errors.contains("note: no checkpoint was written before the failure"),
        "{errors}"
    );
    let left = files(&block.out());
    for name in ["histories.csv", "energies.csv", "scene.toml"] {
        assert!(left[Path::new(name)] == expected[Path::new(name)], "{name}");
    }
    let summary = std::fs::read_to_string(block.out().join("summary.json")).unwrap();
    assert!(
        summary.contains("its files are not all written"),
        "{summary}"
    );
    assert!(
        left.keys()
            .all(|name| !name.to_string_lossy().ends_with(".part"))
    );
}

/// A file of a user in the way of a checkpoint is an error of the checkpoint alone, and a folder of checkpoints that
/// vanishes during a run is made anew.
#[test]
fn a_folder_of_checkpoints_that_vanishes_is_made_anew() {
    let block = block("vanishing-checkpoint", "1000");
    let arguments = run_arguments(&block);
    let mut run = powerhouse(&with(&arguments, &EVERY_STEP)).spawn().unwrap();
    wait_until(&mut run, || latest(&block.out()).exists());
    let elsewhere = block.folder.join("elsewhere");
    std::fs::rename(block.out().join("checkpoint"), &elsewhere).unwrap();
    wait_until(&mut run, || latest(&block.out()).exists());
    let ended = interrupt(run);
    assert_eq!(ended.status.code(), Some(130), "{}", text(&ended.stderr));
    assert!(steps_of_checkpoint(&block.out()) > 0);
}

/// The user of the test: its own, or, for the system's administrator, to whom nothing is read-only, nobody.
struct User {
    id: Option<u32>,
    program: PathBuf,
}

impl User {
    /// None, with the reason printed, where a user other than the administrator cannot run the command.
    fn other_than_root(folder: &TestFolder) -> Option<Self> {
        let program = PathBuf::from(env!("CARGO_BIN_EXE_powerhouse"));
        if std::fs::metadata(&**folder).unwrap().uid() != 0 {
            return Some(Self { id: None, program });
        }
        // The folder of the build may be closed to others.
        let copy = folder.join("powerhouse");
        std::fs::copy(program, &copy).unwrap();
        std::fs::set_permissions(&copy, std::fs::Permissions::from_mode(0o755)).unwrap();
        let user = Self {
            id: Some(65534),
            program: copy,
        };
        match user.powerhouse(&["--version"]).output() {
            Ok(ended) if ended.status.success() => Some(user),
            other => {
                eprintln!("skipped: the administrator's tests cannot run as nobody: {other:?}");
                None
            }
        }
    }

    fn powerhouse(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        if let Some(id) = self.id {
            command.uid(id).gid(id);
        }
        command
    }
}

fn permit(folder: &Path, mode: u32) {
    std::fs::set_permissions(folder, std::fs::Permissions::from_mode(mode)).unwrap();
}

/// A results folder that is read-only at the start is an error before the first step, status 2, that names the folder and
/// what to do, and nothing in it changes.
#[test]
fn a_read_only_folder_is_refused_before_the_first_step() {
    let block = block("read-only", "0.3");
    let Some(user) = User::other_than_root(&block.folder) else {
        return;
    };
    std::fs::create_dir(block.out()).unwrap();
    std::fs::write(block.out().join("notes.txt"), "mine").unwrap();
    permit(&block.out(), 0o555);
    let ended = user
        .powerhouse(&with(&run_arguments(&block), &[]))
        .output()
        .unwrap();
    let errors = text(&ended.stderr);
    assert_eq!(ended.status.code(), Some(2), "{errors}");
    let wanted = "out: cannot write into this folder (Permission denied (os error 13)); give another folder (--out)";
    assert!(errors.contains(wanted), "{errors}");
    assert!(!text(&ended.stdout).contains("completed"));
    assert_eq!(std::fs::read_dir(block.out()).unwrap().count(), 1);
    permit(&block.out(), 0o755);
}

/// A results folder that becomes read-only during a run: the run ends at its next snapshot with an error that names it,
/// status 2; snapshots, tables and the checkpoint from before are whole, and the run goes on from it.
#[test]
fn a_folder_that_becomes_read_only_keeps_what_it_has() {
    let block = Block::of_cells("read-only-later", 10, |scene| {
        scene
            .replace("duration = 0.3", "duration = 1000")
            .replace("every = 0.1", "every = 0.02")
            .replace("every = 0.01", "every = 0.1")
    });
    let Some(user) = User::other_than_root(&block.folder) else {
        return;
    };
    let out = block.out();
    std::fs::create_dir(&out).unwrap();
    permit(&out, 0o777);
    let mut run = user
        .powerhouse(&with(&run_arguments(&block), &EVERY_STEP))
        .spawn()
        .unwrap();
    let second = out.join("snapshots/snapshots_00001.vtu");
    wait_until(&mut run, || second.exists() && latest(&out).exists());
    let folders = [out.clone(), out.join("snapshots"), out.join("checkpoint")];
    folders.iter().for_each(|folder| permit(folder, 0o555));
    let ended = run.wait_with_output().unwrap();
    let errors = text(&ended.stderr);
    assert_eq!(ended.status.code(), Some(2), "{errors}");
    assert!(errors.contains("Permission denied"), "{errors}");
    assert!(errors.contains("snapshots"), "{errors}");
    assert!(
        errors.contains("note: the last good state is kept"),
        "{errors}"
    );
    let steps = steps_of_checkpoint(&out);
    assert!(second.metadata().unwrap().len() > 0);
    folders.iter().for_each(|folder| permit(folder, 0o777));
    let out_text = block.out_text();
    let mut resumed = user
        .powerhouse(&["run", "--resume", &out_text])
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let later = || std::fs::read_dir(out.join("snapshots")).unwrap().count();
    let so_far = later();
    wait_until(&mut resumed, || {
        later() > so_far + 1 || begun.elapsed() > Duration::from_secs(60)
    });
    let ended = interrupt(resumed);
    assert_eq!(ended.status.code(), Some(130), "{}", text(&ended.stderr));
    assert!(text(&ended.stdout).contains(&format!("resumed after {steps} steps")));
    assert!(later() > so_far);
}

/// A run that goes on is not disturbed by an attempt to resume it: the second one is refused by the name of the first.
#[test]
fn a_running_run_is_not_resumed() {
    let block = block("two-resumed", "1000");
    let mut run = powerhouse(&with(&run_arguments(&block), &EVERY_STEP))
        .spawn()
        .unwrap();
    wait_until(&mut run, || latest(&block.out()).exists());
    let out = block.out_text();
    let refused = powerhouse(&["run", "--resume", &out]).output().unwrap();
    let errors = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains(&format!("another run (process {}", run.id())),
        "{errors}"
    );
    let ended = interrupt(run);
    assert_eq!(ended.status.code(), Some(130), "{}", text(&ended.stderr));
}

/// A run that is killed in its first moments leaves no checkpoint: it is not resumed, which is said, and begins anew in
/// the same folder. One that is killed while its results are written goes on from its last checkpoint. Both lead to the
/// files of a run without an interruption.
#[test]
fn first_and_last_moments_lose_nothing() {
    let expected = block("moments", "0.3");
    let whole = powerhouse(&with(&run_arguments(&expected), &[]))
        .output()
        .unwrap();
    assert_eq!(whole.status.code(), Some(0), "{}", text(&whole.stderr));
    let other = Block {
        folder: TestFolder::new("cli-moments"),
    };
    for name in ["mesh.msh", "scene.toml"] {
        std::fs::copy(expected.folder.join(name), other.folder.join(name)).unwrap();
    }
    let arguments = run_arguments(&other);
    let out = other.out_text();
    let first = [".powerhouse-lock", "summary.json"].map(|name| other.out().join(name));
    for sign in first {
        let mut run = powerhouse(&with(&arguments, &[])).spawn().unwrap();
        wait_until(&mut run, || sign.exists());
        run.kill().unwrap();
        run.wait().unwrap();
        let refused = powerhouse(&["run", "--resume", &out]).output().unwrap();
        let errors = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{errors}");
        assert!(
            errors.contains("has no checkpoint from which the run could be resumed"),
            "{errors}"
        );
        let anew = powerhouse(&with(&arguments, &[])).output().unwrap();
        assert_eq!(anew.status.code(), Some(0), "{}", text(&anew.stderr));
        assert_same_files(&other.out(), &expected.out());
        std::fs::remove_dir_all(other.out()).unwrap();
    }
    let mut resumed = 0;
    let last =
        ["histories.csv", "energies.csv", "plots/inside.svg"].map(|name| other.out().join(name));
    for sign in last {
        let mut run = powerhouse(&with(&arguments, &EVERY_STEP)).spawn().unwrap();
        wait_until(&mut run, || sign.exists());
        run.kill().unwrap();
        run.wait().unwrap();
        // It may have ended just before.
        if CheckpointFiles::of(other.out()).read().is_ok() {
            let ended = powerhouse(&["run", "--resume", &out]).output().unwrap();
            assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
            assert!(text(&ended.stdout).contains("resumed after"));
            resumed += 1;
        }
        assert_same_files(&other.out(), &expected.out());
        std::fs::remove_dir_all(other.out()).unwrap();
    }
    assert!(resumed > 0);
}

/// A motion that diverges fails with the state before it kept: the message has its time, and says what goes on from it and
/// what does not. Without a checkpoint the message says that there is none.
#[test]
fn a_diverging_run_names_its_last_good_state() {
    // A pulse as fast as the waves of the rock.
    let block = Block::new("diverges", |scene| {
        let scene = scene.replace("displacement = 0.02", "displacement = 2e4");
        format!("allow = [\"magnitudes\"]\n{scene}")
    });
    let arguments = run_arguments(&block);
    for (every, has_checkpoint) in [("0.000001s", true), ("never", false)] {
        let ended = powerhouse(&with(
            &arguments,
            &["--checkpoint-every", every, "--restart"],
        ))
        .output()
        .unwrap();
        let errors = text(&ended.stderr);
        assert_eq!(ended.status.code(), Some(2), "{errors}");
        assert!(errors.contains("the motion diverged at step "), "{errors}");
        if !has_checkpoint {
            assert!(
                errors.contains("note: no checkpoint was written before the failure"),
                "{errors}"
            );
            assert!(!block.out().join("checkpoint").exists());
            continue;
        }
        let kept = CheckpointFiles::of(block.out())
            .read()
            .unwrap()
            .run
            .unwrap();
        let step = errors.split("diverged at step ").nth(1).unwrap();
        let step: u64 = step.split(' ').next().unwrap().parse().unwrap();
        assert!(
            kept.done > 0 && kept.done <= step,
            "{} of {step}",
            kept.done
        );
        let note = format!(
            "note: the last good state is kept: `powerhouse run --resume {}` goes on from t = {:.6} s, after {} steps",
            block.out_text(),
            kept.time,
            kept.done
        );
        assert!(errors.contains(&note), "{errors}");
        assert!(errors.contains("fails at the same step"), "{errors}");
        // As the message says.
        let again = powerhouse(&["run", "--resume", &block.out_text()])
            .output()
            .unwrap();
        assert_eq!(again.status.code(), Some(2));
        assert!(text(&again.stderr).contains(&format!("the motion diverged at step {step} ")));
    }
}

/// Library that sets the calendar of a program years back and ahead at each look at it; other clocks go on.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const JUMPS: &str = "
#define _GNU_SOURCE
#include <dlfcn.h>
#include <time.h>
int clock_gettime(clockid_t clock, struct timespec *now) {
    static int (*real)(clockid_t, struct timespec *);
    static int looks;
    if (!real) real = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, \"clock_gettime\");
    int found = real(clock, now);
    if (clock == CLOCK_REALTIME) now->tv_sec += (++looks % 2) ? -1700000000 : 900000000;
    return found;
}
";

/// A calendar that jumps by decades during a run moves no result and no checkpoint. Skipped without a C compiler, which
/// builds the calendar.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[test]
fn a_clock_that_jumps_changes_nothing() {
    let expected = block("clock", "0.3");
    let library = expected.folder.join("jumps.so");
    std::fs::write(expected.folder.join("jumps.c"), JUMPS).unwrap();
    let built = Command::new("cc")
        .args(["-shared", "-fPIC", "-o"])
        .arg(&library)
        .arg(expected.folder.join("jumps.c"))
        .arg("-ldl")
        .status();
    if !built.is_ok_and(|status| status.success()) {
        eprintln!("skipped: there is no C compiler for a calendar that jumps");
        return;
    }
    let whole = powerhouse(&with(&run_arguments(&expected), &[]))
        .output()
        .unwrap();
    assert_eq!(whole.status.code(), Some(0), "{}", text(&whole.stderr));
    let undisturbed = files(&expected.out());
    std::fs::remove_dir_all(expected.out()).unwrap();
    let mut run = powerhouse(&with(&run_arguments(&expected), &EVERY_STEP));
    let mut run = run.env("LD_PRELOAD", &library).spawn().unwrap();
    let lock = expected.out().join(".powerhouse-lock");
    wait_until(&mut run, || {
        std::fs::read_to_string(&lock).is_ok_and(|text| text.contains("UTC"))
    });
    let signature = std::fs::read_to_string(&lock).unwrap();
    assert!(!signature.contains("since 202"), "{signature}");
    wait_until(&mut run, || latest(&expected.out()).exists());
    run.kill().unwrap();
    run.wait().unwrap();
    let out = expected.out_text();
    let resumed = powerhouse(&["run", "--resume", &out])
        .env("LD_PRELOAD", &library)
        .output()
        .unwrap();
    assert_eq!(resumed.status.code(), Some(0), "{}", text(&resumed.stderr));
    assert!(files(&expected.out()) == undisturbed);
}
