//! States that a run keeps, and variants that start from them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse_test_support::{EVERYTHING, TestFolder};

/// Text of a scene with everything that a run can have, for a tenth of a second, that keeps two states.
fn scene() -> String {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let data = data.canonicalize().unwrap();
    let text = EVERYTHING
        .replace("../", &format!("{}/", data.display()))
        .replace("duration = 1\n", "duration = 0.1\n");
    format!("{text}[checkpoint]\nevery = \"never\"\nkeep = [0.06, 0.03]\n")
}

struct Runs {
    folder: TestFolder,
    file: PathBuf,
}

impl Runs {
    /// A folder with the results of a run of [`scene`].
    fn new(name: &str) -> Self {
        let folder = TestFolder::new(name);
        let file = folder.join("scene.toml");
        let runs = Self { folder, file };
        fs::write(&runs.file, scene()).unwrap();
        let run = runs.run(&[], "whole");
        assert!(run.status.success(), "{}", text(&run.stderr));
        runs
    }

    fn path(&self, name: &str) -> String {
        self.folder.join(name).display().to_string()
    }

    /// Runs the scene with some arguments and results in a folder.
    fn run(&self, arguments: &[&str], out: &str) -> Output {
        let file = self.file.display().to_string();
        Command::new(env!("CARGO_BIN_EXE_powerhouse"))
            .args(["run", &file, "--out", &self.path(out)])
            .args(arguments)
            .output()
            .unwrap()
    }

    /// Runs the scene from a state of the first run.
    fn variant(&self, time: &str, out: &str) -> Output {
        self.run(&["--from", &format!("{}@{time}", self.path("whole"))], out)
    }

    /// The lines of a table of results.
    fn lines(&self, folder: &str, name: &str) -> Vec<String> {
        let text = fs::read_to_string(self.folder.join(folder).join(name)).unwrap();
        text.lines().map(String::from).collect()
    }

    /// The rows of numbers of a table of results.
    fn rows(&self, folder: &str, name: &str) -> Vec<String> {
        let mut lines = self.lines(folder, name);
        lines.retain(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        lines
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A run from a state that was kept is the same motion to the bit: but for that of the state its tables are the last rows of
/// those of the whole run, its final snapshot is the same; the state says when it was taken, and the results where the run began.
#[test]
fn a_run_from_a_kept_state_goes_on_with_the_same_bits() {
    let runs = Runs::new("cli-kept");
    let mut kept: Vec<String> = fs::read_dir(runs.folder.join("whole/kept"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    kept.sort();
    assert_eq!(kept, ["0.03s.run", "0.06s.run", "stages.body"]);
    let variant = runs.variant("0.06s", "variant");
    assert!(variant.status.success(), "{}", text(&variant.stderr));
    let said = "starts from the state at t = 0.06";
    assert!(
        text(&variant.stdout).contains(said),
        "{}",
        text(&variant.stdout)
    );
    let summary = runs.lines("variant", "summary.json").join("\n");
    assert!(summary.contains(said), "{summary}");
    for table in [
        "histories.csv",
        "sections.csv",
        "joints.csv",
        "bolts.csv",
        "energies.csv",
    ] {
        let [whole, part] = ["whole", "variant"].map(|folder| runs.rows(folder, table));
        // The first row is that of the state, between two rows of the whole run.
        let part = &part[1..];
        let rows = part.len();
        assert!(rows >= 4 && rows < whole.len(), "{table}: {rows}");
        assert!(&whole[whole.len() - rows..] == part, "{table}");
    }
    let [whole, part] = ["whole", "variant"].map(|folder| {
        let folder = runs.folder.join(folder).join("snapshots");
        let files = fs::read_dir(folder).unwrap();
        let mut files: Vec<PathBuf> = files.map(|entry| entry.unwrap().path()).collect();
        files.retain(|file| file.extension().is_some_and(|ending| ending == "vtu"));
        files.sort();
        fs::read(files.last().unwrap()).unwrap()
    });
    assert!(whole == part, "the last snapshots differ");
}

/// Duration, output and later waves may change, which the results tell; what acts before the state may not, and is named.
#[test]
fn a_variant_changes_what_is_still_to_come() {
    let runs = Runs::new("cli-kept-variant");
    let later = "\n[[wave]]\nkind = \"p\"\nincidence = 0\narrival = 0.05\n\
                 pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.05 }\n";
    let longer = scene()
        .replace("duration = 0.1\n", "duration = 0.12\n")
        .replace("every = 0.004\n", "every = 0.002\n");
    fs::write(&runs.file, longer.clone() + later).unwrap();
    let variant = runs.variant("0.03", "later");
    assert!(variant.status.success(), "{}", text(&variant.stderr));
    let summary = runs.lines("later", "summary.json").join("\n");
    for changed in ["duration", "key 'output.every'", "key 'wave'"] {
        assert!(summary.contains(changed), "{changed}: {summary}");
    }
    let [whole, part] = ["whole", "later"].map(|folder| runs.lines(folder, "histories.csv"));
    assert!(part.len() > whole.len(), "{} rows", part.len());
    assert_ne!(whole.last(), part.last());

    // It has a checkpoint of its own and keeps what it is asked for.
    assert!(runs.folder.join("later/kept/0.06s.run").is_file());
    assert!(!runs.folder.join("later/kept/0.03s.run").exists());

    let refused = |edited: String, time: &str, expected: &str| {
        fs::write(&runs.file, edited).unwrap();
        let refused = runs.variant(time, "refused");
        let errors = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{errors}");
        assert!(errors.contains(expected), "{expected}: {errors}");
        assert!(!runs.folder.join("refused").exists(), "{expected}");
    };
    refused(
        scene() + &later.replace("arrival = 0.05", "arrival = 0.001"),
        "0.06",
        "its incident waves have another motion at t = 0.06",
    );
    refused(
        scene().replace("cohesion = 3e5", "cohesion = 2e5"),
        "0.06",
        "key 'material' must be as in the run",
    );
    refused(
        scene()
            .replace("duration = 0.1\n", "duration = 0.05\n")
            .replace("0.06, ", ""),
        "0.06",
        "the run ends at t = 0.05 s",
    );
    refused(scene(), "0.05", "there are states at 0.03 s, 0.06 s");
    let same = runs.variant("0.06", "whole");
    let errors = text(&same.stderr);
    assert!(
        errors.contains("choose another folder with --out"),
        "{errors}"
    );
    assert!(runs.folder.join("whole/histories.csv").is_file());
}

/// A block whose base moves by a record.
const PRESCRIBED: &str = r#"
title = "base"
[mesh]
file = "mesh.msh"
[[material]]
name = "rock"
law = "elastic"
young = 2e9
poisson = 0.25
density = 2600
[[part]]
set = "rock"
material = "rock"
[[record]]
name = "base"
file = "record.txt"
units = "m/s2"
time_step = 0.01
peak = 1
convention = "incident"
baseline = { kind = "velocity-polynomial", order = 3 }
[[support]]
kind = "prescribed"
set = "bottom"
direction = [1, 0, 0]
record = "base"
[time]
duration = 0.3
[output]
every = 0.05
[[output.history]]
name = "top"
at = [10, 10, 20]
[checkpoint]
every = "never"
keep = [0.1]
"#;

/// The record of a prescribed motion must be as in the run, unlike that of a wave; output may change.
#[test]
fn a_variant_has_the_prescribed_motion_of_the_run() {
    let folder = TestFolder::new("cli-kept-prescribed");
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(20.0), [2; 3], "rock");
    write_gmsh(folder.join("mesh.msh"), &mesh.unwrap()).unwrap();
    let samples = (0..=40).map(|i| (0.314 * f64::from(i)).sin());
    let record: String = samples.map(|sample| format!("{sample:e}\n")).collect();
    fs::write(folder.join("record.txt"), record).unwrap();
    let file = folder.join("scene.toml");
    let runs = Runs { folder, file };
    fs::write(&runs.file, PRESCRIBED).unwrap();
    let whole = runs.run(&[], "whole");
    assert!(whole.status.success(), "{}", text(&whole.stderr));
    fs::write(
        &runs.file,
        PRESCRIBED.replace("every = 0.05", "every = 0.02"),
    )
    .unwrap();
    let finer = runs.variant("0.1", "finer");
    assert!(finer.status.success(), "{}", text(&finer.stderr));
    fs::write(&runs.file, PRESCRIBED.replace("peak = 1", "peak = 2")).unwrap();
    let refused = runs.variant("0.1", "refused");
    let errors = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("key 'record' must be as in the run"),
        "{errors}"
    );
}

/// Times outside of the run, and intervals without a unit, are refused with the place in the file.
#[test]
fn impossible_checkpoints_are_refused() {
    let folder = TestFolder::new("cli-kept-refused");
    let file = folder.join("scene.toml");
    for (from, to, expected) in [
        (
            "keep = [0.06, 0.03]",
            "keep = [0.1]",
            "expected a time (s) after the start of the run, 0, and before its end, 0.1",
        ),
        (
            "keep = [0.06, 0.03]",
            "keep = [0]",
            "expected a time (s) after the start",
        ),
        ("\"never\"", "\"10\"", "expected a time above 0 with a unit"),
    ] {
        let edited = scene().replace(from, to);
        fs::write(&file, edited).unwrap();
        let refused = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
            .args(["run", &file.display().to_string()])
            .output()
            .unwrap();
        let errors = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{errors}");
        assert!(errors.contains(expected), "{expected}: {errors}");
        assert!(errors.contains("scene.toml:"), "{errors}");
    }
}
