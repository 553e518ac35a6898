//! Predictions of `check` for wall time and memory of runs and construction stages, compared with measurements.
//!
//! Builds on `cavern`. Three scenes of the lined cavern to which the cost model was not fitted, an elastic one on the fine
//! mesh, one with yielding and cracking, and one with a joint, are checked and then run for some tenths of a second, each in
//! a process of its own so that its memory can be measured. The stages of three scenes are computed in the same way: of the
//! lined cavern on the coarse and on the fine mesh, and of a machine bay with two caverns. Of boxes of bricks, wedges and
//! tetrahedra, regular and distorted, in every number format, the memory of a run is measured. Memory is measured on
//! Linux only.
//!
//! ```text
//!        scene ---- check: steps, wall time, memory
//!          |                        |
//!      run or stages ---- wall time, peak memory
//! ```
//!
//! Run from the top of the project: `cargo run --release --example cost_model`

use powerhouse::{Boundary, FileScene, Material, Part, RunHooks, Scene};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::Precision;
use powerhouse::io::peak_memory;
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, MeshError, Vec3};
use powerhouse_examples::process::apart_from_this;
use powerhouse_examples::{Figures, Outcome};

/// Greatest permitted ratio of prediction and measurement, either way.
const LIMIT: f64 = 1.25;
/// Greatest permitted ratio for the memory of stages, and of boxes.
const MEMORY_LIMIT: f64 = 1.33;
/// Scenes, durations of their runs (s), and names of their figures.
const SCENES: [(&str, f64, &str); 3] = [
    ("cavern.toml", 0.5, "elastic"),
    ("cavern_damage.toml", 1.0, "cracking"),
    ("cavern_joint.toml", 1.5, "jointed"),
];

/// Scenes whose stages are computed, the mesh that replaces theirs, and names of their figures.
const STAGED: [(&str, Option<&str>, &str); 3] = [
    ("cavern_staged.toml", None, "staged"),
    ("cavern_staged.toml", Some("cavern.msh"), "staged_fine"),
    ("wang_2019.toml", None, "bay"),
];

/// Wall time (s) and memory (bytes).
#[derive(Clone, Copy, Debug)]
struct Cost {
    time: f64,
    memory: f64,
}

fn path(file: &str) -> PathBuf {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/scenes");
    scenes.join(file)
}

fn scene(file: &str, duration: f64) -> Outcome<Scene> {
    Ok(FileScene::from_file(path(file))?
        .into_scene()
        .with_duration(duration)
        .with_threads(1))
}

/// Boxes of one kind of element, regular or with inner nodes out of place, and number formats; names of their figures.
const BOXES: [(BoxOf, bool, Precision, &str); 7] = [
    (Mesh::box_of_hexes, false, Precision::F64, "bricks"),
    (Mesh::box_of_hexes, true, Precision::F64, "distorted"),
    (
        Mesh::box_of_hexes,
        true,
        Precision::Mixed,
        "distorted_mixed",
    ),
    (Mesh::box_of_hexes, true, Precision::F32, "distorted_single"),
    (Mesh::box_of_tets, true, Precision::F64, "tetrahedra"),
    (Mesh::box_of_tets, true, Precision::F32, "tetrahedra_single"),
    (Mesh::box_of_wedges, true, Precision::F64, "wedges"),
];
/// Numbers of cells of a box, and their edge (m); of tetrahedra and wedges there are fewer cells.
const CELLS: [[usize; 3]; 2] = [[70, 50, 40], [40, 30, 25]];
const EDGE: f64 = 10.0;

/// Function that generates a box.
type BoxOf = fn(Vec3, Vec3, [usize; 3], &str) -> Result<Mesh, MeshError>;

/// A box of elastic rock on springs and dashpots, with a name.
fn block(name: &str) -> Outcome<Scene> {
    let found = BOXES.iter().find(|(.., other)| *other == name);
    let (generate, distorted, precision, _) = found.ok_or("no such box")?;
    let low = Vec3::zeros();
    let probe = generate(low, Vec3::repeat(EDGE), [1; 3], "rock")?;
    let [bricks, others] = CELLS;
    let cells = if probe.element_count() == 1 {
        bricks
    } else {
        others
    };
    let high = Vec3::from(cells.map(|count| EDGE * count as f64));
    let mesh = generate(low, high, cells, "rock")?;
    let mesh = match distorted {
        false => mesh,
        // Nodes of the faces stay in them.
        true => mesh.map_positions(|x| {
            let wave = |along: usize, phase: f64| {
                let inner = (core::f64::consts::PI * x[along] / high[along]).sin();
                1.5 * inner * (1.7 * x.sum() + phase).sin()
            };
            x + Vec3::new(wave(0, 0.0), wave(1, 1.0), wave(2, 2.0))
        })?,
    };
    let rock = LinearElastic::new(ElasticMedium::new(9.0e9, 0.25, 2700.0)?);
    let faces = ["left", "right", "front", "back", "bottom"];
    Ok(Scene::new(name, mesh)
        .part(Part::new("rock", Material::from(rock)))
        .with_boundary(Boundary::new(ViscousSpring::default(), faces).with_scatterer(high * 0.5))
        .with_precision(*precision)
        .with_duration(0.05))
}

/// Runs a box; returns wall time and memory.
fn run_block(name: &str) -> Outcome<Cost> {
    let results = block(name)?.prepare()?.run(RunHooks::default())?;
    Ok(Cost {
        time: results.wall_time.as_secs_f64(),
        memory: memory_so_far(),
    })
}

/// Peak memory of this process (bytes), where the system reports it.
fn memory_so_far() -> f64 {
    peak_memory().map_or(f64::NAN, |bytes| bytes as f64)
}

/// The scene of the stages with a name.
fn staged(name: &str) -> Outcome<Scene> {
    let of_name = STAGED.iter().find(|(.., other)| *other == name);
    let (file, mesh, _) = of_name.ok_or("no such stages")?;
    let path = path(file);
    let mut text = std::fs::read_to_string(&path)?;
    if let Some(mesh) = mesh {
        text = text.replace("cavern_small.msh", mesh);
    }
    let scene = FileScene::from_toml(text, path, &powerhouse_wang_2019::registry())?;
    Ok(scene.into_scene().with_threads(1))
}

/// Computes the stages of a scene; returns wall time and memory.
fn rest(name: &str) -> Outcome<Cost> {
    let simulation = staged(name)?.prepare()?;
    let started = Instant::now();
    let body = simulation.equilibrate(None, None)?;
    let time = started.elapsed().as_secs_f64();
    for stage in body.iter().flat_map(|body| body.stages()) {
        let solution = &stage.solution;
        let (corrections, products) = (solution.corrections, solution.products);
        eprintln!(
            "  {}: {corrections} corrections, {products} products",
            stage.name
        );
    }
    Ok(Cost {
        time,
        memory: memory_so_far(),
    })
}

fn predicted(file: &str, duration: f64) -> Outcome<Cost> {
    let cost = powerhouse_study::check(scene(file, duration)?)?.cost;
    Ok(Cost {
        time: cost.wall_time.as_secs_f64(),
        memory: cost.memory as f64,
    })
}

/// Runs a scene and writes its results, as the command does; returns wall time and memory.
fn run(file: &str, duration: f64, folder: PathBuf) -> Outcome<Cost> {
    let scene = scene(file, duration)?;
    let (title, mesh) = (scene.title().to_owned(), scene.mesh().clone());
    let folder = powerhouse::ResultFolder::new(folder);
    folder.create()?;
    let mut simulation = scene.prepare()?;
    simulation.stable_step()?;
    let notes = powerhouse::RunNotes::new(simulation.remarks().to_vec());
    let hooks = RunHooks::default().with_snapshots(folder.snapshots(&simulation)?);
    let results = simulation.run(hooks)?;
    folder.write((&title, &mesh), &results, &notes, None)?;
    Ok(Cost {
        time: results.wall_time.as_secs_f64(),
        memory: memory_so_far(),
    })
}

/// Runs a scene in a process of its own; returns wall time and memory.
fn measured(file: &str, duration: f64) -> Outcome<Cost> {
    let name = format!("powerhouse-cost-{}-{file}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    let told = cost_apart(&[
        "run",
        file,
        &duration.to_string(),
        &folder.to_string_lossy(),
    ]);
    std::fs::remove_dir_all(&folder)?;
    told
}

/// The cost that this program prints with other arguments, in a process of its own.
fn cost_apart(arguments: &[&str]) -> Outcome<Cost> {
    let [time, memory] = apart_from_this(arguments)?;
    Ok(Cost { time, memory })
}

/// Ratio of two costs, the larger over the smaller.
fn apart(one: f64, other: f64) -> f64 {
    (one / other).max(other / one)
}

/// Reports a predicted and a measured cost, with the permitted ratios of time and memory.
fn compare(figures: &mut Figures, name: &str, (expected, found): (Cost, Cost), limits: [f64; 2]) {
    let label = |what: &str| format!("cost_model.{name}.{what}");
    for (what, expected, found, limit) in [
        ("time", expected.time, found.time, limits[0]),
        ("memory", expected.memory, found.memory, limits[1]),
    ] {
        figures.report(&label(&format!("predicted_{what}")), expected, "");
        if found.is_nan() {
            continue;
        }
        figures.report(&label(&format!("measured_{what}")), found, "");
        let name = label(&format!("{what}_apart"));
        figures.at_most(&name, apart(expected, found), limit);
    }
}

fn main() -> Outcome<ExitCode> {
    let arguments: Vec<String> = std::env::args().collect();
    let words: Vec<&str> = arguments.iter().skip(1).map(String::as_str).collect();
    let alone = match words[..] {
        ["run", file, duration, folder] => Some(run(file, duration.parse()?, folder.into())?),
        ["rest", name] => Some(rest(name)?),
        ["block", name] => Some(run_block(name)?),
        _ => None,
    };
    if let Some(cost) = alone {
        println!("{} {}", cost.time, cost.memory);
        return Ok(ExitCode::SUCCESS);
    }
    let mut figures = Figures::default();
    for (file, duration, name) in SCENES {
        let (expected, found) = (predicted(file, duration)?, measured(file, duration)?);
        compare(&mut figures, name, (expected, found), [LIMIT; 2]);
    }
    for (.., name) in BOXES {
        let cost = powerhouse_study::check(block(name)?)?.cost;
        let found = cost_apart(&["block", name])?.memory;
        let expected = cost.memory as f64;
        figures.report(&format!("cost_model.{name}.predicted_memory"), expected, "");
        figures.report(&format!("cost_model.{name}.measured_memory"), found, "");
        if !found.is_nan() {
            let name = format!("cost_model.{name}.memory_apart");
            figures.at_most(&name, apart(expected, found), MEMORY_LIMIT);
        }
    }
    for (.., name) in STAGED {
        let cost = powerhouse_study::check(staged(name)?)?.cost;
        let stages = cost.stages.ok_or("no stages")?;
        println!(
            "{name}: {} corrections, {} of them timed",
            stages.corrections, stages.timed
        );
        let expected = Cost {
            time: stages.wall_time.as_secs_f64(),
            memory: stages.memory as f64,
        };
        let found = cost_apart(&["rest", name])?;
        // The cost of completed stages differs only by the timing.
        let limits = [stages.uncertainty.max(LIMIT), MEMORY_LIMIT];
        compare(&mut figures, name, (expected, found), limits);
    }
    Ok(figures.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Prediction and run use the same scene, and the ratio of two costs is symmetric.
    #[test]
    fn costs_are_of_the_same_scene() {
        let (file, duration, _) = SCENES[2];
        let expected = predicted(file, duration).unwrap();
        assert!(expected.time > 0.0 && expected.memory > 1e7);
        assert_eq!(scene(file, duration).unwrap().duration(), duration);
        assert_eq!((apart(2.0, 1.0), apart(1.0, 2.0)), (2.0, 2.0));
    }

    /// Distorted boxes have the elements of regular ones, none of them inverted.
    #[test]
    fn boxes_are_sound() {
        let count = |name: &str| block(name).unwrap().mesh().element_count();
        assert_eq!(count("bricks"), count("distorted"));
        for (.., name) in BOXES {
            let quality = block(name).unwrap().mesh().check().unwrap();
            assert!(quality.least_scaled_jacobian > 0.0, "{name}");
        }
        assert!(block("none").is_err());
    }

    /// The stages with a name are those of its scene, on the replacing mesh.
    #[test]
    fn stages_are_of_the_mesh_that_is_named() {
        let elements = |name: &str| {
            let scene = staged(name).unwrap();
            assert_eq!(scene.stages().len(), 2);
            scene.mesh().element_count()
        };
        assert!(elements("staged_fine") > 2 * elements("staged"));
        assert!(staged("none").is_err());
    }
}
