//! The command's output and exit status.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use powerhouse_test_support::TestFolder;

fn powerhouse(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_powerhouse"))
        .args(arguments)
        .output()
        .unwrap()
}

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data")
        .join(file)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The mesh of a bay is reported and written for Gmsh and ParaView with a picture; an invalid bay is an error with its
/// key and range.
#[test]
fn mesh_writes_a_bay() {
    let folder = std::env::temp_dir().join(format!("powerhouse-cli-mesh-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = |name: &str| folder.join(name).display().to_string();
    std::fs::write(folder.join("bay.toml"), "size = \"coarse\"\n").unwrap();
    let made = powerhouse(&["mesh", &path("bay.toml"), "--out", &path("bay.msh")]);
    assert_eq!(made.status.code(), Some(0));
    assert!(text(&made.stdout).contains("15840 in the mesh"));
    for file in ["bay.msh", "bay.vtu", "bay.png"] {
        assert!(folder.join(file).exists(), "{file}");
    }
    std::fs::write(folder.join("bay.toml"), "[dimensions]\ncover = 20\n").unwrap();
    let refused = powerhouse(&["mesh", &path("bay.toml")]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("cover = 20 is outside its permitted range [60, 300]"));
    std::fs::remove_dir_all(folder).unwrap();
}

/// A sweep of a scene without cases, a missing case, and a report of a folder without results are errors in one line, with
/// exit status 2.
#[test]
fn errors_of_sweeps_and_reports_have_one_line() {
    let scene = |name: &str| data("scenes").join(name).display().to_string();
    for (arguments, wanted) in [
        (
            vec!["sweep", &scene("cavern_small.toml")],
            "has no [[case]]",
        ),
        (
            vec!["run", &scene("wang_2019.toml"), "--case", "flat"],
            "no case 'flat'; its cases are: sv-00",
        ),
        (
            vec!["report", &scene("nothing")],
            "neither a sweep nor a run",
        ),
    ] {
        let refused = powerhouse(&arguments);
        assert_eq!(refused.status.code(), Some(2));
        let said = text(&refused.stderr);
        assert!(said.contains(wanted) && said.lines().count() == 1, "{said}");
    }
}

/// A short scene in a folder of its own: the coarse cavern for a tenth of a second.
struct Scene {
    folder: TestFolder,
}

impl Scene {
    fn new(name: &str, change: impl Fn(String) -> String) -> Self {
        Self::of("cavern_small.toml", name, change)
    }
    /// Another one of the scenes on the coarse mesh.
    fn of(file: &str, name: &str, change: impl Fn(String) -> String) -> Self {
        let folder = TestFolder::new(&format!("cli-{name}"));
        let scene = std::fs::read_to_string(data("scenes").join(file)).unwrap();
        let path = |file: &str| data(file).canonicalize().unwrap().display().to_string();
        let scene = scene
            .replace(
                "../meshes/cavern_small.msh",
                &path("meshes/cavern_small.msh"),
            )
            .replace(
                "../records/el_centro_1940_ns.csv",
                &path("records/el_centro_1940_ns.csv"),
            )
            .replace("duration = 20 ", "duration = 1.0 ")
            .replace("duration = 6  ", "duration = 1.0 ");
        std::fs::write(folder.join("scene.toml"), change(scene)).unwrap();
        Self { folder }
    }
    fn path(&self) -> String {
        self.folder.join("scene.toml").display().to_string()
    }
    fn out(&self) -> String {
        self.folder.join("out").display().to_string()
    }
    /// The files in the folder of results.
    fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.join("out")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect()
    }
    /// Runs it, and sends it a signal as soon as a passage was printed or a file is there.
    #[cfg(unix)]
    fn run_and_signal(&self, signal: &str, is_time: impl Fn(&str) -> bool) -> (Output, String) {
        use std::io::{BufRead, BufReader};
        use std::process::Stdio;
        let mut run = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
            .args(["run", &self.path(), "--out", &self.out()])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut printed = String::new();
        let mut lines = BufReader::new(run.stdout.take().unwrap()).lines();
        while !printed.contains("stable up to") {
            printed += &(lines.next().unwrap().unwrap() + "\n");
        }
        while !is_time(&printed) && run.try_wait().unwrap().is_none() {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        let mut kill = Command::new("kill");
        let killed = kill.args([signal, &run.id().to_string()]).status();
        assert!(killed.unwrap().success());
        for line in lines {
            printed += &(line.unwrap() + "\n");
        }
        (run.wait_with_output().unwrap(), printed)
    }
}

/// `run` checks the free field first, runs, writes its files and prints its results; status 0.
#[test]
fn run_writes_results() {
    let scene = Scene::new("run", |scene| scene);
    let output = powerhouse(&["run", &scene.path(), "--out", &scene.out()]);
    let (printed, errors) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{errors}");
    for passage in [
        "free field without the structure",
        "completed: ",
        "peaks",
        "crown.ux",
        "energies at the end (J)",
        "of the input work",
        "limited by",
        "summary.json",
    ] {
        assert!(printed.contains(passage), "{passage}: {printed}");
    }
    // An energy that is always zero has no line.
    assert!(printed.contains("dashpots") && !printed.contains("friction"));
    for file in [
        "summary.json",
        "histories.csv",
        "snapshots.pvd",
        "plots/crown.svg",
    ] {
        assert!(scene.folder.join("out").join(file).exists(), "{file}");
    }
}

/// A run that is interrupted, by Ctrl-C or by the system, leaves complete output; status 130.
#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_complete_output() {
    for signal in ["-INT", "-TERM"] {
        let scene = Scene::new(&format!("signal{signal}"), |scene| {
            scene
                .replace("self_check = 0.02", "")
                .replace("duration = 1.0 ", "duration = 1000 ")
                .replace("every = 0.5", "every = 0.01")
        });
        let second = scene.folder.join("out/snapshots/snapshots_00001.vtu");
        let (output, printed) = scene.run_and_signal(signal, |_| second.exists());
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{signal}: {errors}");
        assert!(printed.contains("interrupted: "), "{printed}");
        let read = |file: &str| std::fs::read_to_string(scene.folder.join("out").join(file));
        assert!(read("summary.json").unwrap().contains("\"stopped\""));
        // Every snapshot of the collection is there, and the histories go as far, to the last multiple of their interval.
        let collection = read("snapshots.pvd").unwrap();
        let shots: Vec<&str> = collection.split("file=\"").skip(1).collect();
        assert!(shots.len() >= 2);
        for shot in shots {
            let file = scene
                .folder
                .join("out")
                .join(shot.split('"').next().unwrap());
            assert!(file.metadata().unwrap().len() > 0, "{}", file.display());
        }
        let last = |text: String, before: &str, after: char| -> f64 {
            let (_, number) = text.rsplit_once(before).unwrap();
            number.split(after).next().unwrap().parse().unwrap()
        };
        let shot = last(collection, "timestep=\"", '"');
        let row = last(read("histories.csv").unwrap().trim_end().into(), "\n", ',');
        assert!(shot >= 0.01 && row >= shot - 0.005, "{shot} {row}");
    }
}

/// Ctrl-C during the self-check ends it, and nothing is run; status 130.
#[cfg(unix)]
#[test]
fn the_self_check_can_be_interrupted() {
    let scene = Scene::new("self-check", |scene| {
        scene.replace("duration = 1.0 ", "duration = 20 ")
    });
    let (output, printed) = scene.run_and_signal("-INT", |_| true);
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert!(printed.contains("nothing was run"), "{printed}");
    assert_eq!(scene.files(), Vec::<String>::new());
}

/// A folder that cannot be written to is an error before anything is computed; status 2.
#[test]
fn a_folder_that_cannot_be_written_to_is_refused_first() {
    let scene = Scene::new("folder", |scene| scene);
    let output = powerhouse(&["run", &scene.path(), "--out", &scene.path()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("scene.toml"));
    assert!(!text(&output.stdout).contains("free field"));
}

/// A run that fails reports it and leaves its results until then; status 2.
#[test]
fn a_failed_run_leaves_what_it_had() {
    let scene = Scene::new("failed", |scene| {
        // A balance that rounding breaks.
        scene.replace("self_check = 0.02", "energy_residual = 1e-30")
    });
    let output = powerhouse(&["run", &scene.path(), "--out", &scene.out()]);
    assert_eq!(output.status.code(), Some(2));
    let errors = text(&output.stderr);
    assert!(errors.contains("energy"), "{errors}");
    assert!(text(&output.stdout).contains("failed: "));
    let files = scene.files();
    for file in ["summary.json", "histories.csv", "snapshots.pvd"] {
        assert!(files.contains(&file.into()), "{file}: {files:?}");
    }
}

/// A free-field error above the limit of the scene prevents the run; status 2.
#[test]
fn run_refuses_a_coarse_free_field() {
    let scene = Scene::new("coarse", |scene| {
        scene.replace("self_check = 0.02", "self_check = 1e-5")
    });
    let output = powerhouse(&["run", &scene.path(), "--out", &scene.out()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("above the scene's self_check = 0.00001"));
    assert_eq!(scene.files(), Vec::<String>::new());
    let output = powerhouse(&["check", "--free-field", &scene.path()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stdout).contains("relative error"));
}

/// `check` reports on a run; status 1, since the coarse mesh does not resolve the whole record.
#[test]
fn check_warns_by_its_status() {
    let scene = Scene::new("check", |scene| scene);
    let output = powerhouse(&["check", &scene.path()]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    for passage in [
        "7.97 Hz",
        "least scaled Jacobian",
        "steps, about",
        " memory, at most ",
        "the highest frequency that 'rock' resolves",
        "warning: the run ends at 1.000 s, before record 'el-centro-ns' ends at 20.000 s",
    ] {
        assert!(printed.contains(passage), "{passage}: {printed}");
    }
    let weak = Scene::new("weak", |scene| {
        scene
            .replace("incidence = 30 ", "incidence = 90 ")
            .replace("\"sv\"", "\"p\"")
    });
    let output = powerhouse(&["check", &weak.path()]);
    assert_eq!(output.status.code(), Some(2));
}

/// `check` lists the boxes of mesh and sets, and the sections with area, extents and centroid; a section through crown and
/// floor of a closed lining is warned of as a frame.
#[test]
fn check_lists_sets_and_sections() {
    let printed = |name: &str, limit: &str| {
        let scene = Scene::new(name, |scene| scene.replace("half_extent = 10\n", limit));
        text(&powerhouse(&["check", &scene.path()]).stdout)
    };
    let one = printed("check-section", "half_extent = 10\n");
    let line = |start: &str, printed: &str| {
        let found = printed
            .lines()
            .find(|line| line.trim_start().starts_with(start));
        found
            .unwrap_or_else(|| panic!("{start}: {printed}"))
            .to_owned()
    };
    assert!(
        one.contains("\nsets\n") && one.contains("\nsections\n"),
        "{one}"
    );
    let lining = line("lining ", &one);
    assert!(
        lining.contains(" elements, (") && lining.ends_with(" m"),
        "{lining}"
    );
    let crown = line("lining-crown", &one);
    assert!(
        crown.contains(" m2, ") && crown.contains(" m along and "),
        "{crown}"
    );
    assert!(!one.contains("do not touch"), "{one}");
    let both = printed("check-both", "");
    let pieces = line("lining-crown", &both);
    assert!(pieces.contains(" m along and "), "{pieces}");
    assert!(
        both.contains("section 'lining-crown' of 'lining' fills 14 % of its 53.000 m along"),
        "{both}"
    );
}

/// `check` lists joints with their law, pairs, area and worst mismatch, and how far they may slip; it
/// warns where one meets an absorbing face.
#[test]
fn check_lists_joints() {
    let scene = Scene::of("cavern_joint.toml", "check-joint", |scene| scene);
    let printed = text(&powerhouse(&["check", &scene.path()]).stdout);
    for passage in [
        "rock-lining      bonded-coulomb, 262 node pairs on 7221.02 m2, paired nodes at most 0.00e0 m apart",
        "shortest edge 1.500 m: slip and opening are small up to about 0.150 m",
    ] {
        assert!(printed.contains(passage), "{passage}: {printed}");
    }
    assert!(!printed.contains("lie on absorbing faces"), "{printed}");
}

/// `run` prints and writes the results of the joints; it warns of slips that are too large for fixed node pairs.
#[test]
fn run_reports_the_state_of_joints() {
    let scene = Scene::of("cavern_joint.toml", "run-joint", |scene| {
        scene
            .replace("self_check = 0.02", "")
            .replace("= 1.0e6    #", "= 0 #")
            .replace("cohesion = 1.0e6 ", "cohesion = 0 ")
            .replace("duration = 1.0 ", "duration = 1.5 ")
            .replace("peak = 1.7 ", "peak = 100 ")
            .replace("\ntitle", "\nallow = [\"magnitudes\"]\ntitle")
    });
    let output = powerhouse(&["run", &scene.path(), "--out", &scene.out()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    for passage in [
        "\njoints\n  rock-lining ",
        "at-crown ",
        " % slipped from ",
        " % opened from ",
        " s on, first at (",
        "bond broken on 0.0 %, never bonded on 100.0 %; friction ",
        "pairs of 'rock-lining' with shared nodes took at most ",
        "friction ",
        "impact ",
        "warning: joint 'rock-lining' slipped or opened by ",
        "joints.csv",
        "plots/joint-at-crown.svg",
    ] {
        assert!(printed.contains(passage), "{passage}: {printed}");
    }
    let file = |name: &str| std::fs::read_to_string(scene.folder.join("out").join(name)).unwrap();
    assert!(file("snapshots.pvd").contains("_rock-lining.vtu"));
    let summary = file("summary.json");
    assert!(
        summary.contains("\"first_slip\"") && summary.contains("slipped or opened by"),
        "{summary}"
    );
}

/// A fault of a scene is printed to the error stream with its position, nothing is run; status 2.
#[test]
fn a_fault_is_reported_with_its_position() {
    let scene = Scene::new("fault", |scene| {
        scene.replace("poisson = 0.27", "poison = 0.27")
    });
    for command in [&["run"][..], &["check"], &["check", "--free-field"]] {
        let path = scene.path();
        let arguments: Vec<&str> = command.iter().copied().chain([path.as_str()]).collect();
        let output = powerhouse(&arguments);
        assert_eq!(output.status.code(), Some(2));
        let errors = text(&output.stderr);
        assert!(
            errors.starts_with("error: unknown key 'poison'"),
            "{errors}"
        );
        assert!(errors.contains("did you mean 'poisson'?"), "{errors}");
        assert!(output.stdout.is_empty());
    }
    let output = powerhouse(&["run", "no-such-scene.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("cannot read no-such-scene.toml"));
}

/// `schema` prints JSON.
#[test]
fn schema_is_printed() {
    let output = powerhouse(&["schema"]);
    assert_eq!(output.status.code(), Some(0));
    let schema = text(&output.stdout);
    assert!(schema.starts_with('{') && schema.contains("\"self_check\""));
}

/// `drive` runs a material test along a path: the paper's concrete opens, closes and crushes; the table contains the
/// history variables of the law, and a fault of the path is reported with its position.
#[test]
fn drive_tests_a_material() {
    let scene = Scene::new("drive", |scene| {
        scene.replace(
            "name = \"concrete\"\nlaw = \"elastic\"\nyoung = 25.0e9\npoisson = 0.17\ndensity = 2500\n",
            "name = \"concrete\"\nlaw = \"plastic-damage\"\npreset = \"paper-c25\"\n",
        )
    });
    let path = scene.folder.join("path.toml").display().to_string();
    let drive = |text: &str| {
        std::fs::write(&path, text).unwrap();
        let (law, out) = (scene.path(), scene.out());
        powerhouse(&[
            "drive",
            &law,
            &path,
            "--material",
            "concrete",
            "--out",
            &out,
        ])
    };
    let cycle = "size = 0.5\n[[leg]]\nkind = \"cyclic\"\nstrains = [3e-4, -1e-3]\nsteps = 50\n\
                 [[leg]]\nkind = \"mixed\"\nzz = { strain = 0 }\nxx = { stress = -1e5 }\nyy = { stress = -1e5 }\n";
    let output = drive(cycle);
    let (printed, errors) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{errors}");
    for passage in [
        "plastic-damage: 200 steps",
        "waves of wave number k grow as exp(k t ",
        "warning: ",
        "damage_type 3",
        "point.svg",
    ] {
        assert!(printed.contains(passage), "{passage}: {printed}");
    }
    let table = std::fs::read_to_string(scene.folder.join("out/point.csv")).unwrap();
    assert_eq!(table.lines().count(), 202);
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let place = |name: &str| {
        header
            .iter()
            .position(|column| column.starts_with(name))
            .unwrap()
    };
    let value = |row: usize, name: &str| -> f64 {
        let row = table.lines().nth(1 + row).unwrap();
        row.split(',').nth(place(name)).unwrap().parse().unwrap()
    };
    // The surface in force yields at 1.006 MPa: G / (h f) = 264 microstrains leave a tail at 300.
    let peak = (0..=50)
        .map(|row| value(row, "stress zz"))
        .fold(0.0, f64::max);
    assert!((0.97e6..1.006e6).contains(&peak), "{peak}");
    assert!(value(50, "damage_tension") > 0.5 && value(50, "strain zz") == 3e-4);
    assert!(value(100, "stress zz") < -5e6);
    assert!((value(200, "stress xx") + 1e5).abs() < 1.0);

    for (wrong, place, message) in [
        (
            "[[leg]]\nkind = \"uniaxal\"\nstrain = 1\n",
            "path.toml:2:",
            "'uniaxal' is not permitted",
        ),
        ("size = -1\nleg = []\n", "path.toml:1:", "a number above 0"),
        (
            "[[leg]]\nkind = \"mixed\"\nxx = { strain = 0, stress = 0 }\n",
            "path.toml:3:",
            "exactly one of strain, stress",
        ),
        ("leg = []\n[[leg]]\n", "path.toml:2:", "duplicate"),
        (
            "[[leg]]\nkind = \"triaxial\"\nlateral = 5e6\nstrain = 0\n",
            "path.toml:1:",
            "misses its target",
        ),
    ] {
        let output = drive(wrong);
        let printed = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        assert!(
            printed.contains(place) && printed.contains(message),
            "{wrong}: {printed}"
        );
    }
    // A lateral tension beyond its strength: the steps before are written.
    let output = drive(
        "[[leg]]\nkind = \"uniaxial\"\nstrain = -2e-4\nsteps = 10\n\
         [[leg]]\nkind = \"mixed\"\nxx = { stress = 5e6 }\nsteps = 20\n",
    );
    let (printed, errors) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("path.toml:5:") && errors.contains("misses its target"),
        "{errors}"
    );
    let table = std::fs::read_to_string(scene.folder.join("out/point.csv")).unwrap();
    let rows = table.lines().count() - 1;
    assert!((12..31).contains(&rows), "{rows}");
    assert!(printed.contains(&format!("{} steps", rows - 1)) && printed.contains("point.csv"));
    let strain = table.lines().nth(11).unwrap().split(',').nth(3).unwrap();
    assert_eq!(strain.parse::<f64>().unwrap(), -2e-4, "{table}");
    // A width at which the concrete snaps back.
    let output = drive("size = 20\nleg = []\n");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("snaps back"));
}

/// Stages of the coarse cavern before its run: the ground on rollers, with the cavern open, then its
/// lining and two bolts.
const STAGES: &str = r#"
[in_situ_stress]
kind = "ground"
level = 0
density = 2750
lateral = 0.6

[[load]]
kind = "gravity"

[[bolt]]
name = "roof"
diameter = 0.025
lines = [[[0, 1, -60], [0, 1, -52]], [[0, 4, -60], [0, 4, -52]]]

[[stage]]
name = "cavern"
support = [
    { kind = "roller", set = "left" },
    { kind = "roller", set = "right" },
    { kind = "roller", set = "front" },
    { kind = "roller", set = "back" },
    { kind = "roller", set = "bottom" },
]

[[stage]]
name = "lining"
cast = ["lining"]
bolts = ["roof"]

[time]
"#;

/// `check` lists the stages of a scene; `run` computes them, prints and writes their results.
#[test]
fn stages_are_listed_and_run() {
    let scene = Scene::new("stages", |scene| {
        let scene = scene.replace("[time]", STAGES);
        let scene = scene.replace("self_check = 0.02", "");
        scene.replace("duration = 1.0 ", "duration = 0.05 ")
    });
    let check = text(&powerhouse(&["check", &scene.path()]).stdout);
    for line in [
        "cavern           5 supports",
        "lining           160 elements cast, 2 bolts of 'roof'",
    ] {
        assert!(check.contains(line), "{check}");
    }
    let run = powerhouse(&["run", &scene.path(), "--out", &scene.out()]);
    let printed = text(&run.stdout);
    assert_eq!(run.status.code(), Some(0), "{printed}{}", text(&run.stderr));
    for passage in [
        "stage 1 of 2, 'cavern'",
        "stage 2 of 2, 'lining'",
        "bolts\n  roof",
    ] {
        assert!(printed.contains(passage), "{printed}");
    }
    for file in ["1-cavern.vtu", "2-lining.vtu", "2-lining-roof.csv"] {
        assert!(
            scene.folder.join("out/stages").join(file).exists(),
            "{file}"
        );
    }
}

/// A check forecasts elements and messages of ranks, and refuses more of them than there are blocks of elements.
#[test]
fn a_check_forecasts_ranks() {
    let scene = data("scenes/cavern_small.toml").display().to_string();
    let check = |ranks: &str| powerhouse(&["check", &scene, "--ranks", ranks]);
    let said = text(&check("2").stdout);
    for wanted in [
        "on 2 ranks",
        "nodes shared",
        "1 to 1 messages a step",
        "memory a rank",
    ] {
        assert!(said.contains(wanted), "{wanted}: {said}");
    }
    let refused = check("1000");
    assert_eq!(refused.status.code(), Some(2));
    let said = text(&refused.stderr);
    assert!(said.contains("1000 ranks"), "{said}");
}

/// Several processes that know nothing of each other, as under `mpirun` without the feature `mpi`, are refused: each would
/// write the same files. Commands other than `run` and `sweep` are refused in any case.
#[test]
fn processes_without_communication_are_refused() {
    let folder = TestFolder::new("processes");
    let scene = data("scenes/cavern_small.toml").display().to_string();
    let out = folder.join("results");
    let launched = |arguments: &[&str]| {
        let refused = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
            .args(arguments)
            .env("OMPI_COMM_WORLD_SIZE", "3")
            .output()
            .unwrap();
        assert_eq!(refused.status.code(), Some(2));
        text(&refused.stderr)
    };
    let said = launched(&["check", &scene]);
    assert!(said.contains("3 processes were started"), "{said}");
    if cfg!(not(feature = "mpi")) {
        let said = launched(&["run", &scene, "--out", &out.display().to_string()]);
        assert!(said.contains("built without MPI"), "{said}");
        assert!(!out.exists());
    }
}
