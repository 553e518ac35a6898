//! What `check` says that runs cost, against what they cost: wall time of the steps, and memory.
//!
//! Builds on `cavern`. Three scenes of the lined cavern that no figure of the cost model was fitted to,
//! an elastic one on the fine mesh, one that yields and cracks, and one with a joint, are checked and
//! then run for some tenths of a second of their record, each in a process of its own so that its memory
//! is its own. Memory is what Linux says of the process; elsewhere it is not measured.
//!
//! ```text
//!        scene ---- check: steps, wall time, memory
//!          |                        |
//!         run ---- steps taken, wall time, most memory held
//! ```
//!
//! Run from the top of the project: `cargo run --release --example cost_model`

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use powerhouse::{RunHooks, Scene};
use powerhouse_examples::{Figures, Outcome};

/// The most by which prediction and measurement may differ, one over the other.
const LIMIT: f64 = 1.25;
/// Scenes, how much of them is run (s), and the names of their figures.
const SCENES: [(&str, f64, &str); 3] = [
    ("cavern.toml", 0.5, "elastic"),
    ("cavern_damage.toml", 1.0, "cracking"),
    ("cavern_joint.toml", 1.5, "jointed"),
];

/// Wall time (s) and memory (bytes).
#[derive(Clone, Copy, Debug)]
struct Cost {
    time: f64,
    memory: f64,
}

fn scene(file: &str, duration: f64) -> Outcome<Scene> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../data/scenes")
        .join(file);
    Ok(Scene::from_file(path)?.duration(duration).threads(1))
}

fn predicted(file: &str, duration: f64) -> Outcome<Cost> {
    let cost = powerhouse_study::check(scene(file, duration)?)?.cost;
    Ok(Cost {
        time: cost.wall_time.as_secs_f64(),
        memory: cost.memory as f64,
    })
}

/// Runs a scene and writes its results, as the command does, and tells what that took.
fn run(file: &str, duration: f64, folder: PathBuf) -> Outcome<Cost> {
    let scene = scene(file, duration)?;
    let (title, mesh) = (scene.title().to_owned(), scene.mesh().clone());
    let folder = powerhouse::ResultFolder::new(folder);
    folder.create()?;
    let mut simulation = scene.prepare()?;
    simulation.stable_step()?;
    let remarks = simulation.remarks().to_vec();
    let hooks = RunHooks {
        snapshots: Some(folder.snapshots(&mesh, simulation.joint_surfaces())?),
        ..RunHooks::default()
    };
    let results = simulation.run(hooks)?;
    folder.write((&title, &mesh), &results, &remarks, None)?;
    Ok(Cost {
        time: results.wall_time.as_secs_f64(),
        memory: most_memory().unwrap_or(f64::NAN),
    })
}

/// The most memory that this process has held (bytes), where the system tells.
fn most_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024.0 * kilobytes)
}

/// The same in a process of its own.
fn measured(file: &str, duration: f64) -> Outcome<Cost> {
    let name = format!("powerhouse-cost-{}-{file}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    let output = Command::new(std::env::current_exe()?)
        .args(["run", file, &duration.to_string()])
        .arg(&folder)
        .output()?;
    std::fs::remove_dir_all(&folder)?;
    let text = String::from_utf8(output.stdout)?;
    let numbers: Vec<f64> = text
        .split_whitespace()
        .filter_map(|x| x.parse().ok())
        .collect();
    match numbers[..] {
        [time, memory] => Ok(Cost { time, memory }),
        _ => Err(String::from_utf8_lossy(&output.stderr).into()),
    }
}

/// How far two costs are apart, the larger over the smaller.
fn apart(one: f64, other: f64) -> f64 {
    (one / other).max(other / one)
}

fn main() -> Outcome<ExitCode> {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, word, file, duration, folder] = &arguments[..]
        && word == "run"
    {
        let cost = run(file, duration.parse()?, folder.into())?;
        println!("{} {}", cost.time, cost.memory);
        return Ok(ExitCode::SUCCESS);
    }
    let mut figures = Figures::default();
    for (file, duration, name) in SCENES {
        let (expected, found) = (predicted(file, duration)?, measured(file, duration)?);
        let label = |what: &str| format!("cost_model.{name}.{what}");
        for (what, expected, found) in [
            ("time", expected.time, found.time),
            ("memory", expected.memory, found.memory),
        ] {
            figures.report(&label(&format!("predicted_{what}")), expected, "");
            if found.is_nan() {
                continue;
            }
            figures.report(&label(&format!("measured_{what}")), found, "");
            figures.at_most(
                &label(&format!("{what}_apart")),
                apart(expected, found),
                LIMIT,
            );
        }
    }
    Ok(figures.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Prediction and run are of the same scene, and a cost is as far above as below another.
    #[test]
    fn costs_are_of_the_same_scene() {
        let (file, duration, _) = SCENES[2];
        let expected = predicted(file, duration).unwrap();
        assert!(expected.time > 0.0 && expected.memory > 1e7);
        assert_eq!(scene(file, duration).unwrap().run_duration(), duration);
        assert_eq!((apart(2.0, 1.0), apart(1.0, 2.0)), (2.0, 2.0));
    }
}
