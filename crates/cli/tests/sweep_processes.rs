//! Sweeps that several processes share: each case is computed once, and processes that end early hinder no other.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::block::{self, Block};
use crate::killed::{assert_same_files, files};

/// Five cases, of which four share their stage.
const CASES: &str = r#"
[[load]]
kind = "gravity"
[in_situ_stress]
kind = "ground"
level = 120
density = 2750
lateral = 0.37
[[stage]]
name = "weight"
support = [
    { kind = "roller", set = "left" },
    { kind = "roller", set = "right" },
    { kind = "roller", set = "front" },
    { kind = "roller", set = "back" },
    { kind = "roller", set = "bottom" },
]
[[case]]
name = "of-20"
[[case]]
name = "of-15"
wave = [{ kind = "sv", incidence = 15, pulse = { kind = "smooth", displacement = 0.02, duration = 0.25 } }]
[[case]]
name = "of-10"
wave = [{ kind = "sv", incidence = 10, pulse = { kind = "smooth", displacement = 0.02, duration = 0.25 } }]
[[case]]
name = "of-5"
wave = [{ kind = "sv", incidence = 5, pulse = { kind = "smooth", displacement = 0.02, duration = 0.25 } }]
[[case]]
name = "squeezed"
in_situ_stress = { kind = "ground", level = 120, density = 2750, lateral = 0.8 }
"#;
const NAMES: [&str; 5] = ["of-20", "of-15", "of-10", "of-5", "squeezed"];

/// A block with these cases, each of which takes a part of a second.
fn block(name: &str) -> Block {
    Block::new(name, |scene| {
        let scene = scene.replace("duration = 0.3\n", "duration = 0.3\nstep = 2.5e-5\n");
        scene + CASES
    })
}

/// The longest wall time of what a test waits for.
const MOST: Duration = Duration::from_secs(120);

/// A process of a sweep, as a launcher starts it, and the file of what it prints; killed when dropped.
struct Worker {
    process: Child,
    printed: PathBuf,
}

impl Worker {
    fn start(block: &Block, out: &Path, name: &str) -> Self {
        let every = ["--checkpoint-every", "0.02s"];
        Self::of(block, ("sweep", &every), out, name)
    }

    /// The process of a command on the scene of a block.
    fn of(block: &Block, command: (&str, &[&str]), out: &Path, name: &str) -> Self {
        let (command, arguments) = command;
        let printed = block.folder.join(name);
        let file = std::fs::File::create(&printed).unwrap();
        let process = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
            .args([command, &block.scene(), "--out"])
            .arg(out)
            .args(arguments)
            .env(
                "OMPI_COMM_WORLD_SIZE",
                if command == "sweep" { "2" } else { "1" },
            )
            .stderr(file.try_clone().unwrap())
            .stdout(file)
            .stdin(Stdio::null())
            .spawn()
            .unwrap();
        Self { process, printed }
    }

    fn printed(&self) -> String {
        std::fs::read_to_string(&self.printed).unwrap()
    }

    /// Waits until something is true while the process goes on.
    fn until(&mut self, is_true: impl Fn(&Self) -> bool) {
        let begun = Instant::now();
        while !is_true(self) {
            let ended = self.process.try_wait().unwrap();
            assert!(ended.is_none(), "{}", self.printed());
            assert!(begun.elapsed() < MOST, "{}", self.printed());
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Waits for its end; returns its status and what it printed.
    fn end(mut self) -> (Option<i32>, String) {
        let begun = Instant::now();
        loop {
            if let Some(status) = self.process.try_wait().unwrap() {
                return (status.code(), self.printed());
            }
            assert!(begun.elapsed() < MOST, "{}", self.printed());
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    #[cfg(unix)]
    fn signal(&self, signal: &str) {
        block::signal(&self.process, signal);
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // One that has ended is no fault.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The number of times that cases are stated to have been computed.
fn computed(printed: &str, case: &str) -> usize {
    let start = format!("  {case}: ");
    let lines = printed.lines().filter(|line| line.starts_with(&start));
    lines.filter(|line| line.contains(" steps of ")).count()
}

/// A sweep of the block by one process.
fn by_one(block: &Block) -> PathBuf {
    let out = block.folder.join("by-one");
    let (status, printed) = Worker::start(block, &out, "printed-by-one").end();
    assert_eq!(status, Some(0), "{printed}");
    for case in NAMES {
        assert_eq!(computed(&printed, case), 1, "{printed}");
    }
    out
}

/// Two processes compute every case and every stage once, both with success, and leave the files of one process.
#[test]
fn two_processes_share_a_sweep() {
    let block = block("shared");
    let whole = by_one(&block);
    let out = block.out();
    let workers = ["first", "second"].map(|name| Worker::start(&block, &out, name));
    let [first, second] = workers.map(|worker| {
        let (status, printed) = worker.end();
        assert_eq!(status, Some(0), "{printed}");
        assert!(printed.contains("5 cases in "), "{printed}");
        printed
    });
    let both = format!("{first}{second}");
    for case in NAMES {
        assert_eq!(computed(&both, case), 1, "{both}");
    }
    for own in [&first, &second] {
        assert!(NAMES.iter().any(|case| computed(own, case) == 1), "{both}");
    }
    assert_eq!(both.matches("stages took").count(), 2, "{both}");
    let [found, expected] = [&out, &whole].map(|folder| without_stages(folder));
    assert_eq!(found.1.len(), 2);
    assert!(found.1 == expected.1);
    let names: Vec<_> = found.0.keys().collect();
    assert!(names.into_iter().eq(expected.0.keys()));
    for (name, content) in &expected.0 {
        assert!(found.0[name] == *content, "{} differs", name.display());
    }
}

/// The files of a sweep by their names, and those of the stages, which are in the folder of the case that is the first to
/// need them, and in its lists.
fn without_stages(folder: &Path) -> (BTreeMap<PathBuf, Vec<u8>>, Vec<Vec<u8>>) {
    let (mut left, mut stages) = (BTreeMap::new(), Vec::new());
    for (name, content) in files(folder) {
        let is_list = name.ends_with("finished.json") || name.ends_with("summary.json");
        if name.ends_with("stages/1-weight.vtu") {
            stages.push(content);
        } else if is_list {
            let text = String::from_utf8(content).unwrap();
            let lines = text.lines().filter(|line| !line.is_empty());
            let lines = lines.filter(|line| !line.contains("\"stages/"));
            // A comma is missing behind the last line of a list.
            let lines = lines.map(|line| line.trim_end_matches(','));
            left.insert(name, lines.collect::<Vec<_>>().join("\n").into());
        } else {
            left.insert(name, content);
        }
    }
    (left, stages)
}

/// A process passes over a case that another one computes, waits for it when nothing else is left, and continues it from its
/// last checkpoint if the other is killed or interrupted: the files are those of one process.
#[cfg(unix)]
#[test]
fn a_process_takes_over_from_one_that_ends_early() {
    let block = block("taken-over");
    let whole = by_one(&block);
    for (signal, status) in [("-KILL", None), ("-INT", Some(130))] {
        let out = block.folder.join(format!("out{signal}"));
        let mut first = Worker::start(&block, &out, &format!("first{signal}"));
        let checkpoint = out.join("of-20/checkpoint/latest.run");
        first.until(|_| checkpoint.exists());
        // It computes its case, without an end.
        first.signal("-STOP");
        assert!(!out.join("of-20/finished.json").exists());
        let mut second = Worker::start(&block, &out, &format!("second{signal}"));
        let waits = "waits for cases that other processes compute: of-20\n";
        second.until(|second| second.printed().contains(waits));
        for case in NAMES {
            let expected = usize::from(case != "of-20");
            assert_eq!(computed(&second.printed(), case), expected, "{case}");
        }
        first.signal(signal);
        first.signal("-CONT");
        let (ended, printed) = first.end();
        assert_eq!(ended, status, "{printed}");
        assert_eq!(computed(&printed, "of-20"), 0, "{printed}");
        let (ended, printed) = second.end();
        assert_eq!(ended, Some(0), "{printed}");
        assert!(printed.contains("of-20: resumed after "), "{printed}");
        assert_eq!(computed(&printed, "of-20"), 1, "{printed}");
        assert_eq!(printed.matches(waits).count(), 1, "{printed}");
        assert_same_files(&out, &whole);
    }
}

/// A process whose cases are not those of the others in the folder is refused, and so is a run into it; a process with
/// another choice of the same cases is not, and the list of cases has those of both.
#[cfg(unix)]
#[test]
fn other_inputs_are_refused_in_a_shared_folder() {
    let block = block("others");
    let out = block.out();
    let mut first = Worker::start(&block, &out, "first");
    let checkpoint = out.join("of-20/checkpoint/latest.run");
    first.until(|_| checkpoint.exists());
    first.signal("-STOP");
    let of = |command: &str, arguments: &[&str]| {
        Worker::of(&block, (command, arguments), &out, "other").end()
    };
    let (status, printed) = of("sweep", &["--duration", "0.1"]);
    assert_eq!(status, Some(2), "{printed}");
    let refused = "another process computes a sweep of another scene, duration or program";
    assert!(printed.contains(refused), "{printed}");
    let (status, printed) = of("run", &[]);
    assert_eq!(status, Some(2), "{printed}");
    let holder = format!("another run (sweep begun by process {}", first.process.id());
    assert!(printed.contains(&holder), "{printed}");
    let (status, printed) = of("sweep", &["--case", "of-10"]);
    assert_eq!(status, Some(0), "{printed}");
    first.signal("-KILL");
    first.end();
    let cases = std::fs::read_to_string(out.join("cases.json")).unwrap();
    assert!(NAMES.iter().all(|case| cases.contains(case)), "{cases}");
}
