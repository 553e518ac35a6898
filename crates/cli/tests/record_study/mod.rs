//! A study of many records at several levels, killed twice and resumed by two processes: the files of an undisturbed one, and the
//! fragility of a joint that slips, against a fit of its own.

mod fit;

use std::path::{Path, PathBuf};
use std::process::Child;
use std::time::{Duration, Instant};

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse_study::sweep::SetStatistics;
use powerhouse_test_support::{
    MOTION_STEP, TestFolder, motion_text, part_of_motion, synthetic_motion,
};

use crate::killed::{assert_same_files, files, start};
use fit::{fit, pseudo_acceleration};

/// Period of the intensity of the second curve (s).
const PERIOD: f64 = 0.3;

/// A measure of a motion.
type Intensity = fn(&[f64]) -> f64;

fn peak(motion: &[f64]) -> f64 {
    motion.iter().fold(0.0, |most, a| most.max(a.abs()))
}

/// Motions of a number of records: a part of that of El Centro, and synthetic ones.
fn motions(count: u64) -> Vec<(String, Vec<f64>)> {
    let text = std::fs::read_to_string(data("records/el_centro_1940_ns.csv")).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    let row = |line: &str| -> [f64; 2] {
        let (time, acceleration) = line.split_once(',').unwrap();
        [time, acceleration].map(|number| number.parse().unwrap())
    };
    let rows: Vec<[f64; 2]> = rows.map(row).collect();
    let accelerations: Vec<f64> = rows.iter().map(|row| row[1]).collect();
    let el_centro = part_of_motion(&accelerations, rows[1][0] - rows[0][0], 1.4);
    let synthetic = (1..count).map(synthetic_motion);
    let all = std::iter::once(el_centro).chain(synthetic).zip(1..);
    all.map(|(motion, number)| (format!("m{number:02}"), motion))
        .collect()
}

fn data(name: &str) -> PathBuf {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    data.canonicalize().unwrap().join(name)
}

/// A study: its scene, joint, records and levels, and the limit of the slip (m).
struct Study {
    /// The scene but for its records.
    scene: String,
    joint: &'static str,
    records: u64,
    levels: &'static [f64],
    limit: f64,
    /// Motion between two checkpoints, as the command takes it.
    checkpoints: &'static str,
    /// Numbers of finished cases after which all processes are killed.
    kills: [usize; 2],
    /// Longest wall time of a part of it.
    most: Duration,
}

impl Study {
    /// Text of the whole scene.
    fn text(&self) -> String {
        let (joint, limit) = (self.joint, self.limit);
        let curve = format!("figure = \"joint {joint} slip\"\nlimit = {limit}\n");
        format!(
            "{}\n[[record_set]]\nname = \"motions\"\nfolder = \"motions\"\nunits = \"m/s2\"\nconvention = \"incident\"\n\
             scales = {:?}\n[[record_set.fragility]]\nname = \"slip\"\n{curve}\
             [[record_set.fragility]]\nname = \"slip-by-spectrum\"\n{curve}period = {PERIOD}\n",
            self.scene, self.levels
        )
    }

    /// Starts a process of the study.
    fn worker(&self, folder: &Path, out: &Path) -> Child {
        let [scene, out] = [folder.join("scene.toml"), out.to_path_buf()];
        let [scene, out] = [scene, out].map(|path| path.display().to_string());
        let arguments = ["sweep", &scene, "--out", &out];
        let every = ["--checkpoint-every", self.checkpoints];
        start(
            &[&arguments[..], &every].concat(),
            1,
            &folder.join("printed"),
        )
    }

    /// Waits for a process that is to end with success.
    fn end(&self, mut worker: Child, folder: &Path) {
        let begun = Instant::now();
        while worker.try_wait().unwrap().is_none() {
            assert!(begun.elapsed() < self.most);
            std::thread::sleep(Duration::from_millis(5));
        }
        let status = worker.wait().unwrap();
        let printed = || std::fs::read_to_string(folder.join("printed")).unwrap();
        assert!(status.success(), "{status}: {}", printed());
    }

    /// Starts two processes and kills both inside of cases, when so many are finished.
    fn killed(&self, finished: usize, folder: &Path, out: &Path) {
        let mut workers = [0, 1].map(|_| self.worker(folder, out));
        let begun = Instant::now();
        // Both are inside of cases that can be continued.
        while count(out, "finished.json") < finished || count(out, "checkpoint/latest.run") < 2 {
            for worker in &mut workers {
                assert!(worker.try_wait().unwrap().is_none());
            }
            assert!(begun.elapsed() < self.most);
            std::thread::sleep(Duration::from_millis(1));
        }
        for worker in &mut workers {
            worker.kill().unwrap();
        }
        for mut worker in workers {
            assert!(!worker.wait().unwrap().success());
        }
        let all = self.records as usize * self.levels.len();
        assert!(count(out, "finished.json") < all);
    }

    /// Runs the study undisturbed and killed, and compares their files; returns the folder of the results.
    fn run(&self, name: &str) -> (TestFolder, PathBuf) {
        let folder = TestFolder::new(name);
        std::fs::create_dir(folder.join("motions")).unwrap();
        for (name, motion) in motions(self.records) {
            let file = folder.join(format!("motions/{name}.txt"));
            std::fs::write(file, motion_text(&motion)).unwrap();
        }
        std::fs::write(folder.join("scene.toml"), self.text()).unwrap();
        if self.scene.contains("\"mesh.msh\"") {
            write_gmsh(folder.join("mesh.msh"), &seam()).unwrap();
        }
        let [out, whole] = ["out", "whole"].map(|name| folder.join(name));
        for finished in self.kills {
            self.killed(finished, &folder, &out);
        }
        for worker in [0, 1].map(|_| self.worker(&folder, &out)) {
            self.end(worker, &folder);
        }
        let printed = std::fs::read_to_string(folder.join("printed")).unwrap();
        let resumed = printed.matches(": resumed after ").count();
        // Of each kill one case at least, unless the other process was between two of its own.
        assert!(resumed >= 2, "{resumed} cases were resumed: {printed}");
        self.end(self.worker(&folder, &whole), &folder);
        assert_same_files(&out, &whole);
        println!(
            "{} files of {} cases are the same; {resumed} cases were resumed",
            files(&out).len(),
            count(&out, "finished.json")
        );
        (folder, out)
    }

    /// The page of the study: it is written, and says nothing of the cases of another scene.
    fn report(&self, out: &Path, folder: &Path) {
        let printed = folder.join("printed-of-report");
        let arguments = ["report", &out.display().to_string()];
        let status = start(&arguments, 1, &printed).wait().unwrap();
        assert!(status.success());
        let printed = std::fs::read_to_string(printed).unwrap();
        assert!(
            printed.contains("report.html") && !printed.contains("conclusion."),
            "{printed}"
        );
        let page = std::fs::read_to_string(out.join("report.html")).unwrap();
        assert!(page.contains("Fragility curve slip") && out.join("report-cases.html").exists());
    }

    /// Compares the curves with those of the outcomes in `sweep.csv` and of the records.
    fn compare(&self, out: &Path) {
        let statistics = SetStatistics::read(&out.join("statistics.json")).unwrap();
        let table = std::fs::read_to_string(out.join("sweep.csv")).unwrap();
        let mut lines = table
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>());
        let heads = lines.next().unwrap();
        let slip = format!("joint {} slip [m]", self.joint);
        let column = heads.iter().position(|head| *head == slip).unwrap();
        let rows: Vec<_> = lines.collect();
        let records = motions(self.records);
        let intensities = [peak as Intensity, |motion| {
            pseudo_acceleration(motion, MOTION_STEP, PERIOD)
        }];
        assert_eq!(statistics.fragility.len(), 2);
        for (found, intensity) in statistics.fragility.iter().zip(intensities) {
            let mut runs = Vec::new();
            for (name, motion) in &records {
                let own = intensity(motion);
                for level in self.levels {
                    let case = format!("{name}-x{level}");
                    let row = rows.iter().find(|row| row[0] == case).unwrap();
                    let exceeds = row[column].parse::<f64>().unwrap() > self.limit;
                    runs.push((level * own, exceeds));
                    let run = found.runs.iter().find(|run| run.case == case).unwrap();
                    assert_eq!(run.exceeds, exceeds, "{case}");
                    // The steps of the oscillator here are a thirtieth of a thousandth of its period at most.
                    let ratio = run.intensity / (level * own);
                    assert!((ratio - 1.0).abs() < 0.01, "{case}: {ratio}");
                }
            }
            assert_eq!(found.runs.len(), runs.len());
            let curve = found.curve.unwrap_or_else(|| panic!("{:?}", found.refused));
            let own = fit(&runs);
            let inside = |value: f64, [low, high]: [f64; 2]| low < value && value < high;
            println!(
                "{}: {} of {} runs exceed; median {:.4} ({:.4} to {:.4}), own fit {:.4} ({:.4} to {:.4}); dispersion {:.4} ({:.4} to {:.4}), \
                 own fit {:.4} ({:.4} to {:.4})",
                found.name,
                found.exceeded(),
                runs.len(),
                curve.median,
                curve.median_interval[0],
                curve.median_interval[1],
                own.median.exp(),
                own.median_interval[0].exp(),
                own.median_interval[1].exp(),
                curve.dispersion,
                curve.dispersion_interval[0],
                curve.dispersion_interval[1],
                own.dispersion.exp(),
                own.dispersion_interval[0].exp(),
                own.dispersion_interval[1].exp(),
            );
            assert!(inside(curve.median.ln(), own.median_interval));
            assert!(inside(curve.dispersion.ln(), own.dispersion_interval));
            assert!(inside(own.median.exp(), curve.median_interval));
            assert!(inside(own.dispersion.exp(), curve.dispersion_interval));
            // Both are of greatest likelihood; intensities differ by a hundredth at most.
            assert!((curve.median.ln() - own.median).abs() < 0.01);
            assert!((curve.dispersion / own.dispersion.exp() - 1.0).abs() < 0.1);
        }
    }
}

/// Number of cases below a folder that have a file.
fn count(out: &Path, name: &str) -> usize {
    let cases = std::fs::read_dir(out).into_iter().flatten().flatten();
    cases.filter(|case| case.path().join(name).exists()).count()
}

/// A slice of ground of 24 m by 3 m by 24 m with a block of 6 m inside.
fn seam() -> Mesh {
    let size = Vec3::new(24.0, 3.0, 24.0);
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [8, 1, 8], "rock").unwrap();
    let block = mesh.elements_in_box(&Vec3::new(9.0, 0.0, 9.0), &Vec3::new(15.0, 3.0, 15.0));
    let all = 0..mesh.element_count() as u32;
    let rock = all.filter(|element| !block.contains(element)).collect();
    mesh.set_element_set("rock", rock).unwrap();
    mesh.set_element_set("block", block).unwrap();
    mesh
}

/// A block in a slice of ground on a joint with friction alone, under 100 kPa.
const SEAM: &str = r#"
title = "block on a joint that slips"
[mesh]
file = "mesh.msh"
[[material]]
name = "rock"
law = "elastic"
young = 9e9
poisson = 0.27
density = 2750
[[part]]
set = "rock"
material = "rock"
damping = { kind = "high", ratio = 0.05 }
[[part]]
set = "block"
material = "rock"
damping = { kind = "high", ratio = 0.05 }
[[joint]]
name = "seam"
between = ["rock", "block"]
law = "bonded-coulomb"
static_friction = 0.6
dynamic_friction = 0.5
preload = { kind = "pressure", pressure = 1e5 }
[[support]]
kind = "roller"
set = "front"
[[support]]
kind = "roller"
set = "back"
[[wave]]
kind = "sv"
incidence = 20
record = "motions"
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "bottom"]
scatterer = [12, 1.5, 12]
spreading = "cylindrical"
[time]
duration = 1.4
step = 2e-4
[output]
every = 0.01
[[output.history]]
name = "inside"
at = [12, 0, 12]
quantities = ["displacement"]
"#;

/// Four records at three levels.
#[test]
fn a_killed_study_has_the_files_and_the_fragility_of_an_undisturbed_one() {
    let study = Study {
        scene: SEAM.into(),
        joint: "seam",
        records: 4,
        levels: &[1.6, 2.0, 2.4],
        limit: 7.5e-4,
        checkpoints: "0.1s",
        kills: [2, 6],
        most: Duration::from_secs(300),
    };
    let (folder, out) = study.run("record-study");
    study.compare(&out);
    study.report(&out, &folder);
}

/// The lined cavern of `cavern_small.msh` on a weak joint under 200 kPa: twenty records at six levels. It takes a quarter of an
/// hour on two cores.
#[test]
#[ignore = "long; run with --ignored --nocapture in release"]
fn twenty_records_at_six_levels_make_the_joint_of_the_small_cavern_slip() {
    let text = std::fs::read_to_string(data("scenes/cavern_joint.toml")).unwrap();
    let place = |text: &str, of: &str| text.find(of).unwrap_or_else(|| panic!("{of}"));
    let [from, to] = ["[[record]]", "[[wave]]"].map(|of| place(&text, of));
    let text = [&text[..from], &text[to..]].concat();
    let end = place(&text, "[output.envelope]");
    let mesh = data("meshes/cavern_small.msh").display().to_string();
    let mut scene = text[..end].to_owned();
    for (old, new) in [
        ("../meshes/cavern_small.msh", mesh.as_str()),
        ("self_check = 0.02", ""),
        ("record = \"el-centro-ns\"", "record = \"motions\""),
        ("cohesion = 1.0e6", "cohesion = 1.0e5"),
        ("tensile_strength = 1.0e6", "tensile_strength = 5.0e4"),
        (
            "dynamic_friction = 0.755",
            "dynamic_friction = 0.755\npreload = { kind = \"pressure\", pressure = 2e5 }",
        ),
        (
            "kernel = \"hex8-one-point\"",
            "kernel = \"hex8-one-point\"\ndamping = { kind = \"high\", ratio = 0.05 }",
        ),
        (
            "kernel = \"hex8-full\"",
            "kernel = \"hex8-natural\"\ndamping = { kind = \"high\", ratio = 0.05 }",
        ),
        ("duration = 6 ", "duration = 1.5 "),
    ] {
        assert!(scene.contains(old), "{old}");
        scene = scene.replace(old, new);
    }
    let study = Study {
        scene,
        joint: "rock-lining",
        records: 20,
        levels: &[0.5, 1.0, 1.5, 2.0, 2.5, 3.0],
        limit: 4e-3,
        checkpoints: "0.2s",
        kills: [20, 70],
        most: Duration::from_secs(7200),
    };
    let (folder, out) = study.run("record-study-cavern");
    study.compare(&out);
    study.report(&out, &folder);
}
