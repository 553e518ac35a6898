//! Commands that are killed, and the comparison of the files that they leave.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use powerhouse_test_support::{EVERYTHING, TestFolder};

/// The scene with everything that a run can have, for a duration (s), in a file of a folder, with more text behind it.
pub(crate) fn scene(folder: &TestFolder, duration: f64, more: &str) -> PathBuf {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let data = data.canonicalize().unwrap();
    let text = EVERYTHING
        .replace("../", &format!("{}/", data.display()))
        .replace("duration = 1\n", &format!("duration = {duration}\n"))
        .replace("every = 0.05\n", "every = 0.04\n");
    let file = folder.join("scene.toml");
    std::fs::write(&file, text + more).unwrap();
    file
}

/// Starts the command on a number of threads; its standard output is added to a file.
pub(crate) fn start(arguments: &[&str], threads: usize, printed: &Path) -> Child {
    let printed = std::fs::File::options()
        .create(true)
        .append(true)
        .open(printed);
    Command::new(env!("CARGO_BIN_EXE_powerhouse"))
        .args(arguments)
        .env("RAYON_NUM_THREADS", threads.to_string())
        .stdout(printed.unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Repeatable numbers in `[0, 1)`.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Kills a command at a random moment within a time; false if it has ended before.
    pub(crate) fn kill(&mut self, command: &mut Child, within: Duration) -> bool {
        std::thread::sleep(within.mul_f64(self.next()) + Duration::from_millis(50));
        if command.try_wait().unwrap().is_some() {
            return false;
        }
        command.kill().unwrap();
        command.wait().unwrap();
        true
    }
}

/// The content of all files below a folder, without wall times and what depends on them.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let (mut found, mut left) = (BTreeMap::new(), vec![folder.to_path_buf()]);
    while let Some(next) = left.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                left.push(path);
                continue;
            }
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            // A list of cases that was being written when the sweep was killed.
            if name.starts_with("cases.json.") {
                continue;
            }
            let bytes = std::fs::read(&path).unwrap();
            found.insert(
                path.strip_prefix(folder).unwrap().to_path_buf(),
                without_wall_times(&name, bytes),
            );
        }
    }
    found
}

fn without_wall_times(name: &str, bytes: Vec<u8>) -> Vec<u8> {
    let lines = |text: &[u8], change: &dyn Fn(&str) -> String| -> Vec<u8> {
        let text = String::from_utf8(text.to_vec()).unwrap();
        let lines = text.lines().map(change);
        lines
            .flat_map(|line| [line, "\n".into()])
            .collect::<String>()
            .into()
    };
    let without = |line: &str, words: &[&str]| {
        if words.iter().any(|word| line.contains(word)) {
            String::new()
        } else {
            line.to_owned()
        }
    };
    match name {
        "summary.json" | "outcome.json" => lines(&bytes, &|line| without(line, &["wall"])),
        // The checksum of the summary, and sizes of files, which have lines of their own.
        "finished.json" => lines(&bytes, &|line| {
            if line.contains('"') {
                without(line, &["\"summary\""])
            } else {
                String::new()
            }
        }),
        // The wall time is the fourth column.
        "sweep.csv" => lines(&bytes, &|line| {
            let cells = line.split(',').enumerate();
            let cells = cells.filter(|(column, _)| *column != 3);
            cells.map(|(_, cell)| cell).collect::<Vec<&str>>().join(",")
        }),
        _ => bytes,
    }
}

/// Compares all files of two folders but for wall times.
pub(crate) fn assert_same_files(found: &Path, expected: &Path) {
    let [found, expected] = [files(found), files(expected)];
    let names =
        |files: &BTreeMap<PathBuf, Vec<u8>>| -> Vec<PathBuf> { files.keys().cloned().collect() };
    assert_eq!(names(&found), names(&expected));
    for (name, content) in &expected {
        assert!(found[name] == *content, "{} differs", name.display());
    }
}
