//! A run that is killed at any moment is resumed to the same files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use powerhouse_test_support::{EVERYTHING, TestFolder};

/// A scene with everything that a run can have, for a quarter of a second.
fn scene(folder: &TestFolder) -> PathBuf {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let data = data.canonicalize().unwrap();
    let text = EVERYTHING
        .replace("../", &format!("{}/", data.display()))
        .replace("duration = 1\n", "duration = 0.25\n")
        .replace("every = 0.05\n", "every = 0.04\n");
    let text = format!("{text}[checkpoint]\nkeep = [0.1]\n");
    let file = folder.join("scene.toml");
    std::fs::write(&file, text).unwrap();
    file
}

/// Starts the command on a number of threads.
fn start(arguments: &[&str], threads: usize) -> Child {
    Command::new(env!("CARGO_BIN_EXE_powerhouse"))
        .args(arguments)
        .env("RAYON_NUM_THREADS", threads.to_string())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// The content of all files below a folder, without wall times.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let (mut found, mut left) = (BTreeMap::new(), vec![folder.to_path_buf()]);
    while let Some(next) = left.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                left.push(path);
                continue;
            }
            let mut bytes = std::fs::read(&path).unwrap();
            if path.ends_with("summary.json") {
                let text = String::from_utf8(bytes).unwrap();
                let same = text.lines().filter(|line| !line.contains("wall"));
                bytes = same
                    .flat_map(|line| [line, "\n"])
                    .collect::<String>()
                    .into();
            }
            found.insert(path.strip_prefix(folder).unwrap().to_path_buf(), bytes);
        }
    }
    found
}

/// Repeatable numbers in `[0, 1)`.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Kills the run of a scene at so many random moments, stages included, resumes it each time with another number of
/// threads, and compares all files with those of a run without an interruption.
fn kill_and_resume(name: &str, kills: u32) {
    let folder = TestFolder::new(name);
    let scene = scene(&folder).display().to_string();
    let [whole, killed] = ["whole", "killed"].map(|name| folder.join(name));
    let [whole_text, killed_text] = [&whole, &killed].map(|path| path.display().to_string());
    let begun = Instant::now();
    let status = start(&["run", &scene, "--out", &whole_text], 2)
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
        let mut run = match has_checkpoint {
            true => start(
                &["run", "--resume", &killed_text, every[0], every[1]],
                threads,
            ),
            false => start(
                &["run", &scene, "--out", &killed_text, every[0], every[1]],
                threads,
            ),
        };
        resumed += u32::from(has_checkpoint);
        if done == kills {
            assert!(run.wait().unwrap().success());
            break;
        }
        std::thread::sleep(duration.mul_f64(noise.next() * 0.9) + Duration::from_millis(50));
        // A run that has ended before is one without a kill.
        if run.try_wait().unwrap().is_some() {
            let _ = std::fs::remove_dir_all(&killed);
            continue;
        }
        run.kill().unwrap();
        run.wait().unwrap();
        done += 1;
    }
    assert!(
        resumed * 2 > kills,
        "{resumed} of {kills} kills were after a checkpoint"
    );
    let [whole, killed] = [files(&whole), files(&killed)];
    let names =
        |files: &BTreeMap<PathBuf, Vec<u8>>| -> Vec<PathBuf> { files.keys().cloned().collect() };
    assert_eq!(names(&killed), names(&whole));
    for (name, content) in &whole {
        assert!(killed[name] == *content, "{} differs", name.display());
    }
    assert!(whole.len() > 30, "{:?}", names(&whole));
}

/// Ten kills.
#[test]
fn a_killed_run_is_resumed_to_the_same_files() {
    kill_and_resume("cli-resume", 10);
}

/// Two hundred kills: `cargo test --release -p powerhouse-cli --test resume -- --ignored`.
#[test]
#[ignore = "takes most of an hour"]
fn a_run_killed_two_hundred_times_is_resumed_to_the_same_files() {
    kill_and_resume("cli-resume-200", 200);
}

/// A checkpoint of a scene that was edited since, and a damaged one without an older one, are refused by name.
#[test]
fn a_foreign_or_damaged_checkpoint_is_refused() {
    let folder = TestFolder::new("cli-resume-refused");
    let file = scene(&folder);
    let scene = file.display().to_string();
    let out = folder.join("out");
    let out_text = out.display().to_string();
    let none = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
        .args(["run", "--resume", &out_text])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&none.stderr).into_owned();
    assert!(errors.contains("has no checkpoint"), "{errors}");
    let mut run = start(&["run", &scene, "--out", &out_text], 2);
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
