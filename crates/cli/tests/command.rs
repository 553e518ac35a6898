//! The command's output and exit status.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

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

/// A short scene in a folder of its own: the coarse cavern for a tenth of a second.
struct Scene {
    folder: PathBuf,
}

impl Scene {
    fn new(name: &str, change: impl Fn(String) -> String) -> Self {
        let folder =
            std::env::temp_dir().join(format!("powerhouse-cli-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let scene = std::fs::read_to_string(data("scenes/cavern_small.toml")).unwrap();
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
            .replace("duration = 20 ", "duration = 1.0 ");
        std::fs::write(folder.join("scene.toml"), change(scene)).unwrap();
        Self { folder }
    }
    fn path(&self) -> String {
        self.folder.join("scene.toml").display().to_string()
    }
    fn out(&self) -> String {
        self.folder.join("out").display().to_string()
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// `run` checks the free field first, runs, writes its files and says what it found; status 0.
#[test]
fn run_writes_results() {
    let scene = Scene::new("run", |scene| scene);
    let output = powerhouse(&["run", &scene.path(), "--out", &scene.out()]);
    let (told, errors) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{errors}");
    for passage in [
        "free field without the structure",
        "completed: ",
        "peaks",
        "crown.ux",
        "energies at the end (J)",
        "limited by",
        "summary.json",
    ] {
        assert!(told.contains(passage), "{passage}: {told}");
    }
    for file in [
        "summary.json",
        "histories.csv",
        "snapshots.pvd",
        "plots/crown.svg",
    ] {
        assert!(scene.folder.join("out").join(file).exists(), "{file}");
    }
}

/// A free field that errs by more than the scene permits stops the run before it starts; status 2.
#[test]
fn run_refuses_a_coarse_free_field() {
    let scene = Scene::new("coarse", |scene| {
        scene.replace("self_check = 0.02", "self_check = 1e-5")
    });
    let output = powerhouse(&["run", &scene.path(), "--out", &scene.out()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("above the scene's self_check = 0.00001"));
    assert!(!scene.folder.join("out").exists());
    let output = powerhouse(&["check", "--free-field", &scene.path()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stdout).contains("relative error"));
}

/// `check` says what a run would be; status 1, since the coarse mesh cannot carry all of the record.
#[test]
fn check_tells_by_its_status() {
    let scene = Scene::new("check", |scene| scene);
    let output = powerhouse(&["check", &scene.path()]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    for passage in [
        "7.97 Hz",
        "least scaled Jacobian",
        "steps, about",
        "of memory",
        "1 warning(s)",
    ] {
        assert!(told.contains(passage), "{passage}: {told}");
    }
    let weak = Scene::new("weak", |scene| {
        scene
            .replace("incidence = 30 ", "incidence = 90 ")
            .replace("\"sv\"", "\"p\"")
    });
    let output = powerhouse(&["check", &weak.path()]);
    assert_eq!(output.status.code(), Some(2));
}

/// A fault of a scene goes to the error stream with its place, nothing is run; status 2.
#[test]
fn a_fault_is_told_in_place() {
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
